"""Masters: each is one method to step instances together."""

from __future__ import annotations

from ...errors import ScenarioError, nearest
from .base import Master
from .extrapolated import Extrapolated
from .gauss_seidel import GaussSeidel
from .interface_newton import InterfaceNewton
from .iterative import Iterative
from .jacobi import Jacobi

MASTERS: dict[str, type[Master]] = {
    "extrapolated": Extrapolated,
    "gauss-seidel": GaussSeidel,
    "interface-newton": InterfaceNewton,
    "iterative": Iterative,
    "jacobi": Jacobi,
}


def master_class(kind: str) -> type[Master]:
    """Class of a master by the name that scenarios use."""
    if kind not in MASTERS:
        raise ScenarioError(f"no master {kind!r}; {nearest(kind, MASTERS)}")
    return MASTERS[kind]


__all__ = [
    "MASTERS",
    "Extrapolated",
    "GaussSeidel",
    "InterfaceNewton",
    "Iterative",
    "Jacobi",
    "Master",
    "master_class",
]
