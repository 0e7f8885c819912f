"""Extreme cases: the class of each run, and that no wrong run passes for right."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import ScenarioError
from orchestrator.report.page import rendered
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.precision.method import Method
from orchestrator.studies.stability import CLASSES, Study, load_cases, stability
from orchestrator.studies.stability.cases import plan_of, shipped
from orchestrator.studies.stability.chart import draw, write
from orchestrator.studies.stability.classification import judged
from orchestrator.studies.stability.page import page

runner = CliRunner()
CASES = """
[[cases]]
name = "easy"
scenario = { extends = "oscillator-1", time = { stop = "2 cycles" } }
per_cycle = [4, 16, 64]
[[cases]]
name = "light"
scenario = { extends = "oscillator-1", time = { stop = "2 cycles" } }
set = { "payload.mass" = "1 mg" }
per_cycle = [16, 64]
[[cases]]
name = "gone"
scenario = { extends = "oscillator-1", time = { stop = "2 cycles" }, faults = [{ at = "1 cycle", on = "spring", kind = "drop" }] }
per_cycle = [16]
"""  # noqa: E501


@pytest.fixture(scope="module")
def study(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Study:
    file = tmp_path_factory.mktemp("cases") / "list.toml"
    file.write_text(CASES)
    methods = [Method("gauss-seidel", "curvature"), Method("jacobi", "held")]
    return stability(load_cases(file), file, library, methods=methods, workers=2)


def kinds(study: Study, case: str, master: str) -> dict[int, str]:
    """Class by steps in a cycle."""
    found = [t for t in study.trials if (t.case, t.master, t.auto) == (case, master, False)]
    return {t.per_cycle: t.kind for t in found}


def test_the_classes(study: Study) -> None:
    """Laws are accurate, held forces are noticed, a dropped instance stops every run."""
    assert kinds(study, "easy", "gauss-seidel")[16] == "accurate"
    assert kinds(study, "easy", "jacobi")[16] in {"inaccurate", "stopped"}
    assert set(kinds(study, "gone", "gauss-seidel").values()) == {"stopped"}
    assert study.count()["silent"] == study.count()["late"] == 0
    assert sum(study.count().values()) == len(study.trials)


def test_the_scenarios_own_setting_is_among_them(study: Study) -> None:
    usual = [t for t in study.trials if t.usual]
    assert {t.case for t in usual} == {"easy", "light", "gone"}
    assert {(t.master, t.laws, t.per_cycle) for t in usual} == {("gauss-seidel", "curvature", 60)}
    assert sum(study.count("usual").values()) == sum(study.count("auto").values()) == 3
    found = {t.case: t.kind for t in study.trials if t.auto}
    assert found == {"easy": "accurate", "light": "accurate", "gone": "stopped"}


def test_references(study: Study) -> None:
    assert "monolith" in study.references["easy"]
    assert "dropped out" in study.references["gone"]


def test_an_error_that_nothing_notices_is_silent(library: Path) -> None:
    """A run that is right by its own estimate, but not by the reference."""
    done = run(load("oscillator-1", None, library, time={"stop": "2 cycles"}))
    assert judged(done, 0.9, ["payload.displacement"]) == ("silent", "")
    assert judged(done, 0.009, ["payload.displacement"]) == ("accurate", "")
    loose = run(load("oscillator-1", None, library, master={"laws": "held", "kind": "jacobi"}))
    assert judged(loose, 0.9, ["payload.displacement"]) == ("inaccurate", "audit")


def test_table_and_heat_maps(study: Study, tmp_path: Path) -> None:
    with write(study, tmp_path / "s.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(study.trials)
    noticed = {row["noticed_by"] for row in rows if row["kind"] == "inaccurate"}
    assert noticed <= {"audit", "estimate"}
    assert draw(study, tmp_path / "s.svg").read_text().startswith("<?xml")


def test_a_page_of_all_trials(study: Study) -> None:
    """A row for each case and master, and the reasons of what stopped."""
    text = rendered(page(replace(study, references={"easy": "<b>"})))
    rows = {(t.case, t.master, t.laws) for t in study.trials}
    laws = {t.laws for t in study.trials}
    assert text.count("<tr>") == 1 + len(CLASSES) + len(laws) + len(rows)
    assert "dropped out" in text
    assert "easy: &lt;b&gt;" in text


def test_shipped_cases_are_whole(library: Path) -> None:
    """Every case of the list that comes with the package is a scenario that loads."""
    cases = load_cases(shipped())
    assert len(cases) >= 35
    for case in cases:
        plan = plan_of(case, shipped(), library)
        assert plan.frequency
        assert case.title


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("cases = 3", "cases"),
        ("[[cases]]\nname = 'a'", "scenario: Field required"),
        (CASES + CASES, "more than one is called easy, gone, light"),
        ("[[cases]]\nname = 'a'\nscenario = {}\nper_cycle = [0]", "per_cycle.0"),
        ("[[cases", "not TOML"),
    ],
)
def test_a_bad_list_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(text)
    with pytest.raises(ScenarioError, match=reason):
        load_cases(file)


def test_all_problems_of_all_cases_at_once(library: Path, tmp_path: Path) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(
        '[[cases]]\nname = "a"\nscenario = { extends = "oscillator-9" }\n'
        '[[cases]]\nname = "b"\nscenario = { extends = "oscillator-1" }\n'
        'set = { "spring.mass" = 1 }\n'
    )
    with pytest.raises(ScenarioError) as caught:
        stability(load_cases(file), file, library)
    assert [p.split(":")[0] for p in caught.value.problems] == ["case a", "case b"]
    with pytest.raises(ScenarioError, match=r"cases: no 'c'; there are a, b"):
        load_cases(file, ["c"])


@pytest.mark.slow
def test_the_command(library: Path, tmp_path: Path) -> None:
    file = tmp_path / "one.toml"
    file.write_text(CASES)
    options = ["--fmus", str(library), "--output", str(tmp_path / "s.csv"), "--workers", "1"]
    chosen = ["--cases", str(file), "--case", "gone", "--method", "gauss-seidel"]
    done = runner.invoke(app, ["stability", *chosen, *options, "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["count"]["stopped"] == 3
    done = runner.invoke(app, ["stability", *chosen, *options, "--html", str(tmp_path / "s.html")])
    assert done.exit_code == 0, done.output
    assert "page: " in done.output
    assert (tmp_path / "s.html").read_text().endswith("</html>\n")
    both = runner.invoke(app, ["stability", "oscillator-1", *chosen, *options])
    assert both.exit_code == 2
    assert "not both" in both.output
