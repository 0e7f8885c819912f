"""What the studies leave on disk: records for spreadsheets."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..report.files import written_whole

COMPUTED = ("=", "+", "-", "@", "\t")
"""How a text begins that a spreadsheet would take for a formula."""


def write_records(records: Sequence[Mapping[str, Any]], path: Path) -> Path:
    """Records of the same keys as CSV, whole or not there; formulas are quoted away."""
    with written_whole(path) as waiting, waiting.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(records[0]))
        writer.writeheader()
        for record in records:
            writer.writerow({key: _safe(value) for key, value in record.items()})
    return path


def _safe(value: Any) -> Any:
    return f"'{value}" if isinstance(value, str) and value.startswith(COMPUTED) else value
