"""Where six points of a film are, over its height and voltage, from the generated `tables.json`.

The points are the inner Chebyshev-Lobatto points of s = ln(R/a)/ln(b/a), with R the flat radius:
with both rims they carry the polynomial of degree seven through the whole profile.
"""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path
from typing import Any

from ..generated import kept, shipped, tuples

HERE = Path(__file__).parent
MEMBRANE = HERE.parent / "membrane"
MATERIALS = MEMBRANE / "materials.toml"
SOURCES = ("film.py", "ritz_solver.py", "surrogate.py", "tables.py")
NODES = (20, 12)
CELLS_X = 14
CELLS_E = 8
COUNT = 6
PLACES = tuple(0.5 * (1.0 - math.cos(math.pi * (k + 1) / (COUNT + 1))) for k in range(COUNT))
"""Where the points are in s, from the inner rim."""


def made(materials: str) -> str:
    """JSON text of the tables of all films of a materials file, by direct solution.

    Lengths in outer radii. Raises `ValueError` as the membrane's tables do.
    """
    sources = [HERE / "tables.py", *(MEMBRANE / name for name in SOURCES)]
    return kept("profile-tables.json", sources, materials, _solved)


def _solved(materials: str) -> str:
    import numpy as np

    from ..membrane.ritz_solver import profile
    from ..membrane.surrogate import Range, group, solved, splined, unit_film
    from ..membrane.tables import described

    tables = []
    for data, film in described(materials):
        loading = group(film, data["voltage"])
        span = Range(data["lowest"], data["highest"], loading, NODES, (CELLS_X, CELLS_E))
        unit = unit_film(film)
        rows = [[profile(unit, point, PLACES) for point in row] for row in solved(unit, span)]
        every = np.array(rows)
        tables.append(
            {
                "lowest": span.lowest,
                "highest": span.highest,
                "loading": span.loading,
                "radius": [splined(every[:, :, 0, k], span.cells).tolist() for k in range(COUNT)],
                "height": [splined(every[:, :, 1, k], span.cells).tolist() for k in range(COUNT)],
            }
        )
    return json.dumps(tables)


_TABLES: list[dict[str, Any]] = json.loads(
    shipped(
        HERE / "tables.json",
        lambda: made(MATERIALS.read_text(encoding="utf-8")),
    )
)

Places = tuple[tuple[tuple[tuple[float, ...], ...], ...], ...]

FILMS: tuple[str, ...] = tuple(tomllib.loads(MATERIALS.read_text(encoding="utf-8")))
LOWEST: tuple[float, ...] = tuple(t["lowest"] for t in _TABLES)
HIGHEST: tuple[float, ...] = tuple(t["highest"] for t in _TABLES)
LOADING: tuple[float, ...] = tuple(t["loading"] for t in _TABLES)
RADIUS: Places = tuples([t["radius"] for t in _TABLES])
HEIGHT: Places = tuples([t["height"] for t in _TABLES])
