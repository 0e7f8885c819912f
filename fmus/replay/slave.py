"""FMI slave of a recording."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part("replay", "A recording over time as a source", physics, step=1.0e-3)


class Replay(PhysicsSlave):
    """The recording as an FMU."""

    part = PART
