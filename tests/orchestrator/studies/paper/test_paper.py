"""The paper, reproduced: marks that say what a number is, runs that are kept, the command."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from importlib import resources
from pathlib import Path

import control
import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InputError, OutputError, ScenarioError
from orchestrator.report.page import rendered
from orchestrator.scenario.files import scenario_names
from orchestrator.studies.paper import published_values
from orchestrator.studies.paper.beyond.control_loops import predicted
from orchestrator.studies.paper.cached_runs import CachedRuns
from orchestrator.studies.paper.comparison import Comparison, Row
from orchestrator.studies.paper.equation6 import equation6
from orchestrator.studies.paper.figure7 import figure7
from orchestrator.studies.paper.figure13 import figure13
from orchestrator.studies.paper.frequency_sweep import FrequencySweep, Sweep, frequency_sweeps
from orchestrator.studies.paper.job import Answer, Job, carry_out, identity
from orchestrator.studies.paper.metrics import amplitude, harmonics, power
from orchestrator.studies.paper.page import TONES, facts, page
from orchestrator.studies.paper.reproduction import BEYOND, COMPARISONS, Reproduction, chosen
from orchestrator.studies.run_cache import RunCache

runner = CliRunner()
SHORT = Job("oscillator-1", length=4, per_cycle=20, cycles=2, keep=("payload.kinetic_energy",))


@pytest.fixture(scope="module")
def cached_runs(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[CachedRuns]:
    with CachedRuns(library, RunCache(tmp_path_factory.mktemp("runs")), workers=1) as made:
        yield made


def test_every_number_has_a_mark_and_a_place() -> None:
    for item in COMPARISONS:
        assert published_values.keys(item)
        for key in published_values.keys(item):
            stated = published_values.number(key)
            mark = published_values.mark(key, "film")
            assert stated.quantity
            assert stated.where
            assert stated.scale > 0.0
            assert mark.kind in TONES
            assert mark.basis


def test_what_was_calibrated_on_is_no_prediction() -> None:
    """Five numbers of figure 11 were fitted; the sixth is predicted: docs/reference/model.md."""
    kinds = {key: published_values.mark(key).kind for key in published_values.keys("figure11")}
    predicted = [key for key, kind in kinds.items() if kind == "predicted"]
    assert predicted == ["figure11.full_wings_stroke"]
    assert set(kinds.values()) == {"predicted", "calibrated"}
    for key, model in (
        ("figure3.main_amplitude", "scenario"),
        ("figure3.vhb_low", ""),
        ("table1.displacement_1", "film"),
        ("table1.measured_5", "film"),
    ):
        assert published_values.mark(key, model).kind == "calibrated"


def test_a_mark_of_one_model_is_not_that_of_another() -> None:
    """A frequency of printed stiffness and mass follows from them; one of the film does not."""
    assert published_values.mark("table1.measured_2", "spring").kind == "arithmetic"
    assert published_values.mark("table1.measured_2", "film").kind == "calibrated"
    assert published_values.mark("table1.displacement_4", "spring").kind == "predicted"
    assert published_values.mark("figure3.low", "").kind == "undecidable"


def test_scenes_of_the_paper_are_no_scenes_to_run() -> None:
    assert not {"numbers", "marks", "bands"} & set(scenario_names())


def test_a_band_judges_what_was_not_fitted() -> None:
    """Within it, beyond it, and of a datum that the fit has met anyway."""
    stroke = published_values.number("figure11.full_wings_stroke")
    near = Row("figure11.full_wings_stroke", 1.01 * float(stroke.value) * stroke.scale)
    far = Row("figure11.full_wings_stroke", 1.10 * float(stroke.value) * stroke.scale)
    fitted = Row("figure11.no_wing_stroke", 1.0)
    assert (near.held, far.held, fitted.held) == (True, False, None)
    assert fitted.mark.band == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("denominator", "gain"), [([1.0, -1.0, 0.0], 2.0), ([1.0, -0.75], math.inf)]
)
def test_margins_of_a_loop(denominator: list[float], gain: float) -> None:
    """An integrator, a cycle late: z^2 - z + k is stable up to k = 1; its turn at 0 Hz is none.

    The phase of a lag turns at no frequency below half the rate.
    """
    found = predicted(control.ss(control.tf([0.5], denominator, 0.1)))
    assert found.gain == pytest.approx(gain)
    assert found.crossover > 0.0


def test_every_band_is_of_a_number() -> None:
    stated = {key for item in COMPARISONS for key in published_values.keys(item)}
    found = tomllib.loads(
        (resources.files("scenarios") / "paper" / "bands.toml").read_text(encoding="utf-8")
    )
    for item, bands in found.items():
        for name in bands:
            key = f"{item}.{name.removesuffix('_film').removesuffix('_scenario')}"
            assert key in stated


def test_a_row_against_the_paper() -> None:
    row = Row("figure11.full_wings_stroke", math.radians(64.8), doubt=math.radians(0.1))
    assert row.error == pytest.approx(64.8 / 63.0 - 1.0)
    told = row.facts()
    assert told["ours"] == pytest.approx(64.8)
    assert told["numerical_error"] == pytest.approx(0.1)
    assert told["mark"] == "predicted"
    assert math.isnan(Row("figure13.ratio", "there", agrees=True).error)


def test_names_of_items() -> None:
    assert chosen([]) == [*COMPARISONS, *BEYOND]
    assert chosen(["table1", "figure3"]) == ["figure3", "table1"]
    with pytest.raises(InputError, match="did you mean 'figure11'"):
        chosen(["figure 11"])


def test_a_run_is_made_once(library: Path, tmp_path: Path) -> None:
    """A second lab over the same folder has the answer without a worker; a changed one has not."""
    folder = tmp_path / "runs"
    with CachedRuns(library, RunCache(folder), workers=1) as first:
        (answer,) = first.answers([SHORT])
        assert first.answers([SHORT, SHORT]) == [answer, answer]
    assert first.ran == 1
    assert answer.status == "done"
    assert [p.suffix for p in folder.iterdir()] == [".json"]
    with CachedRuns(library, RunCache(folder), workers=1) as second:
        (again,) = second.answers([SHORT])
    assert second.ran == 0
    assert again.metrics == answer.metrics
    np.testing.assert_array_equal(again.series("kinetic_energy"), answer.series("kinetic_energy"))


def test_what_an_identity_depends_on(library: Path, tmp_path: Path) -> None:
    """Scenario, start values, steps, what is looked at, and the FMUs' bytes."""
    one = identity(SHORT, library)
    others = [
        replace(SHORT, scenario="oscillator-2"),
        replace(SHORT, changes={"payload.mass": "1 g"}),
        replace(SHORT, cycles=3),
        replace(SHORT, keep=()),
        SHORT.halved(),
    ]
    keys = {identity(other, library) for other in others if other is not None}
    assert len(keys) == len(others)
    assert one not in keys
    for name in ("amplifier", "spring", "payload"):
        (tmp_path / f"{name}.fmu").write_bytes(name.encode())
    first = identity(SHORT, tmp_path)
    (tmp_path / "spring.fmu").write_bytes(b"another")
    assert len({one, first, identity(SHORT, tmp_path)}) == 3


@pytest.mark.parametrize("damage", ["", "{", '{"answer": {}, "sha256": ""}', "[]"])
def test_a_damaged_answer_is_none(tmp_path: Path, damage: str) -> None:
    store = RunCache(tmp_path)
    answer = {"status": "done", "reason": "", "metrics": {}, "times": [], "rows": {},
              "wall_time": 0.0, "steps": 1}  # fmt: skip
    store.write("key", answer)
    assert store.read("key") is not None
    (tmp_path / "key.json").write_text(damage)
    assert store.read("key") is None
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be made"):
        RunCache(tmp_path / "file" / "runs").prepare()


def test_a_run_that_stops_is_an_answer(library: Path) -> None:
    """Its reason stays; a number of it is none."""
    job = replace(SHORT, changes={"payload.start_velocity": "9000"})
    content = carry_out((job, str(library), ""))
    assert content["status"] == "failed"
    assert content["reason"]
    assert math.isnan(
        FrequencySweep(Sweep("a", [1.0]), {1.0: Answer("failed", "why")}).at(1.0, amplitude)
    )
    unfit = carry_out((replace(SHORT, scenario="oscillator-9"), str(library), ""))
    assert "unfit" in unfit


def test_missing_parts_are_told_before_anything_runs(tmp_path: Path) -> None:
    with (
        CachedRuns(tmp_path / "none", RunCache(tmp_path / "runs"), workers=1) as cached_runs,
        pytest.raises(ScenarioError, match="resilin build"),
    ):
        cached_runs.answers([SHORT])


def test_a_peak_is_refined_and_its_step_judged(cached_runs: CachedRuns) -> None:
    """Oscillator 3 by five frequencies: what lies between is found by bisection."""
    sweep = Sweep("oscillator-3", [20.0, 23.0, 26.0, 29.0], settle=0.2, per_cycle=30)
    (found,) = frequency_sweeps(cached_runs, [sweep], amplitude)
    assert len(found.answers) > 4
    peak = found.peak(amplitude)
    assert peak is not None
    assert 23.0 < peak.at < 26.5
    assert found.maxima(amplitude)[0].value == pytest.approx(peak.value)
    measured = cached_runs.measured(sweep.job(26.0), amplitude)
    assert 0.0 < measured.doubt < 0.02 * measured.value


def test_power_of_a_harmonic_motion() -> None:
    """2 f E_max, and the printed definition would be zero."""
    times = np.linspace(0.0, 1.0, 4001)
    energy = 1e-3 * np.cos(2.0 * np.pi * 10.0 * times) ** 2
    answer = Answer("done", times=times, rows={"payload.kinetic_energy": energy})
    assert power(answer) == pytest.approx(2.0 * 10.0 * 1e-3, rel=1e-4)
    wave = np.sin(20.0 * np.pi * times) + 0.03 * np.sin(60.0 * np.pi * times)
    assert harmonics(times, wave, 10.0) == pytest.approx(0.03, rel=1e-2)


@pytest.fixture(scope="module")
def quick(cached_runs: CachedRuns) -> list[Comparison]:
    """Items that cost a few runs."""
    return [figure7(cached_runs), figure13(cached_runs), equation6(cached_runs)]


def test_items_have_rows_marks_and_curves(quick: list[Comparison]) -> None:
    for item in quick:
        assert not item.failures
        assert {row.key for row in item.rows} == set(published_values.keys(item.key))
        assert all(row.mark.basis for row in item.rows)
        assert all(curve.x for f in item.figures for plot in f.plots for curve in plot.curves)


def test_numbers_that_the_model_document_states(quick: list[Comparison]) -> None:
    pull, _, lift = quick
    stiffness = {row.reading: row.ours for row in pull.rows if row.key == "figure7.stiffness"}
    assert stiffness["L = 30 mm"] == pytest.approx(85.0, rel=1e-2)
    implied = {row.key: row.ours for row in lift.rows if row.key.endswith("coefficient")}
    assert implied == {
        "equation6.coefficient": "2.06",
        "equation6.short_coefficient": "1.61",
        "equation6.long_coefficient": "2.52",
    }


def test_the_page_holds_every_row(quick: list[Comparison], library: Path) -> None:
    found = Reproduction(quick, 0, 0.0)
    text = rendered(page(found, library))
    for item in quick:
        assert f'id="{item.key}"' in text
    told = facts(found)
    assert len(told["rows"]) == sum(len(item.rows) for item in quick)
    assert {"figure4", "figure7", "figure13a", "figure13b", "equation6"} == set(told["curves"])


def test_the_command_and_its_second_time(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "out" / "page.html"
    line = ["paper", "figure13", "--output", str(target), "--fmus", str(library), "--json"]
    done = runner.invoke(app, [*line, "--workers", "1"])
    assert done.exit_code == 0, done.output
    first = json.loads(done.stdout)
    assert first["runs"] == 1
    assert {row["mark"] for row in first["rows"]} <= set(TONES)
    names = sorted(p.name for p in target.parent.iterdir())
    assert names == [
        *("drawn.json", "figure13a.png", "figure13a.svg", "figure13b.png", "figure13b.svg"),
        *("page.html", "page.runs"),
    ]
    drawn = (target.parent / "figure13a.png").stat().st_mtime_ns
    again = runner.invoke(app, line)
    second = json.loads(again.stdout)
    assert second["runs"] == 0
    assert second["rows"] == first["rows"]
    assert (target.parent / "figure13a.png").stat().st_mtime_ns == drawn


def test_wrong_input_writes_nothing(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    given = ["--output", str(target), "--fmus", str(library)]
    done = runner.invoke(app, ["paper", "figure33", *given])
    assert done.exit_code == 2
    assert "did you mean 'figure3'?" in done.output
    done = runner.invoke(app, ["paper", "figure13", "--output", str(tmp_path / "page.pdf")])
    assert done.exit_code == 2
    assert "name it *.html" in done.output
    done = runner.invoke(app, ["paper", "figure13", *given, "--native"])
    assert done.exit_code == 2
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_all_of_the_paper(native: Path, tmp_path: Path) -> None:
    """Every number has a row, nothing stops, and the page is small enough to send."""
    target = tmp_path / "paper.html"
    line = ["paper", "--output", str(target), "--fmus", str(native), "--json"]
    done = runner.invoke(app, line)
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    stated = {key for item in COMPARISONS for key in published_values.keys(item)}
    assert {row["key"] for row in told["rows"]} == stated
    assert not told["failures"]
    assert target.stat().st_size < 8e6
    rows = {row["key"]: row for row in told["rows"]}
    assert rows["figure11.full_wings_stroke"]["ours"] == pytest.approx(63.31, rel=2e-3)
    beyond_the_paper(told["tables"])
    again = json.loads(runner.invoke(app, line).stdout)
    assert again["runs"] == 0
    assert again["rows"] == told["rows"]


def beyond_the_paper(tables: dict[str, list[dict[str, float | str]]]) -> None:
    """What the sections beyond the paper say in words, by the numbers of their tables."""
    assert set(tables) == set(BEYOND) - {"animation"}
    first = {(r["Model"], r["Drive"]): r for r in tables["superharmonic"]}
    for model in ("full membrane", "linear spring"):
        assert first[model, "half-wave sine"]["Main over first"] == pytest.approx(3.0, rel=0.03)
    assert first["linear spring", "raised sine"]["First peak"] == "none"
    cost = {str(r["Drive"]): r for r in tables["electrode"]}
    at_46 = [float(cost[f"{n} layers, 46 Hz"]["0.5 mA"]) for n in (2, 4, 6, 8)]
    assert at_46 == sorted(at_46, reverse=True)
    assert at_46[0] > 0.9 and at_46[-1] < 0.4
    rubbing = [r for r in tables["hovering"] if r["Dry friction"] == 1.0]
    assert 0.2 < max(float(r["Lift over cones"]) for r in rubbing) < 0.25
    assert 0.28 < max(float(r["Lift over cones"]) for r in tables["hovering"]) < 0.33
    known = next(r for r in rubbing if (r["Wing"], r["Layers"], r["Drive"]) == (0.04, 8, 1920.0))
    assert known["Frequency"] == pytest.approx(18.0, rel=0.05)
    apart = {str(r["Quantity"]): r for r in tables["permittivity"]}
    mended = apart["table 1, displacements, root mean square"]
    assert float(mended["Falling"]) < 0.7 * float(mended["Constant"])
    broken = apart["table 2, power of 4 layers"]
    assert float(broken["Falling"]) > 1.2 * float(broken["Constant"])
