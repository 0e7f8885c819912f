"""FMI slave of a table."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics

PART = Part("table", "A measured relation of one or two variables", physics, step=1.0e-3)


class Table(PhysicsSlave):
    """The table as an FMU."""

    part = PART
