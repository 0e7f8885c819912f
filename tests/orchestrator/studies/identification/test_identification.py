"""Parameters from recordings: values, intervals, remarks, and what is refused."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InputError, SimulationError
from orchestrator.results.netcdf import write
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from orchestrator.studies.identification import (
    Asked,
    Case,
    Identified,
    Settings,
    case_of,
    identify,
    unknowns_of,
)
from orchestrator.studies.identification.table import facts, figure, objections, remarks

runner = CliRunner()
TRUTH = {"spring.stiffness": 63.5, "spring.loss_factor": 0.278, "payload.mass": 0.603e-3}
NOISE = 2e-5
"""Standard deviation of the displacement's noise [m]: 0.3 % of the amplitude."""

OSCILLATOR = Asked(["spring", "payload"], "oscillator-1", outputs=("payload.motion.displacement",))


@pytest.fixture(scope="session")
def oscillation(native: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Voltages and displacement of oscillator 1 from rest, without noise, as our own result."""
    record = {"variables": ["amplifier.*.voltage", "payload.motion.displacement"]}
    time = {"stop": "5 cycles", "step": {"per_cycle": 40}}
    outcome = run(load("oscillator-1", None, native, time=time, record=record))
    assert outcome.failure is None
    return write(outcome, tmp_path_factory.mktemp("identification") / "clean.nc")


def noisy(clean: Path, path: Path, seed: int, size: float = NOISE, fading: float = 0.0) -> Path:
    """The same with noise on the displacement; with `fading` it is correlated from row to row."""
    import xarray

    with xarray.open_dataset(clean) as data:
        columns = {str(name): np.array(values) for name, values in data.data_vars.items()}
        times = np.array(data["time"])
    rng = np.random.default_rng(seed)
    noise = size * rng.standard_normal(len(times))
    for k in range(1, len(times)):
        noise[k] = fading * noise[k - 1] + np.sqrt(1.0 - fading**2) * noise[k]
    columns["payload.motion.displacement"] += noise
    rows = np.column_stack([times, *columns.values()])
    header = ",".join(["time", *columns])
    np.savetxt(path, rows, fmt="%.17g", delimiter=",", header=header, comments="")
    return path


def fitted(path: Path, native: Path, asked: Asked = OSCILLATOR) -> Identified:
    case = case_of(path, asked, native)
    return identify(case, unknowns_of(list(TRUTH), case.plan, list(asked.parts)))


@pytest.mark.parametrize("count", [3, pytest.param(100, marks=pytest.mark.slow)])
def test_known_parameters_lie_within_their_intervals(
    native: Path, tmp_path: Path, oscillation: Path, count: int
) -> None:
    """Over many seeds 95 % intervals hold the truth in about 95 % of the fits."""
    truth = np.array(list(TRUTH.values()))
    held, errors, widths = [], [], []
    for seed in range(count):
        found = fitted(noisy(oscillation, tmp_path / "noisy.csv", seed), native)
        errors.append((found.values - truth) / truth)
        widths.append(found.intervals / truth)
        held.append(np.abs(found.values - truth) <= found.intervals)
        assert found.sizes[0] == pytest.approx(NOISE, rel=0.25)
    share = np.mean(held, axis=0)
    print(f"{count} seeds: held {share}, mean errors {np.mean(errors, axis=0)}")
    assert (share >= (0.6 if count < 100 else 0.88)).all()
    assert (np.abs(np.mean(errors, axis=0)) < 3.0 * np.mean(widths, axis=0) / np.sqrt(count)).all()
    assert (np.mean(widths, axis=0) < [2e-2, 2e-2, 2e-2]).all()


def pushed(path: Path, noise: float = 0.0, head: str = "") -> Path:
    """0.6 g under a force of 10 mN at 20 Hz, with its position in closed form."""
    t = np.linspace(0.0, 0.2, 401)
    w, mass = 2.0 * np.pi * 20.0, 0.6e-3
    force = 0.01 * np.sin(w * t)
    x = 0.01 / mass * (t / w - np.sin(w * t) / w**2)
    x = x + noise * np.random.default_rng(5).standard_normal(len(t))
    rows = np.column_stack([t, force, x])
    head = head or "time,force.value [N],displacement [m]"
    np.savetxt(path, rows, fmt="%.17g", delimiter=",", header=head, comments="")
    return path


def test_a_part_alone(native: Path, tmp_path: Path) -> None:
    """Its inputs are columns; the others are held at the FMU's start values."""
    case = case_of(pushed(tmp_path / "bench.csv", 1e-6), Asked(["payload"]), native)
    assert case.pairs == [("recording.displacement", "payload.displacement")]
    found = identify(case, unknowns_of(["mass=0.1 g:5 g"], case.plan, ["payload"]))
    assert found.values[0] == pytest.approx(0.6e-3, abs=3.0 * found.intervals[0])
    assert found.intervals[0] < 1e-6
    assert not list(remarks(found))
    assert found.shares[0] > 0.999


def test_python_parts_and_native_ones_give_the_same(
    python_parts: Path, native: Path, tmp_path: Path
) -> None:
    path = pushed(tmp_path / "bench.csv", 1e-6)
    values = []
    for folder in (python_parts, native):
        case = case_of(path, Asked(["payload"]), folder)
        values.append(identify(case, unknowns_of(["mass"], case.plan, ["payload"])).values[0])
    assert values[0] == values[1]


def test_an_fmu_by_its_path_and_columns_by_other_names(native: Path, tmp_path: Path) -> None:
    path = pushed(tmp_path / "bench.csv", head="t (s),push (N),place (m)")
    keys = {"columns.push": "force.value", "columns.place": "motion.displacement"}
    asked = Asked([str(native / "payload.fmu")], keys=keys, changes={"mass": "1 g"})
    case = case_of(path, asked, tmp_path)
    found = identify(case, unknowns_of(["mass"], case.plan, ["payload"]))
    assert found.unknowns[0].start == 1e-3
    assert found.values[0] == pytest.approx(0.6e-3, rel=1e-4)


def test_a_start_in_motion_is_a_parameter_too(native: Path, tmp_path: Path) -> None:
    path = tmp_path / "bench.csv"
    t = np.linspace(0.0, 0.1, 101)
    rows = np.column_stack([t, 0.0 * t, 2e-3 + 0.3 * t])
    np.savetxt(path, rows, "%.17g", ",", header="t,force.value,displacement", comments="")
    case = case_of(path, Asked(["payload"]), native)
    names = ["start_displacement=-1 cm:1 cm", "start_velocity=-1 m/s:1 m/s"]
    found = identify(case, unknowns_of(names, case.plan, ["payload"]))
    assert found.values == pytest.approx([2e-3, 0.3], rel=1e-6)


def test_each_output_counts_by_its_own_noise(native: Path, tmp_path: Path) -> None:
    """A velocity with a hundredfold noise neither spoils the fit nor goes unused."""
    path = pushed(tmp_path / "bench.csv", 1e-7)
    t, force, x = np.loadtxt(path, delimiter=",", skiprows=1).T
    rng = np.random.default_rng(2)
    w = 2.0 * np.pi * 20.0
    v = 0.01 / 0.6e-3 / w * (1.0 - np.cos(w * t)) + 1e-3 * rng.standard_normal(len(t))
    head = "time,force.value,displacement,velocity"
    np.savetxt(path, np.column_stack([t, force, x, v]), "%.17g", ",", header=head, comments="")
    case = case_of(path, Asked(["payload"]), native)
    found = identify(case, unknowns_of(["mass"], case.plan, ["payload"]))
    assert found.sizes == pytest.approx([1e-7, 1e-3], rel=0.2)
    assert found.values[0] == pytest.approx(0.6e-3, abs=3.0 * found.intervals[0])


@pytest.mark.slow
def test_coloured_noise_widens_the_intervals(
    native: Path, tmp_path: Path, oscillation: Path
) -> None:
    white = fitted(noisy(oscillation, tmp_path / "white.csv", 3), native)
    coloured = fitted(noisy(oscillation, tmp_path / "red.csv", 3, fading=0.9), native)
    assert white.widened == 1.0
    assert coloured.widened > 2.0
    assert any("are not noise" in line for line in remarks(coloured))


@pytest.mark.slow
def test_what_the_data_do_not_determine_is_remarked(
    native: Path, tmp_path: Path, oscillation: Path
) -> None:
    path = noisy(oscillation, tmp_path / "noisy.csv", 1)
    case = case_of(path, replace(OSCILLATOR, changes={"payload.mass": "0.5 g"}), native)

    def remarked(*names: str) -> str:
        unknowns = unknowns_of(names, case.plan, OSCILLATOR.parts)
        return "\n".join(remarks(identify(case, unknowns)))

    assert "cannot be distinguished" in remarked("spring.loss_factor", "spring.loss_frequency")
    assert "end of its range" in remarked("payload.mass=0.2 g:0.6 g")


def test_rows_that_are_skipped_do_not_count(native: Path, tmp_path: Path) -> None:
    path = pushed(tmp_path / "bench.csv")
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    rows[:50, 2] += 1.0
    head = "time,force.value,displacement"
    np.savetxt(path, rows, "%.17g", ",", header=head, comments="")
    case = case_of(path, Asked(["payload"]), native)
    unknowns = unknowns_of(["mass"], case.plan, ["payload"])
    found = identify(case, unknowns, Settings(skip=0.03))
    assert found.values[0] == pytest.approx(0.6e-3, rel=1e-3)
    assert int(found.counted.sum()) == 401 - 60


def test_a_step_of_its_own(native: Path, tmp_path: Path) -> None:
    path = pushed(tmp_path / "bench.csv")
    case = case_of(path, Asked(["payload"], step=1e-3), native)
    assert len(case.points) == 201
    found = identify(case, unknowns_of(["mass"], case.plan, ["payload"]))
    assert found.values[0] == pytest.approx(0.6e-3, rel=1e-4)


def test_facts_and_figure(native: Path, tmp_path: Path) -> None:
    case = case_of(pushed(tmp_path / "bench.csv", 1e-6), Asked(["payload"]), native)
    found = identify(case, unknowns_of(["mass"], case.plan, ["payload"]))
    content = facts(found)
    assert content["parameters"]["payload.mass"]["unit"] == "kg"
    residual = content["outputs"]["payload.displacement"]["residual_rms"]
    assert residual == pytest.approx(1e-6, rel=0.2)
    assert [plot.title for plot in figure(found).plots] == [
        "payload.displacement", "payload.displacement: recorded less fitted",
    ]  # fmt: skip
    json.dumps(content)


def test_parts_that_stop_at_their_start_values(native: Path, tmp_path: Path) -> None:
    path = pushed(tmp_path / "bench.csv")
    case = case_of(path, Asked(["payload"], hold={"force.stiffness": "1e30 N/m"}), native)
    with pytest.raises(SimulationError, match="too stiff"):
        identify(case, unknowns_of(["mass"], case.plan, ["payload"]))


def called(native: Path, *arguments: str) -> tuple[int, str, str]:
    done = runner.invoke(app, ["fit", *arguments, "--fmus", str(native)])
    return done.exit_code, done.stdout, done.stderr


def test_the_command(
    native: Path, tmp_path: Path, oscillation: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, output, _ = called(
        native, str(oscillation), "--scenario", "oscillator-1", "--part", "spring", "--part",
        "payload", "--parameter", "payload.mass,spring.loss_factor=0.1:0.5", "--set",
        "payload.mass=0.7 g", "--html", "fit.html", "--json",
    )  # fmt: skip
    assert code == 0
    mass = json.loads(output)["parameters"]["payload.mass"]
    assert mass["value"] == pytest.approx(0.603e-3, rel=1e-3)
    assert mass["start"] == pytest.approx(0.7e-3)
    assert Path("results/clean-fit.png").stat().st_size > 10_000
    assert "payload.motion.displacement" in Path("fit.html").read_text()
    code, output, _ = called(
        native, str(pushed(tmp_path / "bench.csv", 1e-6)), "--part", "payload", "--parameter",
        "mass", "--output", "fit.svg",
    )  # fmt: skip
    assert code == 0
    assert "payload.mass" in output
    assert "0.0006" in output


BENCH = ("bench.csv", "--part", "payload", "--parameter", "mass")
SCENARIO = ("--scenario", "oscillator-1", "--part", "payload", "--parameter", "mass")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nothing.csv", *BENCH[1:]), "no such recording"),
        (("bench.csv", "--part", "payload", "--parameter", "mas"), "did you mean 'mass'"),
        (("bench.csv", "--part", "paylod", "--parameter", "mass"), "did you mean 'payload'"),
        (("bench.csv", "--part", "no.fmu", "--parameter", "mass"), "no such file"),
        (("bench.csv", "--part", "payload", "--parameter", ""), "no real parameter"),
        (("bench.csv", "--part", "payload", "--parameter", "mass,mass"), "named twice"),
        (("bench.csv", "--part", "payload", "--parameter", "spring.mass"), "no real parameter"),
        (("bench.csv", "--part", "payload", "--parameter", "mass=1 g"), "low:high"),
        (("bench.csv", "--part", "payload", "--parameter", "mass=2 g:1 g"), "is not a range"),
        (("bench.csv", "--part", "payload", "--parameter", "mass=-2 g:1 g"), "is outside"),
        (("bench.csv", "--part", "payload", "--parameter", "mass=1 m:2 m"), "quantity in kg"),
        (("bench.csv", "--part", "payload", "--parameter", "mass=1 g:2 g"), "starts at"),
        (("bench.csv", "--part", "payload", "--parameter", "start_velocity"), "give bounds"),
        (("bench.csv", "--part", "aero", "--parameter", "air_density"), "no column of an input"),
        (
            ("bench.csv", "--part", "aero", "--parameter", "air_density"),
            "=motion.flap_angle",
        ),
        (
            ("bench.csv", "--part", "payload", "--part", "spring", "--parameter", "mass"),
            "--scenario",
        ),
        (("two.csv", *BENCH[1:]), "too few to fit"),
        (("inputs.csv", *BENCH[1:]), "no column of an output"),
        (("inputs.csv", *BENCH[1:]), "say which column it is, as --with columns.force.value="),
        ((*BENCH, "--variable", "flap_angle"), "no such recorded output"),
        ((*BENCH, "--with", "repaet=true"), "repaet: unknown key"),
        ((*BENCH, "--with", "cubic"), "write key=value"),
        ((*BENCH, "--hold", "force.valu=1 N"), "no input 'force.valu'"),
        ((*BENCH, "--set", "mas=1 g"), "did you mean 'mass'"),
        ((*BENCH, "--step", "1 kg"), "quantity in s"),
        ((*BENCH, "--step", "0 s"), "above zero"),
        ((*BENCH, "--skip", "-1 s"), "not below"),
        ((*BENCH, "--skip", "10 s"), "do not determine"),
        ((*BENCH, "--level", "1.5"), "between 0 and 1"),
        ((*BENCH, "--output", "fit.doc"), "name it *.png"),
        ((*BENCH, "--html", "fit.txt"), "pages are HTML"),
        (("bench.csv", *SCENARIO), "has no column of spring.force"),
        (("bench.csv", *SCENARIO), "=spring.force, record it"),
        (("bench.csv", "--scenario", "oscilator-1", *SCENARIO[2:]), "did you mean 'oscillator-1'"),
        (("bench.csv", *SCENARIO[:2], "--part", "paylod", *SCENARIO[4:]), "did you mean 'payload'"),
    ],
)
def test_bad_input_is_reported_in_a_line(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...],
    message: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    pushed(Path("bench.csv"))
    Path("two.csv").write_text("time,force.value,displacement\n0,0,0\n1,0,0\n")
    Path("inputs.csv").write_text("time,force.value\n0,0\n1,0\n2,0\n")
    code, output, errors = called(native, *arguments)
    assert code == 2, errors
    assert output == ""
    assert re.search(re.escape(message), errors), errors
    assert all(line.startswith("resilin: ") for line in errors.strip().splitlines())
    assert not list(tmp_path.glob("**/*.png"))
    assert not list(tmp_path.glob("**/*.html"))


@pytest.mark.parametrize("parts", [["spring", "payload"], ["payload", "spring"]])
@pytest.mark.parametrize("order", ["", 'order = ["amplifier", "payload", "spring"]'])
def test_parts_step_in_the_order_of_their_scenario(
    native: Path, tmp_path: Path, oscillation: Path, parts: list[str], order: str
) -> None:
    scenario = tmp_path / "mine.toml"
    scenario.write_text(f'extends = "oscillator-1"\n[master]\n{order}\n')
    whole = load(scenario, None, native).order
    asked = replace(OSCILLATOR, parts=parts, scenario=str(scenario))
    case = case_of(oscillation, asked, native)
    assert case.plan.order == ["recording", *(name for name in whole if name in parts)]


def test_values_that_are_no_result_say_so_below_the_table(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Little explained of an output that another part has made; noise alone is no objection."""
    monkeypatch.chdir(tmp_path)
    pushed(Path("noisy.csv"), 0.2)
    case = case_of(Path("noisy.csv"), Asked(["payload"], step=2e-3), native)
    found = identify(case, unknowns_of(["mass"], case.plan, ["payload"]))
    assert found.shares[0] < 0.9
    assert not list(objections(found))
    rows = np.loadtxt(pushed(Path("bench.csv")), delimiter=",", skiprows=1)[::10]
    rows[:, 2] = 0.01 * np.sin(60.0 * rows[:, 0])
    head = "time,force.value,displacement"
    np.savetxt("bench.csv", rows, "%.17g", ",", header=head, comments="")
    code, output, _ = called(native, *BENCH, "--html", "fit.html", "--output", "f.svg")
    assert code == 0
    table, _, rest = output.partition("not a result: the parts explain")
    assert "fitted" in table
    assert "explained" not in table
    assert "do not rely on these values" in rest
    assert "not a result" in Path("fit.html").read_text()


def test_a_step_that_decides_the_values_is_an_objection(native: Path, tmp_path: Path) -> None:
    """Hardly more than one row for a period of the force: the mass is 15 % too large."""
    case = case_of(pushed(tmp_path / "bench.csv"), Asked(["payload"], step=0.04), native)
    found = identify(case, unknowns_of(["mass"], case.plan, ["payload"]))
    assert found.values[0] > 0.65e-3
    assert any("the step decides these values" in line for line in objections(found))
    assert facts(found)["objections"]


def test_a_case_names_its_units(native: Path, tmp_path: Path) -> None:
    case: Case = case_of(pushed(tmp_path / "bench.csv"), Asked(["payload"]), native)
    assert case.units == ["m"]
    with pytest.raises(InputError, match="at least one"):
        unknowns_of([], case.plan, ["payload"])
