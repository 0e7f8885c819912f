"""What the studies leave on disk: records for spreadsheets, and pictures."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import OutputError

COMPUTED = ("=", "+", "-", "@", "\t")
"""How a text begins that a spreadsheet would take for a formula."""


def write_records(records: Sequence[Mapping[str, Any]], path: Path) -> Path:
    """Records of the same keys as CSV, whole or not there; formulas are quoted away."""
    waiting = path.with_name(f".{path.name}.part")
    try:
        with waiting.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(records[0]))
            writer.writeheader()
            for record in records:
                writer.writerow({key: _safe(value) for key, value in record.items()})
        waiting.replace(path)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({error.strerror})") from None
    finally:
        waiting.unlink(missing_ok=True)
    return path


def _safe(value: Any) -> Any:
    return f"'{value}" if isinstance(value, str) and value.startswith(COMPUTED) else value


def save_figure(figure: Any, path: Path, dpi: int) -> Path:
    """Save a matplotlib figure in the format that its path names, and close it."""
    from matplotlib import pyplot

    try:
        figure.savefig(path, dpi=dpi)
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: cannot be drawn ({error})") from None
    finally:
        pyplot.close(figure)
    return path
