"""What plans and outcomes show of themselves in a notebook."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import lxml.html
import pytest

from orchestrator import load
from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset
from orchestrator.scenario.files import scenario_names
from orchestrator.simulation.run import estimated
from tests.conftest import Runner


def tables(html: str) -> dict[str, list[list[str]]]:
    """Rows of each table by its caption."""
    page = lxml.html.fromstring(html)
    return {
        table.xpath("caption")[0].text: [
            [cell.text_content().strip() for cell in row.xpath("td")]
            for row in table.xpath("tbody/tr")
        ]
        for table in page.xpath("//table")
    }


@pytest.mark.parametrize("options", [{}, {"tolerance": 1e-3}])
def test_an_outcome_shows_its_metrics_and_what_it_recorded(
    outcome: Runner, options: dict[str, Any]
) -> None:
    done = outcome("oscillator-1", time={"stop": "3 cycles", **options})
    done = estimated(done) if options else done
    shown = tables(done._repr_html_())
    found = metrics(dataset(done), done.plan.scenario.metrics.cycles)
    assert found
    assert shown["metrics"] == [
        [m.name, m.shown, m.shown_error][: 2 + bool(options)] for m in found
    ]
    assert [row[0] for row in shown["recorded variables"]] == done.names
    row = shown["recorded variables"][done.names.index("payload.displacement")]
    series = done.series("payload.displacement")
    assert row[1:4] == ["m", f"{series.min():.4g}", f"{series.max():.4g}"]
    assert len(row) == (5 if options else 4)
    assert f"{done.steps} communication steps" in done._repr_html_()


def test_an_outcome_that_stopped_shows_why(outcome: Runner) -> None:
    changes = {"payload.start_velocity": "9000", "spring.blocked_force": "0"}
    done = outcome("oscillator-1", changes)
    text = lxml.html.fromstring(done._repr_html_()).text_content()
    assert f"stopped: {done.failure}; {done.kept} rows kept" in text


def test_an_outcome_without_rows_shows_itself(outcome: Runner) -> None:
    done = outcome("oscillator-1", time={"stop": "1 cycles"})
    empty = replace(done, times=done.times[:0], rows=done.rows[:0])
    shown = tables(empty._repr_html_())
    assert "metrics" not in shown
    assert shown["recorded variables"][0] == ["amplifier.top.voltage", "V", "", ""]


def test_an_outcome_shows_itself_when_its_fmus_are_gone(outcome: Runner) -> None:
    done = outcome("oscillator-1", time={"stop": "1 cycles"})
    gone = {n: replace(i, path=Path("gone.fmu")) for n, i in done.plan.interfaces.items()}
    assert "oscillator" in replace(done, plan=replace(done.plan, interfaces=gone))._repr_html_()


@pytest.mark.parametrize("name", scenario_names())
def test_every_plan_shows_its_components_and_wires(library: Path, name: str) -> None:
    plan = load(name, None, library)
    first, *others = tables(plan._repr_html_()).values()
    assert [row[0] for row in first] == plan.order
    assert any(row[:1] == [key] for rows in others for row in rows for key in plan.held) or not (
        plan.held
    )
    assert plan.scenario.title in lxml.html.fromstring(plan._repr_html_()).text_content()


def test_a_title_from_a_stranger_is_escaped(outcome: Runner) -> None:
    done = outcome("oscillator-1", time={"stop": "1 cycles"})
    scenario = done.plan.scenario.model_copy(update={"title": "<b>bold</b>"})
    plan = replace(done.plan, scenario=scenario)
    for html in (plan._repr_html_(), replace(done, plan=plan)._repr_html_()):
        assert "<b>" not in html
        assert "&lt;b&gt;bold&lt;/b&gt;" in html
