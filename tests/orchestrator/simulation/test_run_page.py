"""The report of a run: its numbers, its plots, its diagram, what it was made of."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from math import nan
from pathlib import Path

import lxml.html
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.report.page import rendered
from orchestrator.results.metrics import Metric, metrics
from orchestrator.results.outcome import Outcome
from orchestrator.results.recorded import recorded
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.simulation.run_page import page

SHORT = {"stop": "8 cycles", "step": {"per_cycle": 50}}


@pytest.fixture(scope="module")
def outcome(library: Path) -> Outcome:
    plan = load("flapping-full-wings", None, library, time=SHORT)
    return run(plan, estimate=True).checked()


@pytest.fixture(scope="module")
def shown(outcome: Outcome) -> lxml.html.HtmlElement:
    data = recorded(outcome)
    return lxml.html.fromstring(rendered(page(outcome, data, metrics(data))))


def test_every_metric_stands_with_its_error(outcome: Outcome, shown: lxml.html.HtmlElement) -> None:
    rows = [
        [cell.text_content().strip() for cell in row.iter("td")]
        for row in shown.get_element_by_id("metrics").iter("tr")
    ][1:]
    wanted = [[m.name, m.shown, m.shown_error] for m in metrics(outcome)]
    assert rows == wanted
    assert len(rows) > 5


def test_the_plots_are_those_of_the_scenario(
    outcome: Outcome, shown: lxml.html.HtmlElement
) -> None:
    """In the panels' units, over the last five cycles."""
    plots = json.loads(shown.get_element_by_id("run-data").text)
    panels = outcome.plan.scenario.plot
    assert [plot["y"]["label"].partition(" (")[0] for plot in plots] == list(panels)
    stroke = next(p for p in plots if p["y"]["label"] == "Flap angle (deg)")
    (curve,) = stroke["curves"]
    assert curve["x"][-1] - curve["x"][0] == pytest.approx(5.0 / 18.0, rel=0.01)
    found = {m.name: m.value for m in metrics(outcome)}
    swing = max(curve["y"]) - min(curve["y"])
    assert swing == pytest.approx(found["flapping stroke"] * 57.29578, rel=1e-3)


def test_the_diagram_stands_in_the_file_and_says_its_wires(shown: lxml.html.HtmlElement) -> None:
    (image,) = shown.iter("img")
    kind, _, text = image.get("src").partition(",")
    assert kind == "data:image/svg+xml;base64"
    assert b"<svg" in base64.b64decode(text)
    assert "actuator.force.value to linkage.force.value" in image.get("alt")


def test_what_it_was_made_of_is_said(outcome: Outcome, shown: lxml.html.HtmlElement) -> None:
    text = shown.get_element_by_id("made-of").text_content()
    assert all(digest in text for digest in outcome.plan.digests.values())
    assert "amplifier.waveform" in text
    assert "square" in text
    assert "0.24626 N" in text


def test_what_to_know_stands_before_the_numbers(outcome: Outcome) -> None:
    """Warnings, what the scenario has lost, metrics without a value, what was changed."""
    coupling = {"a -> b": (0.5, 1.0)}
    plan = replace(outcome.plan, dropped=["wire of <b>"], changes={"amplifier.frequency": "9 Hz"})
    found = [Metric("top", nan, "m", "nan m")]
    made = page(replace(outcome, plan=plan, couplings=coupling), recorded(outcome), found)
    shown = lxml.html.fromstring(rendered(made))
    assert [part.get("id") for part in shown.iter("section")][:3] == ["trust", "dropped", "metrics"]
    assert "a -> b creates 50.0%" in shown.get_element_by_id("trust").text_content()
    assert "wire of <b>" in shown.get_element_by_id("dropped").text_content()
    assert [part.text_content() for part in shown.find_class("alarm")] == ["Without a value: top"]
    assert shown.find_class("lead")[0].text_content().startswith("With amplifier.frequency = 9 Hz.")
    assert not page(outcome, recorded(outcome), []).alarms


def test_the_command_writes_it(library: Path, tmp_path: Path) -> None:
    """And refuses a place for it before anything runs."""
    options = ["--fmus", str(library), "--stop", "4 cycles", "--no-picture"]
    options += ["--output", str(tmp_path / "a.nc"), "--html"]
    wanted = tmp_path / "pages" / "a.html"
    done = CliRunner().invoke(app, ["run", "oscillator-1", *options, str(wanted), "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["page"] == str(wanted)
    assert "Metrics" in wanted.read_text()
    (tmp_path / "a.nc").unlink()
    refused = CliRunner().invoke(app, ["run", "oscillator-1", *options, str(tmp_path / "a.pdf")])
    assert refused.exit_code == 2
    assert "name it *.html" in " ".join(refused.output.split())
    assert not (tmp_path / "a.nc").exists()
