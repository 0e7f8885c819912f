"""Records of studies on disk, for spreadsheets."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..report.files import written_whole

COMPUTED = ("=", "+", "-", "@", "\t")
"""First characters of texts that a spreadsheet would take for a formula."""


def write_records(records: Sequence[Mapping[str, Any]], path: Path) -> Path:
    """Write records of the same keys as CSV, whole or not at all; formulas are quoted."""
    with written_whole(path) as waiting, waiting.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(records[0]))
        writer.writeheader()
        for record in records:
            writer.writerow({key: _safe(value) for key, value in record.items()})
    return path


def _safe(value: Any) -> Any:
    return f"'{value}" if isinstance(value, str) and value.startswith(COMPUTED) else value
