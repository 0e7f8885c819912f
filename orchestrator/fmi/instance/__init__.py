"""A loaded FMU instance, in this process or in one of its own."""

from __future__ import annotations

from pathlib import Path

from ..description import Interface
from .base import Instance, Limits
from .in_process import InProcessInstance

USUAL = Limits()

__all__ = ["InProcessInstance", "Instance", "Limits", "in_process", "open_instance"]


def open_instance(
    name: str,
    interface: Interface,
    folder: Path,
    isolate: bool | None = None,
    limits: Limits = USUAL,
    working: Path | None = None,
) -> Instance:
    """Instance of the FMU unpacked in `folder`; a foreign one runs in a process of its own.

    `isolate` overrides that; such a process works in the folder `working`, by default the FMU's,
    from where names of files in parameters count. Raises `FmuError` where the FMU has no library
    for this platform, `InstanceFailure` where it cannot be instantiated.
    """
    if isolate if isolate is not None else not interface.ours:
        from .isolated import IsolatedInstance

        return IsolatedInstance(name, interface, folder, limits, working)
    return in_process(name, interface, folder)


def in_process(name: str, interface: Interface, folder: Path) -> InProcessInstance:
    """Instance in this process."""
    return kind_of(interface)(name, interface, folder)


def kind_of(interface: Interface) -> type[InProcessInstance]:
    """The class of an FMU's instances, by its version of FMI and what it is for."""
    if interface.version == 3:
        from .fmi3 import Fmi3Instance, IntegratedFmi3Instance

        return IntegratedFmi3Instance if interface.model_exchange else Fmi3Instance
    from .fmi2 import Fmi2Instance, IntegratedFmi2Instance

    return IntegratedFmi2Instance if interface.model_exchange else Fmi2Instance
