"""Recordings in the place of parts: laws, masters, what is dropped, what stops a run."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from recordings import CASES, difference, replayed
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import InitialisationError, InputError, InstanceFailure, ScenarioError
from orchestrator.recording.instance import RecordingInstance
from orchestrator.recording.recording import open_recording
from orchestrator.results.outcome import Outcome
from orchestrator.results.port_recording import with_recorded_ports, write_port_recording
from orchestrator.results.summary import warnings
from orchestrator.scenario.inspection import facts
from orchestrator.scenario.parse import load_scenario
from orchestrator.scenario.schema import Component
from orchestrator.simulation.load import load
from orchestrator.simulation.masters import MASTERS
from orchestrator.simulation.run import run
from orchestrator.simulation.system import System
from tests.conftest import Runner
from tests.foreign.scenarios import Shelf, level_control
from tests.processes import python

runner = CliRunner()
HEAD = "time [s],force.value [N]\n"
PUSH = """
[time]
stop = 0.1
step = 1e-3
frequency = "10 Hz"
[components.bench]
data = "bench.csv"
KEYS
[components.payload]
fmu = "payload"
start = { mass = 1.0 }
[[wires]]
from = "bench.force"
to = "payload.force"
"""


def sampled(function: object, stop: float = 0.1, count: int = 101) -> str:
    times = np.linspace(0.0, stop, count)
    values = function(times)  # type: ignore[operator]
    return "".join(f"{t!r},{y!r}\n" for t, y in zip(times.tolist(), values.tolist(), strict=True))


def scenario(folder: Path, rows: str, keys: str = "", text: str = PUSH) -> Path:
    (folder / "bench.csv").write_text(rows)
    path = folder / "scenario.toml"
    path.write_text(text.replace("KEYS", keys))
    return path


def sine(t: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(20.0 * np.pi * t))


@pytest.mark.parametrize("kind", sorted(MASTERS))
def test_a_force_moves_a_mass_by_every_master(library: Path, tmp_path: Path, kind: str) -> None:
    """x = t/w - sin(w t)/w^2 under sin(w t) on 1 kg; laws come from the interpolant."""
    path = scenario(tmp_path, HEAD + sampled(sine))
    done = run(load(path, None, library, master={"kind": kind}))
    assert done.failure is None
    w, t = 20.0 * np.pi, done.times
    error = np.abs(done.series("payload.displacement") - (t / w - np.sin(w * t) / w**2))
    assert error.max() < 3e-4 * (t[-1] / w)


def test_steps_of_any_size(library: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path, HEAD + sampled(sine))
    done = run(load(path, None, library, time={"tolerance": 1e-4}))
    assert done.failure is None
    assert done.series("payload.displacement")[-1] == pytest.approx(0.1 / (20 * np.pi), rel=1e-3)


@pytest.mark.parametrize("kind", ["held", "linear", "cubic", "band-limited"])
def test_the_curvature_carries_the_whole_impulse(library: Path, tmp_path: Path, kind: str) -> None:
    """At a tenth of the record's rate the mass still receives the integral of what is between."""
    path = scenario(tmp_path, HEAD + sampled(sine), f'interpolation = "{kind}"')
    fine = run(load(path, None, library, time={"step": 1e-4}))
    coarse = run(load(path, None, library, time={"step": 1e-2}))
    at = [np.argmin(np.abs(fine.times - t)) for t in coarse.times]
    one, two = fine.series("payload.velocity")[at], coarse.series("payload.velocity")
    np.testing.assert_allclose(two, one, atol=1e-4 * np.abs(one).max())


LAWS = {
    "voltage": {"top.voltage_rate": 1, "top.square_curvature": 2, "top.voltage_time": 1},
    "value": {"top.rate": 1, "top.curvature": 2, "top.reference_time": 1},
    "displacement": {"top.velocity": 0, "top.reference_time": 1},
    "flap_angle": {"top.flap_rate": 0, "top.reference_time": 1},
    "torque": {},
}


@pytest.mark.parametrize("member", LAWS)
def test_members_of_a_law_are_derived(tmp_path: Path, member: str) -> None:
    path = tmp_path / "bench.csv"
    path.write_text(f"time,top.{member}\n0,0\n1,2\n2,8\n")
    found = open_recording(Component(data="bench.csv"), tmp_path / "scenario.toml")
    derived = {v.name: v.order for v in found.interface.variables.values()}
    assert derived == {f"top.{member}": 0, **LAWS[member]}


def test_the_square_of_a_voltage_has_its_mean_over_the_step(tmp_path: Path) -> None:
    (tmp_path / "b.csv").write_text("time,top.voltage [kV]\n0,0\n1,2\n2,3\n")
    found = open_recording(Component(data="b.csv", interpolation="linear"), tmp_path / "s.toml")
    value, rate, curvature, time = found.outputs(1.5, 1.0)
    assert (value, rate, time) == (2500.0, 1000.0, 1.5)
    mean = value**2 - value * rate + curvature / 3.0
    exact = (8e9 - 1e9) / 3.0 / 2000.0 + (2500.0**3 - 8e9) / 3.0 / 1000.0
    assert mean == pytest.approx(exact)


def test_recorded_members_are_kept_and_clocks_are_now(tmp_path: Path) -> None:
    rows = "time,f.value [N],f.stiffness [N/m],f.rate [N/s],f.reference_time [s]\n"
    (tmp_path / "b.csv").write_text(rows + "0,1,2,3,77\n1,1,2,5,78\n")
    found = open_recording(Component(data="b.csv", offset="10 s"), tmp_path / "s.toml")
    named = dict(zip(found.interface.variables, found.outputs(10.5, 0.1), strict=True))
    assert named == {
        "f.value": 1.0, "f.stiffness": 2.0, "f.rate": pytest.approx(4.0), "f.reference_time": 10.5,
    }  # fmt: skip
    assert (found.begin, found.end) == (10.0, 11.0)


def test_announced_events_return_with_offset_and_repetition(tmp_path: Path) -> None:
    rows = "time,y,next_event_time [s]\n0,0,0.25\n0.25,1,0.75\n0.75,0,1e30\n1,0,1e30\n"
    (tmp_path / "b.csv").write_text(rows)
    found = open_recording(Component(data="b.csv", repeat=True, offset=5.0), tmp_path / "s.toml")
    assert [found.outputs(5.0 + t, 0.0)[-1] for t in (0.0, 0.25, 0.8, 2.3)] == [
        5.25, 5.75, 6.25, 7.75,
    ]  # fmt: skip


def test_where_the_record_ends_the_run_stops_with_the_reason(library: Path, tmp_path: Path) -> None:
    rows = HEAD + sampled(sine, stop=0.05)
    done = run(load(scenario(tmp_path, rows), None, library))
    assert isinstance(done.failure, InstanceFailure)
    assert "bench.csv ends at t = 0.05 s; after" in str(done.failure)
    assert done.times[-1] == pytest.approx(0.05)
    for keys in ('after = "hold"', 'after = "zero"', "repeat = true", 'repeat = "0.06 s"'):
        assert run(load(scenario(tmp_path, rows, keys), None, library)).failure is None


def test_before_the_record_the_run_does_not_start(library: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path, HEAD + sampled(sine, 0.2), 'offset = "20 ms"\nbefore = "stop"')
    with pytest.raises(InitialisationError, match=r"begins only at t = 0\.02 s; before ="):
        run(load(path, None, library))
    path = scenario(tmp_path, HEAD + "0,1\n0.2,1\n", 'offset = "20.3 ms"\nbefore = "zero"')
    done = run(load(path, None, library))
    velocity = done.series("payload.velocity")[-1]
    assert velocity == pytest.approx(0.1 - 0.0203, rel=1e-12), "the step is cut where it begins"


EPOCH = "".join(f"{1.7e9 + 1e-3 * k!r},{k % 7}\n" for k in range(101))


def test_a_record_beside_the_run_is_refused_with_the_remedy(library: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path, "time,force.value\n" + EPOCH)
    with pytest.raises(ScenarioError, match=r'none of 101 in the run .* offset = "first"'):
        load(path, None, library)
    path = scenario(tmp_path, "time,force.value\n" + EPOCH, 'offset = "first"')
    assert load(path, None, library).recordings["bench"].begin == 0.0
    path = scenario(tmp_path, "time,force.value\n" + EPOCH, 'before = "hold"')
    assert run(load(path, None, library)).failure is None


def test_a_run_that_meets_one_row_is_noted(library: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path, "time,force.value\n0,0\n50,1\n100,2\n", 'interpolation = "linear"')
    found = [str(w) for w in warnings(run(load(path, None, library)))]
    assert any("1 of 3 in the run" in text and "ms" in text for text in found), found


def test_texts_in_a_scenario(library: Path, tmp_path: Path) -> None:
    """The keys of a layout, a gain with a sign and a shift, as a port receives them."""
    keys = (
        'skip = 1\nnames = ["time [ms]", "load cell [mN]"]\ndecimal = ","\noffset = "first"\n'
        'columns = { "load cell" = "force.value" }\ngains = { "load cell" = -2 }\n'
        "shifts = { 2 = 500 }"
    )
    text = "exported by a logger;1\n1000;0\n1050;-250,0\n1100;-500,0\n"
    recording = load(scenario(tmp_path, text, keys), None, library).recordings["bench"]
    assert recording.outputs(0.1, 0.0)[0] == pytest.approx(1.5)
    assert recording.begin == 0.0


def test_a_saved_state_is_restored(tmp_path: Path) -> None:
    (tmp_path / "b.csv").write_text(HEAD + "0,0\n1,1\n")
    found = open_recording(Component(data="b.csv"), tmp_path / "s.toml")
    instance, values = RecordingInstance("bench", found), np.zeros(1)
    instance.connect([], np.zeros(0), [[found.interface.variables["force.value"]]], values)
    instance.prepare({}, 0.0, 1.0, None)
    instance.step(0.0, 0.25)
    state = instance.save()
    instance.step(0.25, 0.5)
    instance.receive()
    assert values[0] == pytest.approx(0.75)
    instance.restore(state)
    instance.receive()
    assert values[0] == pytest.approx(0.25)
    assert (instance.steps, instance.rollbacks) == (2, 1)
    with pytest.raises(InstanceFailure, match="no parameter 'gain'"):
        instance.set({"gain": 1.0})
    instance.forget(state)
    instance.close()


@pytest.fixture(scope="module")
def port_recordings(library: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four cycles of every part of two scenarios: SCENARIO-PART.csv and .nc."""
    folder = tmp_path_factory.mktemp("port-recordings")
    for name, parts in CASES.items():
        for part in parts:
            done = run(
                with_recorded_ports(load(name, None, library, time={"stop": "4 cycles"}), part)
            )
            write_port_recording(done, folder / f"{name}-{part}.csv")
            write_port_recording(done, folder / f"{name}-{part}.nc")
    return folder


@pytest.fixture(scope="module")
def originals(outcome: Runner) -> dict[str, Outcome]:
    return {name: outcome(name, time={"stop": "4 cycles"}) for name in CASES}


WHOLE = {"payload": 1e-3, "aero": 3e-4, "spring": 1e-6, "actuator": 3e-4}
"""Parts whose recording differs by its place in the order, or by outputs read after the step.

The film of the flagship: 1.1e-4 over four cycles, as measured.
"""
BARE = {"amplifier": 5e-2, "payload": 5e-2, "aero": 5e-2, "linkage": 1e-2}


@pytest.mark.parametrize(("name", "part"), [(n, p) for n, parts in CASES.items() for p in parts])
@pytest.mark.parametrize("form", ["csv", "nc"])
def test_a_recording_replaces_its_part(
    library: Path, tmp_path: Path, port_recordings: Path, originals: dict[str, Outcome],
    name: str, part: str, form: str,
) -> None:  # fmt: skip
    """Whole ports at the same points: the rest repeats. Bare values: to interpolation."""
    columns, compared, holds = CASES[name][part]
    file = port_recordings / f"{name}-{part}.{form}"
    time = {"stop": "4 cycles"}
    kind = "linear" if form == "csv" else "cubic"
    done = replayed(tmp_path, name, part, file, kind, [], "", library, time=time)
    assert difference(originals[name], done, compared) < WHOLE.get(part, 1e-12)
    if part in BARE:
        done = replayed(tmp_path, name, part, file, kind, columns, holds, library, time=time)
        assert difference(originals[name], done, compared) < BARE[part]


def test_what_a_recording_cannot_take_is_dropped(
    library: Path, tmp_path: Path, port_recordings: Path
) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text(
        f'extends = "oscillator-1"\n[components.amplifier]\n'
        f'data = "{port_recordings / "oscillator-1-amplifier.csv"}"\n'
        '[[actions]]\nat = "1 cycle"\nset = { "amplifier.amplitude" = "1 kV" }\n'
    )
    plan = load(path, None, library)
    dropped = "\n".join(plan.dropped)
    assert "wire spring.top -> amplifier.top: a recording has no inputs" in dropped
    assert "hold amplifier.command.top: a recording has no inputs" in dropped
    assert "record amplifier.supplied_energy: not in the recording" in dropped
    assert "action on amplifier.amplitude at 1 cycle" in dropped
    assert plan.frequency == 51.8
    assert facts(plan)["dropped"] == plan.dropped
    assert "amplifier.top.voltage" in [f"{c}.{v.name}" for c, v in plan.records]
    shown = runner.invoke(app, ["inspect", str(path), "--fmus", str(library)])
    assert "dropped" in shown.output


def test_a_column_of_another_name_is_told_how_it_is_named(library: Path, tmp_path: Path) -> None:
    (tmp_path / "bench.csv").write_text("time,Voltage [V],Force [N]\n0,0,0\n1,1,1\n")
    head = '[time]\nstop = 1\nstep = 0.1\n[components.source]\ndata = "bench.csv"\n'
    wire = '[[wires]]\nfrom = "source.top.voltage"\nto = "spring.top.voltage"\n'
    rest = '[components.spring]\nfmu = "spring"\n' + wire
    rest += '[hold]\n"spring.bottom.voltage" = 0\n"spring.motion.displacement" = 0\n'
    (tmp_path / "bench.toml").write_text(head + rest)
    remedy = 'columns = { Voltage = "top.voltage" }'
    with pytest.raises(ScenarioError) as caught:
        load(tmp_path / "bench.toml", None, library)
    assert f"say which column it is, as {remedy}" in str(caught.value)
    (tmp_path / "bench.toml").write_text(f"{head}{remedy}\n{rest}")
    load(tmp_path / "bench.toml", None, library)


def test_a_port_that_was_not_recorded_is_reported_or_held(library: Path, tmp_path: Path) -> None:
    (tmp_path / "bench.csv").write_text("time,force.valeu [N]\n0,0\n1,1\n")
    path = tmp_path / "scenario.toml"
    text = 'extends = "oscillator-1"\n[time]\nstop = 0.1\n[components.spring]\ndata = "bench.csv"\n'
    path.write_text(text)
    with pytest.raises(ScenarioError) as caught:
        load(path, None, library)
    assert "has no column force.value; did you mean 'force.valeu'?" in str(caught.value)
    assert 'hold "amplifier.top.charge"' in str(caught.value)
    assert 'columns = { "force.valeu" = "force.value" }' in str(caught.value)
    path.write_text(
        text + 'columns = { "force.valeu" = "force.value" }\n'
        '[hold]\n"amplifier.top.charge" = 0\n"amplifier.bottom.charge" = 0\n'
    )
    assert "wire spring.top -> amplifier.top: not in the recording; held instead" in "".join(
        load(path, None, library).dropped
    )


@pytest.mark.parametrize(
    ("rows", "keys", "words"),
    [
        ("time,force.value [V]\n0,0\n1,1\n", "", ["V is not convertible to N"]),
        ("time,a.voltage [N]\n0,0\n1,1\n", "", ["'a.voltage [N]'", "N is not convertible to V"]),
        ("time,force.value\n0,0\n1,x\n", "", ["components.bench.data", "line 3", "'x'"]),
        ("time,force.value\n0,0\n1,1\n", "offset = '1 m'", ["offset", "quantity in s"]),
        ("time,force.value\n0,0\n1,1\n", "repeat = '0.1 s'", ["shorter than the record, 1 s"]),
        ("time,force.value\n0,0\n1,1\n", "repeat = '-1 s'", ["above zero"]),
        ("time,force.value\n0,0\n1,1\n", "memory = '8 byte'", ["more than 8"]),
        (HEAD + "0,0\n1,1\n3,1\n", "interpolation = 'band-limited'", ["band-limited needs"]),
        ("time,f.reference_time\n0,0\n1,1\n", "", ["times alone"]),
        (HEAD, "fmu = 'payload'", ["data: an fmu is named too"]),
        (HEAD, "start = { mass = 1 }", ["start: means nothing to a recording"]),
        (HEAD, "repeat = true\nafter = 'zero'", ["after: means nothing beside repeat"]),
        (HEAD, "interplation = 'held'", ["did you mean 'interpolation'"]),
        (HEAD, "interpolation = 'spline'", ["components.bench.interpolation", "'spline'"]),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_reported(
    library: Path, tmp_path: Path, rows: str, keys: str, words: list[str]
) -> None:
    with pytest.raises(ScenarioError) as caught:
        load(scenario(tmp_path, rows, keys), None, library)
    for word in words:
        assert word in str(caught.value)


def test_keys_of_a_recording_mean_nothing_to_an_fmu(tmp_path: Path) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text('[components.a]\nfmu = "payload"\noffset = 1.0\n')
    with pytest.raises(ScenarioError, match="offset: means nothing without data"):
        load_scenario(path)


def test_a_recording_stays_beside_the_scenario_that_names_it(library: Path, tmp_path: Path) -> None:
    base = scenario(tmp_path, HEAD + sampled(sine))
    (tmp_path / "deep").mkdir()
    top = tmp_path / "deep" / "top.toml"
    top.write_text(f'extends = "../{base.name}"\n[components.bench]\ninterpolation = "linear"\n')
    assert run(load(top, None, library)).failure is None


def test_faults_act_on_a_recording_too(library: Path, tmp_path: Path) -> None:
    fault = '[[faults]]\nat = 0.0\non = "bench.force.value"\nkind = "bias"\nsize = "1 N"\n'
    path = scenario(tmp_path, HEAD + "0,0\n0.2,0\n")
    path.write_text(path.read_text() + fault)
    done = run(load(path, None, library))
    assert done.series("payload.velocity")[-1] == pytest.approx(0.1, rel=0.02)


def test_a_system_with_a_recording_saves_and_restores(library: Path, tmp_path: Path) -> None:
    with System(load(scenario(tmp_path, HEAD + sampled(sine)), None, library)) as system:
        moment = system.save()
        system.restore(moment)
        system.forget(moment)


def test_record_and_run_from_the_command_line(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "amp.csv"
    options = ["--fmus", str(library), "--stop", "2 cycles"]
    done = runner.invoke(
        app, ["record", "oscillator-1", "--part", "amplifier", "--output", str(target), *options]
    )
    assert done.exit_code == 0, done.output
    assert "121 rows of 9 variables" in done.output
    assert target.read_text().startswith("# title: DEA-mass oscillator 1")
    bad = runner.invoke(app, ["record", "oscillator-1", "--part", "amplifer", *options])
    assert bad.exit_code == 2
    assert "did you mean 'amplifier'?" in bad.output
    bad = runner.invoke(
        app, ["record", "oscillator-1", "--part", "spring", "--output", "x.mat", *options]
    )
    assert bad.exit_code == 2


def test_a_run_that_stopped_leaves_a_partial_recording(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "p.csv"
    done = runner.invoke(
        app,
        ["record", "oscillator-1", "--part", "payload", "--output", str(target),
         "--fmus", str(library), "--set", "payload.start_velocity=9000"],
    )  # fmt: skip
    assert done.exit_code == 1
    assert [p.name for p in tmp_path.iterdir()] == ["p.partial.csv"]


def test_texts_are_named_that_a_recording_leaves_out(shelf: Shelf, tmp_path: Path) -> None:
    path = level_control(tmp_path, shelf, '[record]\nvariables = ["relay.open", "relay.state"]')
    target = tmp_path / "relay.csv"
    command = ["record", str(path), "--part", "relay", "--stop", "0.1 s"]
    done = CliRunner().invoke(app, [*command, "--output", str(target)])
    assert done.exit_code == 0, done.output
    assert done.output.splitlines() == [
        f"11 rows of 1 variables: {target}",
        "left out, as a recording holds numbers only: relay.state",
    ]
    assert target.read_text().splitlines()[-12] == "time [s],open"


def test_a_part_without_numbers_has_nothing_to_record(library: Path) -> None:
    with pytest.raises(InputError, match="no such component"):
        with_recorded_ports(load("oscillator-1", None, library), "wing")


def test_nothing_of_recordings_is_loaded_without_one(library: Path) -> None:
    code = (
        "import sys, json; from pathlib import Path\n"
        "from orchestrator import load, run\n"
        f"run(load('oscillator-1', None, Path({str(library)!r}), time={{'stop': '1 cycles'}}))\n"
        "found = [m for m in sys.modules if m.startswith('orchestrator.recording.')]\n"
        "print(json.dumps([m for m in found if not m.endswith('.settings')]))"
    )
    done = subprocess.run(python("-c", code), capture_output=True, text=True, check=True)
    assert json.loads(done.stdout.splitlines()[-1]) == []
