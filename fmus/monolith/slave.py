"""FMI slave of the monolith."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part(
    "monolith",
    "Amplifier, spring, mechanism and wings as one ODE: the reference solution",
    physics,
    step=1.0e-3,
    needs=("scipy",),
    includes=("amplifier", "spring", "payload", "linkage", "aero"),
)


class Monolith(PhysicsSlave):
    """The monolith as an FMU."""

    part = PART
