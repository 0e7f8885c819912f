"""The table as module constants: knots of both arguments, a polynomial for each cell."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ..generated import tuples

_TABLE: dict[str, Any] = json.loads(
    (Path(__file__).parent / "table.json").read_text(encoding="utf-8")
)

FIRST: tuple[float, ...] = tuples(_TABLE["first"])
"""Values of the first argument, rising."""

SECOND: tuple[float, ...] = tuples(_TABLE["second"])
"""Values of the second one; 0 and 1 where there is none."""

PIECES: tuple[tuple[tuple[float, ...], ...], ...] = tuples(_TABLE["pieces"])
"""Output, cell (the second argument's fastest), coefficient of t^i s^j at 4 i + j."""

COLUMNS: int = len(FIRST) - 1
ROWS: int = len(SECOND) - 1
LOW: float = FIRST[0]
HIGH: float = FIRST[-1]
BOTTOM: float = SECOND[0]
TOP: float = SECOND[-1]
