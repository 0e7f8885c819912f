"""Tables of the shipped films as module constants.

Inside an FMU they come from `tables.json`, which the build puts beside this file; in the
source tree they are made on first use and kept under the user's cache folder.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
FILMS = ("silicone_b20", "silicone_b13", "vhb4905_b20")
NODES = (24, 16)
CELLS_X = 30
CELLS_E = 20


def made() -> str:
    """JSON text of all tables, by direct solution; needs numpy, takes some seconds."""
    import tomllib

    from .film import Film
    from .surrogate import Range, group, table

    films = tomllib.loads((HERE / "materials.toml").read_text(encoding="utf-8"))
    tables = []
    for name in FILMS:
        data = films[name]
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
    text = made()
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


_TABLES = _loaded()

LOWEST: tuple[float, ...] = tuple(t["lowest"] for t in _TABLES)
HIGHEST: tuple[float, ...] = tuple(t["highest"] for t in _TABLES)
LOADING: tuple[float, ...] = tuple(t["loading"] for t in _TABLES)
PRESTRETCH: tuple[float, ...] = tuple(t["prestretch"] for t in _TABLES)
POTENTIAL: tuple[tuple[tuple[float, ...], ...], ...] = _tuples([t["potential"] for t in _TABLES])
FIELD: tuple[tuple[tuple[float, ...], ...], ...] = _tuples([t["field"] for t in _TABLES])
HOOP: tuple[tuple[tuple[float, ...], ...], ...] = _tuples([t["hoop"] for t in _TABLES])
