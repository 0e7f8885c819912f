"""FMI slave of the controller."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part(
    "controller",
    "Digital controller that tracks resonance and holds a stroke",
    physics,
    step=1.0e-4,
)


class Controller(PhysicsSlave):
    """The controller as an FMU."""

    part = PART
