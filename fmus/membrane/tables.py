"""Tables of the shipped films as module constants.

Inside an FMU they come from `tables.json`, which the build puts beside this file; in the
source tree they are made on first use and kept under the user's cache folder.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import tomllib
from pathlib import Path
from typing import Any

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
NODES = (24, 16)
CELLS_X = 30
CELLS_E = 20


def made(materials: str) -> str:
    """JSON text of the tables of all films of a materials file, by direct solution.

    Needs numpy; takes about half a second a film. Raises `ValueError` where a film is not
    described whole, or has no stable equilibrium over the range that its entry asks for.
    """
    from .film import Film
    from .surrogate import Range, group, table

    tables = []
    for name, data in tomllib.loads(materials).items():
        missing = [key for key in KEYS if key not in data]
        if missing:
            raise ValueError(f"film {name}: {', '.join(missing)} is missing")
        film = Film(
            inner_radius=data["inner_radius"],
            outer_radius=data["outer_radius"],
            thickness=data["thickness"],
            moduli=tuple(data["moduli"]),
            exponents=tuple(data["exponents"]),
            permittivity=data["permittivity"],
            prestretch=data["prestretch"],
        )
        span = Range(
            data["lowest"],
            data["highest"],
            group(film, data["voltage"]),
            NODES,
            (CELLS_X, CELLS_E),
        )
        tables.append(table(film, span))
    return json.dumps(tables)


def _cached() -> str:
    """The tables of these sources from the cache, made and put there if they are missing."""
    digest = hashlib.sha256()
    for name in ("film.py", "direct.py", "surrogate.py", "tables.py", "materials.toml"):
        digest.update((HERE / name).read_bytes())
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    path = root / "resilin" / f"membrane-{digest.hexdigest()[:16]}.json"
    if path.is_file():
        return path.read_text(encoding="utf-8")
    text = made(MATERIALS.read_text(encoding="utf-8"))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(
            "w", dir=path.parent, delete=False, encoding="utf-8"
        ) as file:
            file.write(text)
        Path(file.name).replace(path)
    except OSError:
        pass
    return text


def _tuples(value: Any) -> Any:
    return tuple(_tuples(entry) for entry in value) if isinstance(value, list) else value


def _loaded() -> list[dict[str, Any]]:
    shipped = HERE / "tables.json"
    text = shipped.read_text(encoding="utf-8") if shipped.is_file() else _cached()
    tables: list[dict[str, Any]] = json.loads(text)
    return tables


FILMS: tuple[str, ...] = tuple(tomllib.loads(MATERIALS.read_text(encoding="utf-8")))
_TABLES = _loaded()

LOWEST: tuple[float, ...] = tuple(t["lowest"] for t in _TABLES)
HIGHEST: tuple[float, ...] = tuple(t["highest"] for t in _TABLES)
LOADING: tuple[float, ...] = tuple(t["loading"] for t in _TABLES)
PRESTRETCH: tuple[float, ...] = tuple(t["prestretch"] for t in _TABLES)
POTENTIAL: tuple[tuple[tuple[float, ...], ...], ...] = _tuples([t["potential"] for t in _TABLES])
FIELD: tuple[tuple[tuple[float, ...], ...], ...] = _tuples([t["field"] for t in _TABLES])
HOOP: tuple[tuple[tuple[float, ...], ...], ...] = _tuples([t["hoop"] for t in _TABLES])
