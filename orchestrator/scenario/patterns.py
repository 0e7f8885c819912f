"""Names of variables that a user gives one by one, or by patterns as `linkage.*`."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from fnmatch import fnmatchcase

from ..errors import InputError, nearest, printable


def matches(name: str, pattern: str) -> bool:
    """Whether a pattern names a variable; brackets of an array's element are taken literally."""
    return name == pattern or fnmatchcase(name, pattern)


def matching(patterns: Sequence[str], names: Collection[str], option: str, lack: str) -> list[str]:
    """The names that any pattern names, pattern by pattern.

    Raises `InputError` where one of them names nothing: `option` is where it was given, `lack` what
    it is not, as `is not recorded`.
    """
    found: dict[str, None] = {}
    for pattern in patterns:
        named = [name for name in names if matches(name, pattern)]
        if not named:
            raise InputError(f"{option} {printable(pattern)}: {lack}; {nearest(pattern, names)}")
        found |= dict.fromkeys(named)
    return list(found)
