"""A recording as an FMU: what the scenario's `data = ...` gives, and refusals."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu
from typer.testing import CliRunner

import build_fmus
import fmus
from orchestrator.cli import app
from orchestrator.errors import InitialisationError, SimulationError
from orchestrator.fmi.description import read_interface
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.processes import python

runner = CliRunner()
HOME = Path(fmus.__file__).parent / "replay"
KINDS = ("held", "linear", "cubic", "band-limited")
WAYS = [
    *((kind, repeat, False) for kind in KINDS for repeat in ("false", "true", "0.05 s")),
    *(("held", "false", True), ("band-limited", "true", True)),
]
"""Interpolation, continuation, and whether compiled: the source is the same, so two are enough."""
ROWS = "time [ms],U (kV),mass flow [g/s],x[1],force.value [mN],force.rate [mN/s]\n"


def bench(folder: Path, head: str = ROWS, count: int = 41) -> Path:
    """Forty milliseconds of a sine, of a cosine, of a line and of a pulse."""
    path = folder / "bench.csv"
    t = np.arange(count) * 1e-3
    columns = (1e3 * t, np.sin(157.0 * t), np.cos(100.0 * t), t, 5.0 * t * t, 10.0 * t)
    lines = [",".join(repr(float(v)) for v in row) for row in zip(*columns, strict=True)]
    path.write_text(head + "\n".join(lines) + "\n")
    return path


def settings(**keys: str) -> dict[str, str]:
    named = {"columns.U (kV)": "top.voltage", "columns.mass flow": "flow", "columns.x[1]": "x[1]"}
    return {**named, "columns.force.value": "force.value", **keys}


def test_the_sample_is_what_the_sources_hold() -> None:
    recording = build_fmus.open_recorded(HOME / "sample.csv", "replay", {"repeat": "true"})
    for path, text in build_fmus.recorded_files(recording).items():
        assert (HOME.parent / path).read_bytes() == text, path


@pytest.mark.parametrize(("kind", "repeat", "native"), WAYS)
def test_the_fmu_gives_what_the_file_gives(
    tmp_path: Path, kind: str, repeat: str, native: bool
) -> None:
    """Every output, inside the record, beyond it and before it, at even and uneven steps."""
    path = bench(tmp_path)
    keys = {"interpolation": kind, "repeat": repeat, "offset": "3 ms"}
    if repeat == "false":
        keys |= {"before": "zero", "after": "hold"}
    if kind == "band-limited" and repeat == "0.05 s":
        keys["repeat"] = "0.041 s"
    recording = build_fmus.open_recorded(path, "bench", settings(**keys))
    built = build_fmus.build("replay", alias="bench", recording=recording, into=tmp_path,
                             native=native)  # fmt: skip
    data, fmu = tmp_path / "data.toml", tmp_path / "fmu.toml"
    head = "[time]\nstop = 0.13\nstep = 7e-4\n[components.bench]\n"
    written = "\n".join(f"{key} = {_toml(value)}" for key, value in keys.items())
    columns = ", ".join(f'"{k.removeprefix("columns.")}" = "{v}"' for k, v in settings().items())
    data.write_text(f'{head}data = "bench.csv"\n{written}\ncolumns = {{ {columns} }}\n')
    fmu.write_text(f'{head}fmu = "{built.path}"\n')
    one, other = run(load(data)), run(load(fmu))
    assert one.failure is None
    assert other.failure is None
    assert sorted(one.names) == sorted(other.names)
    scales = {"bench.top.voltage": 1.0, "bench.flow": 1e-3}
    for name in one.names:
        mine, theirs = other.series(name), one.series(name) * scales.get(name, 1.0)
        size = np.abs(theirs[np.abs(theirs) < 1e29]).max(initial=1e-30)
        assert np.abs(mine - theirs).max() <= 1e-10 * size, name


def _toml(value: str) -> str:
    return value if value in {"true", "false"} else f'"{value}"'


def test_outputs_are_in_si_with_units_and_laws(tmp_path: Path) -> None:
    recording = build_fmus.open_recorded(bench(tmp_path), "bench", settings())
    path = build_fmus.build("replay", alias="bench", recording=recording, into=tmp_path).path
    known = read_interface(path)
    units = {name: v.unit for name, v in known.variables.items() if v.causality == "output"}
    assert units == {
        "top.voltage": "V", "flow": "kg/s", "x[1]": "", "force.value": "N",
        "top.voltage_rate": "V/s", "top.square_curvature": "V2/s2", "top.voltage_time": "s",
        "force.rate": "N/s", "force.curvature": "N/s2", "force.reference_time": "s",
    }  # fmt: skip
    orders = {v.name: (v.port, v.order) for v in known.of("output")}
    assert orders["top.square_curvature"] == ("top", 2)
    assert known.ours
    assert known.variables["frequency"].start == 0.0


def test_fmpy_plays_it(tmp_path: Path) -> None:
    recording = build_fmus.open_recorded(bench(tmp_path), "bench", settings(interpolation="linear"))
    path = build_fmus.build("replay", alias="bench", recording=recording, into=tmp_path).path
    table = simulate_fmu(
        str(path), stop_time=0.04, step_size=1e-3, output_interval=1e-3,
        output=["top.voltage", "flow"], start_values={"offset": 0.0},
    )  # fmt: skip
    assert len(table) == 41
    assert table["top.voltage"] == pytest.approx(1e3 * np.sin(157.0 * table["time"]), abs=1e-8)
    assert table["flow"] == pytest.approx(1e-3 * np.cos(100.0 * table["time"]), abs=1e-12)


@pytest.mark.parametrize(
    ("keys", "start", "fault", "message"),
    [
        ({}, "0 s", SimulationError, "recording has ended"),
        ({"offset": "1 s", "before": "stop"}, "0 s", InitialisationError, "begins later"),
    ],
)
def test_where_the_record_ends_the_run_stops(
    tmp_path: Path, keys: dict[str, str], start: str, fault: type[Exception], message: str
) -> None:
    recording = build_fmus.open_recorded(bench(tmp_path), "bench", settings(**keys))
    path = build_fmus.build("replay", alias="bench", recording=recording, into=tmp_path).path
    scenario = tmp_path / "scenario.toml"
    scenario.write_text(
        f'[time]\nstart = "{start}"\nstop = 0.1\nstep = 1e-3\n[components.b]\nfmu = "{path}"\n'
    )

    def play() -> None:
        outcome = run(load(scenario))
        if outcome.failure is not None:
            assert outcome.times[-1] == pytest.approx(0.04)
            raise outcome.failure

    with pytest.raises(fault, match=message):
        play()


def test_a_replay_takes_the_place_of_a_part(library: Path, tmp_path: Path) -> None:
    """Wires into the amplifier, its holds and its records are dropped, as with a file."""
    scenario = tmp_path / "scenario.toml"
    scenario.write_text('extends = "oscillator-1"\n[components.amplifier]\nfmu = "replay"\n')
    plan = load(scenario, None, library, time={"stop": "20 cycles"})
    assert plan.frequency == 18.0
    assert any("spring.top -> amplifier.top" in line for line in plan.dropped)
    outcome = run(plan)
    assert outcome.failure is None
    assert np.abs(outcome.series("payload.displacement")).max() > 1e-3


ATTACKS = (
    '"); import os; os._exit(7); ("', "\\", "a\nb", "${x}", "'''", "{0}", "<b>&amp;</b>", "\u202e",
)  # fmt: skip


@pytest.mark.parametrize("heading", ATTACKS)
def test_a_heading_is_never_code(tmp_path: Path, heading: str) -> None:
    quoted = '"' + heading.replace('"', '""').replace("\n", " ") + '"'
    path = tmp_path / "bench.csv"
    path.write_text(f"time,{quoted}\n0,1\n1,2\n", encoding="utf-8")
    key = heading.replace("\n", " ")
    recording = build_fmus.open_recorded(path, "bench", {f"columns.{key}": "x"})
    built = build_fmus.build("replay", alias="bench", recording=recording, into=tmp_path)
    assert simulate_fmu(str(built.path), stop_time=1.0, step_size=0.5)["x"][-1] == 2.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--recording", "bench.csv"], "name it with --as"),
        (["membrane", "--recording", "bench.csv", "--as", "b"], "leave out membrane"),
        (["--recording", "nothing.csv", "--as", "b"], "no such recording"),
        (["--recording", ".", "--as", "b"], "no format known"),
        (["--recording", "bench.csv", "--as", "../b"], "cannot name an FMU"),
        (["--recording", "bench.csv", "--as", "b", "--set", "b.repeat=true"], "as --with key="),
        (["spring", "--with", "repeat=true"], "name that by --recording"),
        (["--recording", "bench.csv", "--as", "b", "--with", "repeat"], "write key=value"),
        (
            ["--recording", "bench.csv", "--as", "b", "--with", "repaet=true"],
            "repaet: unknown key",
        ),
        (["--recording", "bench.csv", "--as", "b", "--with", "interpolation=spline"], "'held'"),
        (["--recording", "bench.csv", "--as", "b", "--with", "columns.W=w"], "no column 'W'"),
        (["--recording", "bench.csv", "--as", "b", "--with", "columns.y=1y"], "not the name of a"),
        (["--recording", "bench.csv", "--as", "b", "--with", "start.x=1"], "means nothing"),
        (["--recording", "gap.csv", "--as", "b"], "line 3.*has no value"),
        (["--recording", "warm.csv", "--as", "b"], "degC needs an offset"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bench.csv").write_text("time,y\n0,1\n1,2\n")
    Path("gap.csv").write_text("time,y\n0,1\n1,\n2,3\n")
    Path("warm.csv").write_text("time,y [degC]\n0,1\n1,2\n")
    done = runner.invoke(app, ["build", *arguments, "--into", "made"])
    assert done.exit_code == 2
    assert not Path("made").exists() or not list(Path("made").iterdir())
    lines = done.stderr.strip().splitlines()
    assert all(line.startswith("build: ") for line in lines)
    assert re.search(message, lines[0]), lines[0]


def test_what_is_too_long_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "long.csv"
    t = np.arange(400_000)
    np.savetxt(path, np.column_stack([t, t]), "%d", ",", header="time,y", comments="")
    recording = build_fmus.open_recorded(path, "long", {})
    with pytest.raises(build_fmus.BuildError, match=r"numbers, more than.*data = "):
        build_fmus.build("replay", alias="long", recording=recording, into=tmp_path / "made")


def test_a_large_table_is_in_the_library_itself(tmp_path: Path) -> None:
    """40 000 rows: they are compiled in, and another process plays them."""
    path = tmp_path / "large.csv"
    t = np.arange(40_000) * 1e-3
    np.savetxt(path, np.column_stack([t, np.sin(t)]), delimiter=",", header="time,y", comments="")
    recording = build_fmus.open_recorded(path, "large", {})
    built = build_fmus.build("replay", alias="large", recording=recording, into=tmp_path,
                             native=True)  # fmt: skip
    script = (
        "import sys\nfrom fmpy import simulate_fmu\n"
        "t = simulate_fmu(sys.argv[1], start_time=30.0, stop_time=39.0, step_size=3.0,"
        " output_interval=3.0)\n"
        "print(*t['y'])"
    )
    done = subprocess.run(python("-c", script, built.path), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    values = [float(word) for word in done.stdout.split()]
    assert values == pytest.approx(np.sin([30.0, 33.0, 36.0, 39.0]).tolist(), abs=1e-6)


def test_building_after_a_run_still_packs_the_libraries(library: Path, tmp_path: Path) -> None:
    """A loaded FMU brings its own exporter, without libraries, into the process."""
    assert run(load("oscillator-1", None, library, time={"stop": "1 cycles"})).failure is None
    built = build_fmus.build("payload", into=tmp_path)
    assert simulate_fmu(str(built.path), stop_time=1e-3, step_size=1e-3) is not None
