"""Packages of the extra `studies`, which a run does without."""

from __future__ import annotations

from importlib.util import find_spec

from .errors import InputError


def require(purpose: str, *packages: str) -> None:
    """Raise `InputError` with the way out where one of the packages is not installed."""
    missing = [name for name in packages if find_spec(name) is None]
    if missing:
        raise InputError(f"{purpose} needs {' and '.join(missing)}: pip install 'resilin[studies]'")
