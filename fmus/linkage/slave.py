"""FMI slave of the linkage."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part("linkage", "Slider-crank, double rocker and wing inertia", physics, step=2.0e-4)


class Linkage(PhysicsSlave):
    """The linkage as an FMU."""

    part = PART
