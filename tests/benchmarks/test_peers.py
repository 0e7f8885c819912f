"""The benchmark against other tools: each installed one steps as docs/reference/peers.md has it."""

from __future__ import annotations

import csv
import math
import signal
import sys
from pathlib import Path

import numpy as np
import pytest
from peers import measured_run as runs
from peers.cli import main
from peers.figures import Cost, cost, oscillation
from peers.measured_run import MeasuredRun, Setting
from peers.reference import Reference
from peers.table import ratio
from peers.tools import TOOLS
from peers.wiring import case_of

from .bare import Bare

SCENARIO = "oscillator-1"
STEPS, CYCLES = 60, 2.0
OWN = {"cofmpy": Path(sys.prefix) / "cofmpy" / "bin" / "python"}
"""Tools with an environment of their own, which the Makefile makes."""
SEQUENTIAL = {
    ("pathsim-fmi", "fixed step"),
    ("cofmpy", "gauss-seidel"),
    ("mastersim", "gauss-seidel"),
}
COMPILED = {"mastersim"}
"""Tools that are no Python process, and take FMUs that need none."""
EXACT = {"fmpy.ssp", "cofmpy"}
"""Tools that start like the bare loop, with zeros; the others pass initial outputs on before the
first step, and libcosim rounds its step to nanoseconds."""

FOREIGN = [
    pytest.param(tool.name, method.name, wiring, id=f"{tool.name} {method.name} {wiring}")
    for tool in TOOLS.values()
    if tool.name not in {"ours", "scipy"}
    for method in tool.methods
    if method.varied == "steps"
    for wiring in method.wirings
]


def setting(tool: str, method: str, wiring: str, place: float = STEPS) -> Setting:
    return Setting(tool, method, wiring, "steps", place)


def done(library: Path, tool: str, method: str, wiring: str) -> MeasuredRun:
    """A tool's run; skipped where the tool is not there."""
    case = case_of(SCENARIO, library, wiring, STEPS, CYCLES)
    python = str(OWN[tool]) if tool in OWN and OWN[tool].exists() else ""
    found = runs.run(case, setting(tool, method, wiring), 60.0, 1, python)
    if found.status == "not installed":
        pytest.skip(found.reason)
    assert found.status == "done", found.reason
    assert len(found.times) == len(found.rows) == case.count // case.every
    assert found.times[-1] == pytest.approx(case.count * case.step, abs=1e-7)
    assert found.calls == case.count * len(case.components)
    return found


@pytest.mark.parametrize(("tool", "method", "wiring"), FOREIGN)
def test_a_tool_steps_our_fmus(
    library: Path, native: Path, tool: str, method: str, wiring: str
) -> None:
    library = native if tool in COMPILED else library
    found = done(library, tool, method, wiring)
    if (tool, method) in SEQUENTIAL:
        like = done(library, "ours", "gauss-seidel", wiring).rows[-1]
        assert found.rows[-1] == pytest.approx(like, rel=2e-3)
        return
    case = case_of(SCENARIO, library, wiring, STEPS, CYCLES)
    like = Bare(case, again=False, zeros=tool in EXACT).run()
    assert found.rows[-1] == pytest.approx(like, rel=1e-10 if tool in EXACT else 2e-3)


@pytest.mark.parametrize("wiring", ["values", "ports"])
def test_our_jacobi_is_the_bare_loop_that_reads_again(library: Path, wiring: str) -> None:
    """It differs from the other parallel tools in that outputs hold at the new point."""
    case = case_of(SCENARIO, library, wiring, STEPS, CYCLES)
    own = done(library, "ours", "jacobi", wiring).rows[-1]
    assert own == pytest.approx(Bare(case, again=True).run(), rel=1e-10)
    assert own != pytest.approx(Bare(case, again=False).run(), rel=1e-4)


def test_one_ode_agrees_with_the_reference(library: Path) -> None:
    case = case_of(SCENARIO, library, "values", STEPS, CYCLES)
    tight = type(case)(**{**vars(case), "rtol": 1e-9})
    found = runs.run(tight, Setting("scipy", "DOP853", "one ODE", "tolerance", 1e-9), 60.0, 1)
    assert found.status == "done", found.reason
    exact = Reference(SCENARIO, library, CYCLES).at(found.times)
    assert np.abs(np.asarray(found.rows) - exact).max() < 1e-7 * np.abs(exact).max()


def test_values_are_a_part_of_the_ports(library: Path) -> None:
    values, ports = (
        case_of("flapping-full-wings", library, w, 20, 1.0) for w in ("values", "ports")
    )
    assert set(values.wires) < set(ports.wires)
    assert not any(w.input.endswith("_time") for w in values.wires)
    bonds = [(values.wires[a].output, values.wires[b].output) for a, b in values.bonds]
    assert bonds == [
        ("force.value", "motion.velocity"), ("load.torque", "motion.flap_rate")
    ]  # fmt: skip


def test_a_choice_is_built_into_the_fmu(library: Path) -> None:
    """Half of the tools cannot set an enumeration."""
    amplifier = case_of(SCENARIO, library, "values", 20, 1.0).components[0]
    assert Path(amplifier.path).stem == "amplifier_raised_sine"
    assert "waveform" not in {start.name for start in amplifier.starts}


def test_steps_that_miss_the_points_of_comparison(library: Path) -> None:
    with pytest.raises(ValueError, match="50 steps per cycle"):
        case_of(SCENARIO, library, "values", 50, 1.0)


def script(folder: Path, text: str) -> str:
    path = folder / "python"
    path.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
    path.chmod(0o755)
    return str(path)


def test_a_crash_is_a_result(library: Path, tmp_path: Path) -> None:
    case = case_of(SCENARIO, library, "values", 20, 1.0)
    crashes = script(tmp_path, "echo last words; kill -SEGV $$")
    found = runs.run(case, setting("ecos", "fixed step", "values"), 1.0, 1, crashes)
    assert found.status == "crashed"
    assert found.reason == f"{signal.SIGSEGV.name}: last words"


def test_a_run_over_its_budget_is_ended(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runs, "LOADING", 0.2)
    monkeypatch.setattr(runs, "LONG", 0.1)
    case = case_of(SCENARIO, library, "values", 20, 1.0)
    sleeps = script(tmp_path, "sleep 60")
    found = runs.run(case, setting("ecos", "fixed step", "values"), 0.1, 1, sleeps)
    assert found.status == "over budget"


def curve(*points: tuple[int, float, float]) -> list[MeasuredRun]:
    """Runs by calls, error and wall time."""
    return [
        MeasuredRun(
            setting("ecos", "fixed step", "values"), "done", wall=wall, calls=calls, error=error
        )
        for calls, error, wall in points
    ]


def test_time_to_an_error() -> None:
    between = cost(curve((100, 1e-2, 1.0), (10_000, 1e-4, 100.0)))
    assert between.sure
    assert between.seconds == pytest.approx(10.0)
    beyond = cost(curve((100, 0.4, 1.0), (200, 0.2, 2.0)))
    assert not beyond.sure
    assert beyond.seconds == pytest.approx(400.0)
    assert str(beyond) == "~ 400"
    assert ratio(beyond, between) == "~ 40"
    assert str(cost(curve((100, 0.3, 1.0), (200, 0.3, 2.0)))) == "not reached"
    assert cost(curve((100, 1e-5, 1.0))) == Cost(1.0, True)


def test_stroke_and_frequency_of_a_sine() -> None:
    times = np.arange(1, 101) / (20 * 18.0)
    span, beat = oscillation(list(times), 0.6 * np.sin(2 * math.pi * 18.0 * times), 1 / 18.0)
    assert span == pytest.approx(1.2, rel=1e-4)
    assert beat == pytest.approx(18.0, rel=1e-4)


@pytest.mark.slow
def test_the_command(library: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(
        scenario=SCENARIO, tools="ours,scipy,omsimulator", budget=20.0, cycles=2.0, steps="20,40",
        tolerances="1e-4", repeats=1, python=[f"omsimulator={script(tmp_path, 'exit 3')}"],
        library=library, output=tmp_path / "out",
    )  # fmt: skip
    said = capsys.readouterr().out
    assert "crashed: exit code 3" in said
    assert "times ours" in said
    with (tmp_path / "out" / f"{SCENARIO}.csv").open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert {line["tool"] for line in lines} == {"ours", "scipy", "omsimulator"}
    assert all(line["frequency_hz"] for line in lines if line["status"] == "done")
    assert (tmp_path / "out" / f"{SCENARIO}.svg").stat().st_size > 1000
