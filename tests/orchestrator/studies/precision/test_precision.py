"""Precision studies: orders, references, failures that stay in, and cheapest settings."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InputError, ScenarioError
from orchestrator.report.page import rendered
from orchestrator.studies.precision.method import Method, parse_method
from orchestrator.studies.precision.page import page
from orchestrator.studies.precision.study import Study, precision
from orchestrator.studies.precision.table import cheapest_settings, draw, write
from tests.evals.two_masses import exact, scenarios

runner = CliRunner()


@pytest.fixture(scope="module")
def numbers(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Study:
    """Two masses without laws, measured against themselves; one step diverges."""
    folder = scenarios(tmp_path_factory.mktemp("two"))
    methods = [Method(kind, "held") for kind in ("gauss-seidel", "extrapolated")]
    return precision(
        folder / "numbers.toml", library, methods=methods, factors=(80.0, 2.0, 1.0, 0.5),
        repeats=1, changes={"pair.stiffness": "10"}, variables=["first.displacement"],
    )  # fmt: skip


def test_orders_against_itself(numbers: Study) -> None:
    """Without a monolith the reference is a fine iterated run, whose own error is bounded."""
    assert "iterative" in numbers.reference
    assert 0.0 < numbers.bound["first.displacement"] < 3e-4
    finest = {str(r.method): r for r in numbers.runs if r.step == pytest.approx(5e-3)}
    assert finest["gauss-seidel, held"].order == pytest.approx(1.0, abs=0.25)
    assert finest["extrapolated, held"].order == pytest.approx(2.0, abs=0.1)


def test_errors_are_those_of_the_closed_form(numbers: Study, library: Path, tmp_path: Path) -> None:
    from orchestrator.simulation.load import load
    from orchestrator.simulation.run import run

    measured = next(r for r in numbers.runs if r.step == 1e-2 and r.method.kind == "extrapolated")
    path = scenarios(tmp_path) / "numbers.toml"
    changes = {"pair.stiffness": "10"}
    done = run(load(path, changes, library, master={"kind": "extrapolated"}))
    true = abs(done.series("first.displacement") - exact(done.times, 10.0)).max()
    assert measured.largest["first.displacement"] == pytest.approx(true, rel=0.05)


def test_what_failed_stays_in(numbers: Study, tmp_path: Path) -> None:
    """Eighty times the step is past the stability limit: marked with its reason, written out."""
    failed = [r for r in numbers.runs if r.status != "done"]
    assert {r.step for r in failed} == {0.8}
    assert all(r.status.startswith("stopped: ") for r in failed)
    with write(numbers, tmp_path / "t.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert sum(row["status"].startswith("stopped") for row in rows) == len(failed)
    assert draw(numbers, tmp_path / "t.svg").read_text().startswith("<?xml")


def test_the_cheapest_setting_is_good_enough(numbers: Study) -> None:
    lines = list(cheapest_settings(numbers))
    assert lines[2] == "1e-04: not reached"
    assert lines[1].startswith("1e-03: not reached") or "extrapolated" in lines[1]
    best = numbers.cheapest(1e-2)
    assert best is not None
    assert numbers.error(best) <= 1e-2
    assert all(
        r.wall_time >= best.wall_time
        for r in numbers.runs
        if r.status == "done" and numbers.error(r) <= 1e-2
    )


def test_the_monolith_is_the_reference_of_our_scenarios(library: Path) -> None:
    study = precision(
        "oscillator-1", library, methods=[Method("gauss-seidel", "curvature")],
        factors=(2.0, 1.0), repeats=1, options={"time": {"stop": "3 cycles"}},
    )  # fmt: skip
    assert study.reference.startswith("the monolith")
    assert study.variables == ["payload.displacement"]
    assert study.error(study.runs[-1]) < 1e-4
    assert study.runs[-1].calls == 3 * study.runs[-1].steps


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("gauss-siedel", "no master 'gauss-siedel'; did you mean 'gauss-seidel'"),
        ("jacobi/afine", "did you mean 'affine'"),
        ("", "no master ''"),
    ],
)
def test_bad_methods_are_refused(text: str, problem: str) -> None:
    with pytest.raises(InputError, match=problem):
        parse_method(text)


def test_bad_requests_are_refused(library: Path, tmp_path: Path) -> None:
    path = scenarios(tmp_path) / "numbers.toml"
    with pytest.raises(ScenarioError, match="not a part of the monolith"):
        precision(path, library, reference="monolith")
    with pytest.raises(InputError, match=r"did you mean 'first\.displacement'"):
        precision(path, library, variables=["first.displacment"], factors=(1.0,))
    options = ["--fmus", str(library), "--stop", "1 cycle", "--factor", "-1"]
    done = runner.invoke(app, ["precision", "oscillator-1", *options])
    assert done.exit_code == 2
    assert "--factor: has to be above zero" in done.output


def test_the_command_writes_table_and_plot(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "p.csv"
    options = ["--fmus", str(library), "--stop", "2 cycles", "--factor", "1", "--repeats", "1"]
    method = ["--method", "gauss-seidel", "--json", "--output", str(target)]
    done = runner.invoke(app, ["precision", "oscillator-1", *options, *method])
    assert done.exit_code == 0, done.output
    runs = json.loads(done.stdout)["runs"]
    assert {r["variable"] for r in runs} >= {"payload.displacement", "spring.force.value"}
    assert sorted(p.name for p in tmp_path.iterdir()) == ["p.csv", "p.svg"]


def test_a_page_of_all_runs(numbers: Study) -> None:
    """Failures with their reasons too; a scenario's title stays text."""
    text = rendered(page(replace(numbers, title="<script>x</script>")))
    assert "<script>x" not in text
    assert text.count("<tr>") == 1 + len(numbers.runs)
    assert "stopped: " in text


def test_the_command_writes_a_page(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    options = ["--fmus", str(library), "--stop", "2 cycles", "--factor", "1", "--repeats", "1"]
    method = ["--method", "gauss-seidel", "--output", str(tmp_path / "p.csv"), "--html"]
    done = runner.invoke(app, ["precision", "oscillator-1", *options, *method, str(target)])
    assert done.exit_code == 0, done.output
    assert target.read_text().startswith("<!doctype html>")
    done = runner.invoke(app, ["precision", "oscillator-1", *options, *method, str(tmp_path)])
    assert done.exit_code == 2
    assert "name it *.html" in done.output
    blocked = tmp_path / "p.csv" / "q.csv"
    done = runner.invoke(app, ["precision", "oscillator-1", *options, "--output", str(blocked)])
    assert done.exit_code == 2
    assert "p.csv: cannot be made" in done.output
