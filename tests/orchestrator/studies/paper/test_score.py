"""The score of a figure: what holds, what agrees, what misses by most."""

from __future__ import annotations

import pytest

from orchestrator.studies.paper.comparison import Row
from orchestrator.studies.paper.published_values import number
from orchestrator.studies.paper.score import score

STROKE = "figure11.full_wings_stroke"


def off(key: str, error: float) -> Row:
    """A row that misses the paper's number by this share."""
    stated = number(key)
    return Row(key, (1.0 + error) * float(stated.value) * stated.scale)


@pytest.mark.parametrize(
    ("rows", "wanted"),
    [
        (
            [off(STROKE, 0.005), off(STROKE, -0.152)],
            "1 of 2 within their band, largest error -15.2 %",
        ),
        ([off("figure11.no_wing_stroke", 0.01)], "1 number, largest error +1.0 %"),
        (
            [off(STROKE, 0.01), off("table2.power_2", -2.0)],
            "1 of 2 within their band, largest error +1.0 %, of undecidable readings -200.0 %",
        ),
        ([Row("figure13.ratio", "there", agrees=agrees) for agrees in (True, False)],
         "1 of 2 claims agree"),
        ([], ""),
    ],
)  # fmt: skip
def test_the_line_of_a_score(rows: list[Row], wanted: str) -> None:
    assert score(rows).replace("\N{NO-BREAK SPACE}", " ") == wanted
