"""FMI slave of the cones' shape."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics, tables

PART = Part(
    "profile",
    "Shape of both cones of the membrane stack, at a displacement and two voltages",
    physics,
    step=1.0e-3,
    includes=("membrane",),
    generated={"profile/tables.json": ("membrane/materials.toml", tables.made)},
    accuracy=2.0e-5,
)


class Profile(PhysicsSlave):
    """The cones' shape as an FMU."""

    part = PART
