"""FMI slave of the spring."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part(
    "spring", "Double-cone actuator as a linear spring with a V^2 force", physics, step=1.0e-4
)


class Spring(PhysicsSlave):
    """The spring as an FMU."""

    part = PART
