"""Masters: how units are stepped together, one method each."""

from __future__ import annotations

from ..errors import SceneError, nearest
from .base import Master
from .gauss_seidel import GaussSeidel
from .iterative import Iterative
from .jacobi import Jacobi

MASTERS: dict[str, Master] = {
    "gauss-seidel": GaussSeidel(),
    "iterative": Iterative(),
    "jacobi": Jacobi(),
}


def master(kind: str) -> Master:
    """Master by the name a scene gives it."""
    if kind not in MASTERS:
        raise SceneError(f"master.kind: no master {kind!r}; {nearest(kind, MASTERS)}")
    return MASTERS[kind]


__all__ = ["MASTERS", "GaussSeidel", "Iterative", "Jacobi", "Master", "master"]
