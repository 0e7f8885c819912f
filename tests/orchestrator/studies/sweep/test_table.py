"""What a terminal shows of a sweep."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
import xarray
from rich.console import Console

from orchestrator.studies.sweep.points import Point
from orchestrator.studies.sweep.table import facts, remarks, tables
from tests.orchestrator.studies.sweep.grids import Metrics, grid, made

FREQUENCY, MASS = "amplifier.frequency", "payload.mass"


def printed(data: xarray.Dataset, width: int = 80) -> str:
    console = Console(file=io.StringIO(), width=width)
    for table in tables(data, width):
        console.print(table)
    return console.file.getvalue()  # type: ignore[attr-defined, no-any-return]


def many(point: Point) -> Metrics:
    """Fourteen metrics that vary, and one that does not."""
    place = float(point.place[0])
    varying = [(f"metric number {k}", 1.234567e-5 * place * 10**k, "N") for k in range(14)]
    return (*varying, ("frequency", 50.0, "Hz"))


@pytest.mark.parametrize("width", [40, 80, 200])
def test_no_number_is_cut_and_no_line_is_too_long(width: int, library: Path) -> None:
    data = made(grid(library, f"{FREQUENCY}=48,50Hz", f"{MASS}=1,2g"), many)
    text = printed(data, width)
    assert max(map(len, text.splitlines())) <= width
    for name, value, _ in many(grid(library, f"{FREQUENCY}=48,50Hz").points[1])[:14]:
        assert f" {value:#.4g}".removesuffix(".") in text, name
    assert "…" not in text


def test_only_what_varies_is_in_the_table(library: Path) -> None:
    """Metrics in the unit that a run prints; what is the same everywhere stands below."""
    data = made(
        grid(library, f"{FREQUENCY}=48,50Hz", f"{MASS}=1g"),
        lambda point: (("travel", 1e-3 * float(point.place[0]), "m"), ("frequency", 50.0, "Hz")),
    )
    text = printed(data)
    assert "travel" in text and "mm" in text and "48.00" in text and "Hz" in text
    assert "payload" not in text
    same, *left_out = remarks(data)
    assert same == "the same at every point: payload.mass 0.001 kg, frequency 50.00 Hz, steps 100"
    assert any(line.startswith("metric left out: phase: no point has") for line in left_out)


def test_a_failed_point_is_named_with_its_reason(library: Path) -> None:
    data = made(
        grid(library, f"{FREQUENCY}=48,50Hz"),
        lambda point: (("travel", 1e-3, "m"),) if point.place[0] == 48.0 else (),
    )
    assert "failed" in printed(data)
    assert f"{FREQUENCY} = 50: failed: it fell apart" in list(remarks(data))
    assert [fact["status"] for fact in facts(data)] == ["done", "failed"]
    assert facts(data)[0] == {
        FREQUENCY: 48.0, "travel": 1e-3, "status": "done", "reason": "", "wall_time": 1.0,
        "steps": 100,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("known", "line"),
    [
        (
            {"peak_uncertainty": 2e-5, "peak_at_uncertainty": 0.03},
            "peak of travel: 14.242 +- 0.02 mm at amplifier.frequency = 50.61 +- 0.03 Hz",
        ),
        (
            {},
            "largest travel: 14.24 mm at amplifier.frequency = 50.61 Hz; no peak is enclosed by"
            " points on both sides",
        ),
    ],
)
def test_the_peak_is_shown_with_its_uncertainty(
    known: dict[str, float], line: str, library: Path
) -> None:
    data = made(grid(library, f"{FREQUENCY}=48,50,54Hz"), lambda point: (("travel", 1e-3, "m"),))
    data.attrs |= {"refined": "travel", "peak": 14.242e-3, "peak_at": 50.61} | known
    assert list(remarks(data))[-1] == line
