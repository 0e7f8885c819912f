"""A loaded FMU instance, in this process or in one of its own."""

from __future__ import annotations

from pathlib import Path

from ..description import Interface
from .base import Limits, Unit
from .in_process import Local

USUAL = Limits()

__all__ = ["Limits", "Local", "Unit", "in_process", "open_unit"]


def open_unit(
    name: str,
    interface: Interface,
    folder: Path,
    isolate: bool | None = None,
    limits: Limits = USUAL,
) -> Unit:
    """Instance of the FMU unpacked in `folder`; foreign ones in a process of their own.

    `isolate` overrides that. Raises `FmuError` where the FMU has no library for this platform,
    `UnitFailure` where it does not come to life.
    """
    if isolate if isolate is not None else not interface.ours:
        from .isolated import Remote

        return Remote(name, interface, folder, limits)
    return in_process(name, interface, folder)


def in_process(name: str, interface: Interface, folder: Path) -> Local:
    """Instance in this process, by its version of FMI."""
    if interface.version == 3:
        from .fmi3 import Fmi3Unit

        return Fmi3Unit(name, interface, folder)
    from .fmi2 import Fmi2Unit

    return Fmi2Unit(name, interface, folder)
