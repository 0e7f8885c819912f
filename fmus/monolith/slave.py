"""FMI slave of the monolith."""

from __future__ import annotations

from ..membrane import slave as membrane
from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part(
    "monolith",
    "Amplifier, actuator, mechanism and wings as one ODE: the reference solution",
    physics,
    step=1.0e-3,
    needs=("scipy",),
    includes=("amplifier", "spring", "membrane", "payload", "linkage", "aero"),
    generated=membrane.PART.generated,
)


class Monolith(PhysicsSlave):
    """The monolith as an FMU."""

    part = PART
