"""FMI slave of the aerodynamic load."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part("aero", "Quasi-steady aerodynamic load of the wing pair", physics, step=2.0e-4)


class Aero(PhysicsSlave):
    """The aerodynamic load as an FMU."""

    part = PART
