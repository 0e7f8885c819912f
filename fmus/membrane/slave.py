"""FMI slave of the membrane stack."""

from __future__ import annotations

from ..part import Part
from ..slave import PhysicsSlave
from . import physics, tables

PART = Part(
    "membrane",
    "Antagonistic double cone of dielectric elastomer films, from one potential",
    physics,
    step=1.0e-4,
    generated={"membrane/tables.json": ("membrane/materials.toml", tables.made)},
    accuracy=1.0e-5,
)


class Membrane(PhysicsSlave):
    """The membrane stack as an FMU."""

    part = PART
