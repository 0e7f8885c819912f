"""FMI slave of the payload."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part("payload", "Mass on the spacer of the actuator", physics, step=1.0e-4)


class Payload(PhysicsSlave):
    """The payload as an FMU."""

    part = PART
