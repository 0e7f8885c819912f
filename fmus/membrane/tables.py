"""Tables of the shipped films as module constants, from the generated `tables.json`."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..generated import kept, shipped, tuples

if TYPE_CHECKING:
    from .film import Film

HERE = Path(__file__).parent
MATERIALS = HERE / "materials.toml"
KEYS = (
    "inner_radius",
    "outer_radius",
    "thickness",
    "prestretch",
    "moduli",
    "exponents",
    "permittivity",
    "voltage",
    "lowest",
    "highest",
)
OPTIONAL = ("title", "permittivity_fall")
SOURCES = ("film.py", "measured.py", "ritz_solver.py", "surrogate.py", "tables.py")
NODES = (24, 16)
CELLS_X = 30
CELLS_E = 20


def made(materials: str) -> str:
    """JSON text of the tables of all films of a materials file, by direct solution or measured.

    Needs numpy; takes about half a second a film. Raises `ValueError` where a film is not
    described whole, or has no stable equilibrium over the range that its entry asks for.
    """
    return kept("membrane-tables.json", [HERE / name for name in SOURCES], materials, _solved)


def _solved(materials: str) -> str:
    from .measured import MAP_KEYS, measured_table
    from .surrogate import Range, group, table

    tables = []
    for name, data in tomllib.loads(materials).items():
        if "measured" in data:
            _check_keys(name, data, MAP_KEYS)
            tables.append(measured_table(data, NODES, (CELLS_X, CELLS_E)))
            continue
        film = film_of(name, data)
        loading = group(film, data["voltage"])
        span = Range(data["lowest"], data["highest"], loading, NODES, (CELLS_X, CELLS_E))
        tables.append(table(film, span))
    return json.dumps(tables)


def described(materials: str) -> list[tuple[dict[str, Any], Film]]:
    """The entries of a materials file with their films; `ValueError` where one has none."""
    return [(data, film_of(name, data)) for name, data in tomllib.loads(materials).items()]


def film_of(name: str, data: dict[str, Any]) -> Film:
    """The film of an entry of a materials file; `ValueError` where it is not described whole."""
    from .film import Film

    _check_keys(name, data, KEYS)
    return Film(
        inner_radius=data["inner_radius"],
        outer_radius=data["outer_radius"],
        thickness=data["thickness"],
        moduli=tuple(data["moduli"]),
        exponents=tuple(data["exponents"]),
        permittivity=data["permittivity"],
        prestretch=data["prestretch"],
        permittivity_fall=data.get("permittivity_fall", 0.0),
    )


def _check_keys(name: str, data: dict[str, Any], wanted: tuple[str, ...]) -> None:
    """`ValueError` where a key is missing, or is none."""
    missing = [key for key in wanted if key not in data]
    if missing:
        raise ValueError(f"film {name}: {', '.join(missing)} is missing")
    if strange := sorted(set(data) - {*wanted, *OPTIONAL}):
        from difflib import get_close_matches

        closest = get_close_matches(strange[0], [*wanted, *OPTIONAL], n=1)
        hint = f"; did you mean {closest[0]}?" if closest else ""
        raise ValueError(f"film {name}: {strange[0]} is not known{hint}")


FILMS: tuple[str, ...] = tuple(tomllib.loads(MATERIALS.read_text(encoding="utf-8")))
_TABLES: list[dict[str, Any]] = json.loads(
    shipped(
        HERE / "tables.json",
        lambda: made(MATERIALS.read_text(encoding="utf-8")),
    )
)

LOWEST: tuple[float, ...] = tuple(t["lowest"] for t in _TABLES)
HIGHEST: tuple[float, ...] = tuple(t["highest"] for t in _TABLES)
LOADING: tuple[float, ...] = tuple(t["loading"] for t in _TABLES)
PRESTRETCH: tuple[float, ...] = tuple(t["prestretch"] for t in _TABLES)
POTENTIAL: tuple[tuple[tuple[float, ...], ...], ...] = tuples([t["potential"] for t in _TABLES])
FIELD: tuple[tuple[tuple[float, ...], ...], ...] = tuples([t["field"] for t in _TABLES])
HOOP: tuple[tuple[tuple[float, ...], ...], ...] = tuples([t["hoop"] for t in _TABLES])
