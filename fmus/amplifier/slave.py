"""FMI slave of the amplifier."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part(
    "amplifier",
    "Function generator, high-voltage amplifier and RC electrodes, two channels",
    physics,
    step=1.0e-4,
)


class Amplifier(PhysicsSlave):
    """The amplifier as an FMU."""

    part = PART
