"""Linearised scenarios: poles against closed forms, step maps against runs."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InputError
from orchestrator.scenario.plan import Plan
from orchestrator.simulation.linear.drive import driving
from orchestrator.simulation.linear.realisation import realise
from orchestrator.simulation.linear.state_space import linearise
from orchestrator.simulation.linear.step_map import MAPPED, limit, step_map
from orchestrator.simulation.load import load, unloaded
from orchestrator.simulation.run import run
from tests.evals.two_masses import scenarios
from tests.foreign.build import foreign

runner = CliRunner()
COMMAND = "amplifier.command.top"
SHOWN = ["payload.displacement", "amplifier.top.voltage"]


def still(library: Path, scenario: str = "oscillator-1", changes: dict[str, str] | None = None,
          **options: Any) -> Plan:  # fmt: skip
    """An oscillator at rest under 1 kV on its top cone."""
    quiet = {"amplifier.waveform": "external", **(changes or {})}
    time = {"stop": 1.0, **options.pop("time", {})}
    return load(scenario, quiet, library, hold={COMMAND: "1 kV"}, time=time, **options)


@pytest.mark.parametrize("number", range(1, 6))
def test_poles_of_the_oscillators(library: Path, number: int) -> None:
    """sqrt(K/M); damping of the loss factor and of the electrode, (2 a V)^2 R, at a bias V."""
    plan = still(library, f"oscillator-{number}")
    poles = linearise(plan, [COMMAND], SHOWN).eigenvalues()
    pole = next(p for p in poles if p.imag > 0.0)
    values: dict[str, Any] = {}
    for part in ("amplifier", "spring", "payload"):
        for name, variable in plan.interfaces[part].variables.items():
            values[f"{part}.{name}"] = plan.starts[part].get(name, variable.start)
    k, mass = values["spring.stiffness"], values["payload.mass"]
    loss = values["spring.loss_factor"] * k / (2 * math.pi * values["spring.loss_frequency"])
    slope = values["spring.blocked_force"] / values["spring.rated_voltage"] ** 2
    electrode = (2.0 * slope * 1000.0) ** 2 * values["amplifier.resistance"]
    damping = values["spring.damping"] + loss + electrode
    assert abs(pole) == pytest.approx(math.sqrt(k / mass), rel=5e-3)
    assert -pole.real / abs(pole) == pytest.approx(damping / (2 * math.sqrt(k * mass)), rel=5e-3)


def test_the_electrode_has_its_own_pole(library: Path) -> None:
    plan = still(library)
    poles = linearise(plan, [COMMAND], SHOWN).eigenvalues()
    known = plan.interfaces["spring"].variables
    capacitance = plan.starts["spring"].get("capacitance", known["capacitance"].start)
    assert isinstance(capacitance, float)
    rate = 1.0 / (1e5 * capacitance)
    assert min(abs(p.real + rate) for p in poles if p.imag == 0.0) < 0.05 * rate


def test_static_gain_and_names(library: Path) -> None:
    """dx/dV = 2 a V / K at rest; the same in python-control, under the same names."""
    found = linearise(still(library), [COMMAND], SHOWN)
    gain = 2.0 * 0.127 / 1920.0**2 * 1000.0 / 63.5
    assert found.response(np.array([1e-3]))[0, 0, 0].real == pytest.approx(gain, rel=1e-3)
    same = found.state_space()
    assert same.input_labels == ["amplifier_command_top"]
    assert sorted(same.output_labels) == ["amplifier_top_voltage", "payload_displacement"]
    assert same.dt == found.step
    row = same.output_labels.index("payload_displacement")
    assert np.real(same.dcgain()[row]) == pytest.approx(gain, rel=1e-3)


def test_realisation_of_a_known_system() -> None:
    a = np.array([[0.9, 0.2], [-0.2, 0.8]])
    b, c = np.array([[1.0], [0.5]]), np.array([[1.0, 0.0], [3e4, 1e4]])
    sequence = np.array([c @ np.linalg.matrix_power(a, k) @ b for k in range(40)])
    found, _, _ = realise(sequence)
    assert sorted(np.linalg.eigvals(found), key=np.imag) == pytest.approx(
        sorted(np.linalg.eigvals(a), key=np.imag), abs=1e-9
    )


@pytest.mark.parametrize("laws", ["held", "curvature"])
@pytest.mark.parametrize("step", [6e-4, 1.2e-3])
def test_the_map_grows_as_the_run_does(library: Path, laws: str, step: float) -> None:
    """Spectral radius against the envelope of a run that starts off its rest."""
    time = {"stop": 600 * step, "step": step}
    pushed = {"payload.start_velocity": "0.01"}
    done = run(
        still(library, changes=pushed, time=time, master={"kind": "gauss-seidel", "laws": laws})
    )
    speed = np.abs(done.series("payload.velocity"))
    n = len(speed)
    early, late = speed[n // 8 : n // 4].max(), speed[n // 4 : 3 * n // 8].max()
    growth = (late / early) ** (8.0 / n)
    plan = still(library, time={"step": 1e-4}, master={"kind": "gauss-seidel", "laws": laws})
    assert step_map(plan, step).radius("gauss-seidel") == pytest.approx(growth, abs=3e-3)


@pytest.mark.parametrize("kind", MAPPED)
def test_the_limit_of_two_masses(library: Path, tmp_path: Path, kind: str) -> None:
    """A damped pair: largest stable step by the map within 10 % of that by running."""
    path = scenarios(tmp_path) / "numbers.toml"
    changes = {f"{m}.damping": "0.2" for m in ("first", "second")}
    changes |= {f"{m}.start_displacement": "0" for m in ("first", "second")}
    options = {"hold": {}, "time": {"step": 0.01, "stop": 100.0}, "master": {"kind": kind}}
    predicted = limit(load(path, changes, library, **options), kind, 0.02, 1.5, within=0.01)

    def grows(step: float) -> bool:
        pushed = {**changes, "first.start_displacement": "1"}
        time = {"step": step, "stop": 600 * step}
        done = run(load(path, pushed, library, time=time, master={"kind": kind}))
        x = np.abs(done.series("first.displacement"))
        return done.failure is not None or x[-len(x) // 4 :].max() > x[: len(x) // 4].max()

    assert not grows(0.9 * predicted)
    assert grows(1.1 * predicted)


def bisected(grows: Callable[[float], bool], low: float, high: float) -> float:
    """Largest stable step by running, to half a per cent."""
    while high - low > 5e-3 * low:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if grows(middle) else (middle, high)
    return 0.5 * (low + high)


@pytest.mark.parametrize("kind", MAPPED)
def test_the_limit_of_an_oscillator(library: Path, kind: str) -> None:
    """Held forces on oscillator 1: the predicted limit within 1 % of the measured one."""
    settings = {"master": {"kind": kind, "laws": "held"}}
    plan = still(library, time={"step": 1e-4}, **settings)
    predicted = limit(plan, kind, 1e-4, 5e-3, within=3e-3)

    def grows(step: float) -> bool:
        pushed = {"payload.start_velocity": "0.01"}
        time = {"step": step, "stop": 400 * step}
        done = run(still(library, changes=pushed, time=time, **settings))
        speed = np.abs(done.series("payload.velocity"))
        rising = speed[-len(speed) // 4 :].max() > speed[: len(speed) // 4].max()
        return done.failure is not None or bool(rising)

    assert bisected(grows, 5e-4, 5e-3) == pytest.approx(predicted, rel=0.01)


SPLIT = """
[time]
stop = 10
step = 1e-2
[components.capacitor]
fmu = "./mass.fmu"
isolate = false
start = { mass = 0.5 }
[components.resistor]
fmu = "./pair.fmu"
isolate = false
start = { stiffness = 0.0, ground_stiffness = 0.0, damping = 10.0 }
[[wires]]
from = "capacitor.velocity"
to = "resistor.first.velocity"
[[wires]]
from = "resistor.first.value"
to = "capacitor.force"
[hold]
"resistor.first.displacement" = 0.0
"resistor.second.displacement" = 0.0
"resistor.second.velocity" = 0.0
"""
"""A capacitor (m dv/dt = F, with v for the voltage) and its electrode's resistor as two parts."""


@pytest.mark.parametrize("kind", MAPPED)
def test_the_limit_of_a_split_electrode(library: Path, tmp_path: Path, kind: str) -> None:
    """A current held over a step is stable below 2 R C = 0.1 s, by map and by running."""
    foreign("MASS", tmp_path)
    foreign("PAIR", tmp_path)
    scenario = tmp_path / "split.toml"
    scenario.write_text(SPLIT)
    predicted = limit(load(scenario, None, library), kind, 0.01, 0.5, within=3e-3)
    assert predicted == pytest.approx(0.1, rel=0.01)

    def grows(step: float) -> bool:
        pushed = {"capacitor.start_velocity": "1"}
        time = {"step": step, "stop": 200 * step}
        done = run(load(scenario, pushed, library, time=time, master={"kind": kind}))
        return done.failure is not None or abs(done.series("capacitor.velocity")[-1]) > 1.0

    assert bisected(grows, 0.01, 0.5) == pytest.approx(predicted, rel=0.01)


@pytest.mark.parametrize("laws", ["held", "curvature"])
@pytest.mark.parametrize(
    ("resistance", "capacitance"),
    [("1 kOhm", "1 nF"), pytest.param("10 MOhm", "10 nF", marks=pytest.mark.slow)],
)
def test_our_electrode_has_no_limit(
    library: Path, tmp_path: Path, laws: str, resistance: str, capacitance: str
) -> None:
    """Charge and capacitance cross together and one part owns the voltage: stable at any step.

    Time constants of 1 us and 0.1 s, steps from 10 us to 1 s.
    """
    scenario = tmp_path / "electrode.toml"
    scenario.write_text(
        'extends = "oscillator-1"\nwithout = ["payload"]\n'
        '[hold]\n"spring.motion.displacement" = 0.0\n'
    )
    changes = {"amplifier.resistance": resistance, "spring.capacitance": capacitance}
    changes |= {"amplifier.waveform": "external"}
    hold = {COMMAND: "1 kV"}
    plan = load(scenario, changes, library, hold=hold, master={"laws": laws}, time={"stop": 1.0})
    for step in (1e-5, 1e-3, 1.0):
        for kind in MAPPED:
            assert step_map(plan, step).radius(kind) <= 1.0 + 1e-6


@pytest.mark.parametrize("laws", ["held", "curvature"])
def test_instances_joined_in_python_control(library: Path, laws: str) -> None:
    """Its interconnection by the scenario's wires has the poles of our Jacobi map."""
    mapped = step_map(still(library, master={"laws": laws}))
    joined = mapped.interconnected()
    assert joined.dt == mapped.step
    ours = np.linalg.eigvals(mapped.matrix("jacobi"))
    for pole in joined.poles():
        if abs(pole) > 1e-3:
            assert np.abs(ours - pole).min() < 1e-6
    assert max(abs(joined.poles())) == pytest.approx(mapped.radius("jacobi"), rel=1e-9)
    payload = next(m for m in mapped.models if m.name == "payload").state_space(mapped.step)
    assert "payload_motion_displacement" in payload.output_labels
    assert "payload_force_value" in payload.input_labels


def test_an_unstable_wire_is_named(library: Path, tmp_path: Path) -> None:
    path = scenarios(tmp_path) / "numbers.toml"
    changes = {f"{m}.damping": "0.2" for m in ("first", "second")}
    changes |= {"first.start_displacement": "0", "pair.stiffness": "1000"}
    mapped = step_map(load(path, changes, library, time={"step": 1e-4}), 0.05)
    assert mapped.radius("jacobi") > 1.01
    assert "pair" in mapped.culprit("jacobi")


def test_what_cannot_be_linearised_is_refused(library: Path, tmp_path: Path) -> None:
    undamped = {"amplifier.amplitude": "0", "spring.loss_factor": "0"}
    with pytest.raises(InputError, match="does not come to rest"):
        linearise(load("oscillator-1", undamped | {"payload.start_velocity": "1 m/s"}, library))
    with pytest.raises(InputError, match="is not held; there is"):
        linearise(still(library), ["spring.top.voltage"])
    path = scenarios(tmp_path, rollback=False) / "numbers.toml"
    with pytest.raises(InputError, match="cannot roll back"):
        linearise(load(path, None, library))
    with pytest.raises(InputError, match="its step has no map"):
        step_map(still(library)).radius("iterative")


@pytest.mark.parametrize(
    ("scenario", "changes", "parameter"),
    [
        ("oscillator-1", {"amplifier.amplitude": "1 V"}, "amplifier.amplitude"),
        ("flapping-controlled", {}, "controller.largest_voltage"),
        ("oscillator-1", {"amplifier.amplitude": "0 V"}, ""),
        ("oscillator-1", {"amplifier.frequency": "0 Hz"}, ""),
        ("oscillator-1", {"amplifier.waveform": "constant"}, ""),
        ("flapping-controlled", {"controller.largest_voltage": "0 V"}, ""),
    ],
)
def test_a_drive_that_is_on_is_known_from_the_start_values(
    library: Path, scenario: str, changes: dict[str, str], parameter: str
) -> None:
    time = {"frequency": "50 Hz"}
    assert driving(unloaded(scenario, changes, library, time=time)) == parameter


@pytest.mark.slow
def test_the_commands(library: Path, tmp_path: Path) -> None:
    options = ["--fmus", str(library), "--set", "amplifier.waveform=external"]
    held = ["--hold", "amplifier.command.top=1 kV", "--output", str(tmp_path / "b.svg")]
    named = ["--input", COMMAND, "--variable", "payload.displacement"]
    done = runner.invoke(app, ["linearise", "oscillator-1", *options, *held, *named])
    assert done.exit_code == 0, done.output
    assert "51.6" in done.output
    assert "stable" in done.output
    assert "magnitude (m/V)" in (tmp_path / "b.svg").read_text()
    swept = tmp_path / "s.nc"
    over = ["--over", "amplifier.frequency=40:60:10Hz", "--workers", "1", "--stop", "8 cycles"]
    many = ["sweep", "oscillator-1", "--fmus", str(library), *over, "--output", str(swept)]
    assert runner.invoke(app, many).exit_code == 0
    beside = ["--beside", str(swept), "--drive", "0.96 kV"]
    again = runner.invoke(app, ["linearise", "oscillator-1", *options, *held, *named, *beside])
    assert again.exit_code == 0, again.output
    assert "s.nc" in (tmp_path / "b.svg").read_text()
    wrong = [*held, *named, "--beside", str(swept), "--drive", "1 N"]
    refused = runner.invoke(app, ["linearise", "oscillator-1", *options, *wrong])
    assert refused.exit_code == 2
    assert "--drive" in refused.output
    shown = runner.invoke(app, ["inspect", "oscillator-1", *options, "--stability"])
    assert "is stable: spectral radius" in shown.output


@pytest.mark.parametrize("every", [2, 7, 20])
def test_the_interval_changes_no_pole(library: Path, every: int) -> None:
    """exp(s h): what is seen at every n-th step has the same poles, the slow ones at least."""
    plan = still(library)
    wanted = linearise(plan, [COMMAND], SHOWN[:1]).eigenvalues()[0]
    found = linearise(plan, [COMMAND], SHOWN[:1], count=60, interval=every * plan.grid.step)
    assert found.step == pytest.approx(every * plan.grid.step)
    assert abs(found.eigenvalues()[0]) == pytest.approx(abs(wanted), rel=1e-3)


def test_an_interval_is_whole_steps(library: Path) -> None:
    plan = still(library)
    with pytest.raises(InputError, match=r"is 2\.5 communication steps"):
        linearise(plan, [COMMAND], SHOWN[:1], interval=2.5 * plan.grid.step)


@pytest.mark.slow
def test_a_driven_system_seen_once_a_cycle(native: Path, tmp_path: Path) -> None:
    """Stroke and lag of the vehicle: the first forgets two thirds of a change in a cycle."""
    done = runner.invoke(
        app,
        [
            "linearise", "flapping-controlled", "--json", "--interval", "1 cycle",
            "--step", "200 per cycle", "--fmus", str(native),
            "--input", "controller.excitation.drive", "--variable", "controller.stroke",
            *(text for name in ("lag_integral_gain", "stroke_gain", "stroke_integral_gain")
              for text in ("--set", f"controller.{name}=0")),
            "--set", "controller.start_frequency=18 Hz", "--set", "controller.start_phase=1",
            "--set", "controller.start_drive=0.95",
        ],
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    poles = json.loads(done.output)["poles"]
    slowest = max(real for real, _ in poles)
    assert math.exp(slowest / 18.0) == pytest.approx(0.36, abs=0.03)
