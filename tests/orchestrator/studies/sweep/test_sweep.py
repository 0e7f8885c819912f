"""Sweeps: axes, points that are sick, sweeps that are stopped or killed, peaks."""

from __future__ import annotations

import json
import logging
import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
import xarray
from distributed import LocalCluster

from orchestrator.errors import InputError, OutputError, ScenarioError, SimulationError
from orchestrator.results.metrics import metrics
from orchestrator.results.netcdf import dataset, partial_path
from orchestrator.simulation.interrupt import Interrupt, Interrupted
from orchestrator.studies.sweep.axes import MOST_POINTS, check_axes
from orchestrator.studies.sweep.checkpoint import Folder
from orchestrator.studies.sweep.peak import FINEST, Peak, middles, peak_of, spacing
from orchestrator.studies.sweep.points import Record, Setting, calculate, planned
from orchestrator.studies.sweep.study import Axis, parse_axis, sweep
from orchestrator.studies.workers.dask_cluster import PRELOADED
from orchestrator.studies.workers.pool import WorkerPool
from tests.conftest import Runner
from tests.foreign.build import foreign

SCENARIO = "flapping-full-wings"
SHORT = {"time": {"stop": "2 cycles"}}
STROKE = "flapping stroke"
SICK = f"""
extends = "{SCENARIO}"
[master]
order = ["amplifier", "actuator", "aero", "linkage", "sick"]
[components.sick]
fmu = "faulty.fmu"
isolate = false
start = {{ fault_time = "20 ms" }}
[hold]
"sick.u" = 1
[record]
variables = ["sick.y"]
"""
CRASH, HANG, NAN, ERROR = "1", "2", "3", "9"
HEALTHY = ("0", "11", "12", "17")
"""Faults that FMI 2 does not know."""


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """Two workers for all tests that need no cluster of their own."""
    made: Any = LocalCluster
    with made(
        n_workers=2,
        threads_per_worker=1,
        host="127.0.0.1",
        scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
        silence_logs=logging.CRITICAL,
        preload=PRELOADED,
    ) as running:
        yield running


Sweep = Callable[..., xarray.Dataset]


@pytest.fixture
def swept(cluster: Any, library: Path) -> Sweep:
    """`sweep` on the shared workers, over axes given as texts."""

    def run(
        *axes: str, scenario: str | Path = SCENARIO, target: Path, **more: Any
    ) -> xarray.Dataset:
        more = {"options": SHORT, "scheduler": cluster.scheduler_address} | more
        return sweep(scenario, [parse_axis(axis) for axis in axes], library, target, **more)

    return run


@pytest.fixture
def sick(tmp_path: Path) -> Path:
    """The flapping scenario beside a unit that fails on demand, in the worker's own process."""
    foreign("FAULTY", tmp_path)
    path = tmp_path / "sick.toml"
    path.write_text(SICK)
    return path


def files(target: Path) -> dict[str, int]:
    """Finished points on disk, with the time at which each was written."""
    folder = Folder(target).path
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("*.json")}


def when(condition: Callable[[], object], act: Callable[[], object]) -> threading.Thread:
    """Do something once a condition holds, beside the test."""

    def watch() -> None:
        until = time.monotonic() + 60.0
        while not condition() and time.monotonic() < until:
            time.sleep(0.01)
        act()

    thread = threading.Thread(target=watch)
    thread.start()
    return thread


# --------------------------------------------------------------------------------------- axes


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("amplifier.frequency=1:10:4Hz", ("1 Hz", "5 Hz", "9 Hz")),
        ("amplifier.frequency=1:9:4 Hz", ("1 Hz", "5 Hz", "9 Hz")),
        ("amplifier.frequency = 1Hz:9Hz:4Hz", ("1 Hz", "5 Hz", "9 Hz")),
        ("amplifier.frequency=1:50/3Hz", ("1 Hz", "25.5 Hz", "50 Hz")),
        ("amplifier.frequency=-1 Hz : 1 Hz / 3 Hz", ("-1 Hz", "0 Hz", "1 Hz")),
        ("a.b=0:0.4:0.1", ("0", "0.1", "0.2", "0.3", "0.4")),
        ("a.b=1e-3:3e-3:1e-3 m/s", ("0.001 m/s", "0.002 m/s", "0.003 m/s")),
        ("a.b=5:5:1", ("5",)),
        ("spring.layers=2,4,6,8", ("2", "4", "6", "8")),
        ("spring.length=20,25,30 mm", ("20 mm", "25 mm", "30 mm")),
        ("spring.length=20mm", ("20 mm",)),
        ("amplifier.waveform=square, sine", ("square", "sine")),
        ("a.b.c=2D,3D,flat", ("2D", "3D", "flat")),
    ],
)
def test_an_axis_is_read(text: str, values: tuple[str, ...]) -> None:
    axis = parse_axis(text)
    assert axis.values == values
    assert axis.name == text.partition("=")[0].strip()


def test_figure_11_has_its_26_points() -> None:
    values = parse_axis("amplifier.frequency=1:50/26Hz").values
    assert len(values) == 26
    assert values[:2] == ("1 Hz", "2.96 Hz")
    assert values[-1] == "50 Hz"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "component.parameter=values"),
        ("amplifier=1:2:1", "component.parameter=values"),
        ("=1:2:1", "component.parameter=values"),
        ("a.b", "component.parameter=values"),
        ("a.b=", "empty value"),
        ("a.b=1,,2", "empty value"),
        ("a.b=1:2", "is no range"),
        ("a.b=1:2:3:4", "is no range"),
        ("a.b=1:x:2", "is no range"),
        ("a.b=1:50/2.5Hz", "is no range"),
        ("a.b=1:50:26#Hz", "is no range"),
        ("a.b=1:2:0Hz", "above zero"),
        ("a.b=1:2:-1Hz", "above zero"),
        ("a.b=2:1:1", "backwards"),
        ("a.b=2:1/3", "backwards"),
        ("a.b=1:1/3", "room for one point"),
        ("a.b=1:2/1", "at least 2"),
        ("a.b=1:2/0", "at least 2"),
        ("a.b=0:1:1e-9", "more than 100000"),
        ("a.b=0:1/100001", "more than 100000"),
        ("a.b=0:1/" + "9" * 5000, "more than 100000"),
        ("a.b=0:1e999:1", "not a finite number"),
        ("a.b=0:1e300:1e-300", "more than 100000"),
        ("a.b=1Hz:1kHz:1Hz", "mixes units"),
        ("a.b=1Hz:2:3", "mixes units"),
        ("a.b=1:2Hz:3Hz", "some numbers only"),
        ("a.b=1mm,2m", "mixes units"),
        ("a.b=1mm,2", "mixes units"),
        ("a.b=1,square", "mixes numbers and texts"),
        ("a.b=1,2,1.0", "twice"),
        ("a.b=sine,sine", "twice"),
    ],
)
def test_a_bad_axis_is_refused_with_the_way_out(text: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        parse_axis(text)


def test_axes_that_make_no_sweep_are_refused() -> None:
    many = Axis("a.b", tuple(str(k) for k in range(1000)))
    for axes, changes, told in [
        ([], {}, "at least one axis"),
        ([many, many], {}, "a.b: stands twice"),
        ([many], {"a.b": "3"}, "set to '3' as well"),
        ([many, Axis("a.c", many.values)], {}, f"1000 x 1000 = 1000000.*{MOST_POINTS}"),
    ]:
        with pytest.raises(InputError, match=told):
            check_axes(axes, changes)


def test_all_points_are_checked_before_anything_runs(swept: Sweep, tmp_path: Path) -> None:
    """Every problem once, however many points have it; nothing is left on disk."""
    axes = ["amplifier.frequency=-2,-1,5 Hz", "spring.layers=2,2.5", "linkage.dampin=1,2"]
    with pytest.raises(ScenarioError) as caught:
        swept(*axes[:2], target=tmp_path / "out.nc")
    assert len(caught.value.problems) == 3
    with pytest.raises(ScenarioError, match="damping"):
        swept(axes[2], target=tmp_path / "out.nc")
    assert not list(tmp_path.iterdir())


# ------------------------------------------------------------------------------------ results


def test_results_equal_a_direct_run(swept: Sweep, outcome: Runner, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    axes = ["amplifier.frequency=16,18 Hz", "amplifier.waveform=square,sine"]
    data = swept(*axes, target=target, changes={"linkage.damping": "0.2"})
    changes = {"amplifier.frequency": "18 Hz", "amplifier.waveform": "sine"}
    direct = outcome(SCENARIO, {"linkage.damping": "0.2"} | changes, **SHORT)
    with xarray.open_dataset(target) as read:
        assert read.sizes == {"point": 4}
        for metric in metrics(dataset(direct)):
            assert read[metric.name].values[3] == metric.value
            assert read[metric.name].attrs["units"] == metric.unit
        np.testing.assert_array_equal(read["amplifier.frequency"].values, [16, 16, 18, 18])
        assert read["amplifier.frequency"].attrs["units"] == "Hz"
        assert list(read["amplifier.waveform"].values) == ["square", "sine"] * 2
        assert set(read.coords) == {"amplifier.frequency", "amplifier.waveform"}
        assert set(read["status"].values) == {"done"}
        assert set(read["reason"].values) == {""}
        assert (read["steps"].values == direct.steps).all()
        assert (read["wall_time"].values > 0.0).all()
        assert read.attrs["complete"] == 1
        xarray.testing.assert_equal(read.load(), data)
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


def test_figure_11(cluster: Any, library: Path, tmp_path: Path) -> None:
    """On workers of its own; they are gone at the end, and the environment is as before."""
    assert cluster.workers
    before = dict(os.environ)
    there = set(psutil.Process().children(recursive=True))
    target = tmp_path / "figure11.nc"
    axes = [parse_axis("amplifier.frequency=14:22/3Hz")]
    data = sweep(SCENARIO, axes, library, target, options={"time": {"stop": "5 cycles"}}, workers=2)
    stroke = data[STROKE].values
    assert stroke[1] > stroke[0] and stroke[1] > stroke[2]
    assert os.environ == before
    assert set(psutil.Process().children(recursive=True)) <= there


def test_points_are_taken_over_where_nothing_has_changed(swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    swept("amplifier.frequency=17:18/2Hz", target=target, keep=True)
    first = files(target)
    swept("amplifier.frequency=17,18,19Hz", target=target, keep=True)
    second = files(target)
    assert len(second) == 3 and first.items() <= second.items()
    damaged = Folder(target).path / sorted(first)[0]
    damaged.write_text(damaged.read_text().replace("1", "2", 1))
    swept("amplifier.frequency=17,18Hz", target=target, keep=True)
    changed = {name for name, written in files(target).items() if second[name] != written}
    assert changed == {damaged.name}
    other = {"time": {"stop": "3 cycles"}}
    data = swept("amplifier.frequency=17,18Hz", target=target, options=other)
    assert (data["steps"].values == 150).all()
    assert not files(target)


def test_a_folder_is_for_one_sweep_at_a_time(swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    with (
        Folder(target),
        pytest.raises(OutputError, match="in use by another sweep"),
    ):
        swept("amplifier.frequency=17,18Hz", target=target)
    assert not list(tmp_path.iterdir())


# ----------------------------------------------------------------------------- sick points


def test_a_sick_point_costs_itself(swept: Sweep, sick: Path, tmp_path: Path) -> None:
    """A crash, a hang, a number that is none and an error, between healthy neighbours."""
    target = tmp_path / "out.nc"
    told = {
        HEALTHY[0]: "",
        CRASH: "died twice",
        HEALTHY[1]: "",
        HANG: "no answer within 3 s",
        HEALTHY[2]: "",
        NAN: "not a finite number",
        HEALTHY[3]: "",
        ERROR: "sick: step",
    }
    axis = f"sick.fault={','.join(told)}"
    data = swept(axis, scenario=sick, target=target, patience=3.0)
    healthy = np.array([not reason for reason in told.values()])
    assert list(data["status"].values) == list(np.where(healthy, "done", "failed"))
    assert (np.isfinite(data[STROKE].values) == healthy).all()
    for reason, expected in zip(data["reason"].values, told.values(), strict=True):
        assert expected in reason and bool(expected) == bool(reason)
    with xarray.open_dataset(target) as read:
        assert read.attrs["complete"] == 1
        assert list(read["reason"].values) == list(data["reason"].values)


def test_a_worker_that_is_killed_costs_nothing(cluster: Any, swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    victim = next(iter(cluster.workers.values()))
    killer = when(lambda: len(files(target)) > 1, lambda: os.kill(victim.pid, signal.SIGKILL))
    data = swept("amplifier.frequency=14:22/9Hz", target=target)
    killer.join()
    assert set(data["status"].values) == {"done"}


def test_a_sweep_killed_half_way_goes_on_where_it_was(
    swept: Sweep, library: Path, tmp_path: Path
) -> None:
    """kill -9: its workers end too, no point is lost, and none is run twice."""
    target = tmp_path / "out.nc"
    axis = "amplifier.frequency=15:22/8Hz"
    process = subprocess.Popen([sys.executable, "-c", SCRIPT, axis, str(library), str(target)])
    try:
        until = time.monotonic() + 60.0
        while len(files(target)) < 3 and time.monotonic() < until:
            time.sleep(0.005)
        workers = psutil.Process(process.pid).children(recursive=True)
    finally:
        process.kill()
        process.wait()
    kept = files(target)
    assert 3 <= len(kept) < 8
    assert not psutil.wait_procs(workers, timeout=5.0)[1]
    assert not target.exists()
    data = swept(axis, target=target, keep=True)
    assert kept.items() <= files(target).items()
    assert len(files(target)) == 8
    assert set(data["status"].values) == {"done"}
    direct = swept("amplifier.frequency=15,22Hz", target=tmp_path / "ends.nc")
    np.testing.assert_array_equal(data[STROKE].values[[0, -1]], direct[STROKE].values)


SCRIPT = """
import sys
from pathlib import Path
from orchestrator.studies.sweep import parse_axis, sweep
if __name__ == "__main__":
    axis, library, target = sys.argv[1:]
    options = {"time": {"stop": "2 cycles"}}
    sweep("flapping-full-wings", [parse_axis(axis)], Path(library), Path(target), workers=1,
          options=options)
"""


def test_ctrl_c_keeps_what_is_there(library: Path, tmp_path: Path) -> None:
    """As a terminal sends it, to all processes: exit 130, one line, no process left."""
    target = tmp_path / "out.nc"
    command = [sys.executable, "-m", "orchestrator.cli", "sweep", SCENARIO, "--stop", "2 cycles"]
    command += ["--over", "amplifier.frequency=5:40/30Hz", "--output", str(target)]
    process = subprocess.Popen(
        [*command, "--fmus", str(library), "--workers", "2"],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    until = time.monotonic() + 60.0
    while len(files(target)) < 3 and time.monotonic() < until:
        time.sleep(0.005)
    workers = psutil.Process(process.pid).children(recursive=True)
    asked = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    said = process.communicate(timeout=30.0)[1]
    assert time.monotonic() - asked < 4.0
    assert process.returncode == 130
    assert said == "resilin: stopped by SIGINT\n"
    assert not psutil.wait_procs(workers, timeout=5.0)[1]
    with xarray.open_dataset(partial_path(target)) as read:
        status = list(read["status"].values)
        assert status.count("done") >= 3
        assert set(status) == {"done", "missing"}
        assert read.attrs["complete"] == 0
        assert np.isnan(read[STROKE].values[status.index("missing")])
    assert not target.exists()


def test_an_interrupt_comes_through(swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    interrupt = Interrupt()
    stop = when(lambda: files(target), lambda: setattr(interrupt, "number", signal.SIGTERM))
    with pytest.raises(Interrupted) as caught:
        swept("amplifier.frequency=5:40/30Hz", target=target, interrupt=interrupt)
    stop.join()
    assert caught.value.exit_code == 143
    assert partial_path(target).exists() and files(target)


def test_a_scheduler_that_goes_away_is_told(library: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    made: Any = LocalCluster
    with made(
        n_workers=1,
        threads_per_worker=1,
        scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
        silence_logs=logging.CRITICAL,
    ) as own:
        closing = when(lambda: files(target), own.close)
        with pytest.raises(SimulationError, match=r"gone.*; \d+ of 30 points are kept in .*points"):
            axes = [parse_axis("amplifier.frequency=5:40/30Hz")]
            sweep(SCENARIO, axes, library, target, scheduler=own.scheduler_address, options=SHORT)
        closing.join()
    assert files(target)


def test_a_scheduler_that_is_not_there_is_told(
    swept: Sweep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("orchestrator.studies.workers.dask_cluster.CONNECTING", 0.5)
    with pytest.raises(InputError, match="dask scheduler"):
        swept("amplifier.frequency=17Hz", target=tmp_path / "out.nc", scheduler="tcp://127.0.0.1:9")


def test_workers_with_other_files_are_told(cluster: Any, library: Path, tmp_path: Path) -> None:
    """An FMU that changes between planning and running is no part of the sweep."""
    own = tmp_path / "fmus"
    own.mkdir()
    for path in library.glob("*.fmu"):
        (own / path.name).write_bytes(path.read_bytes())
    setting = Setting(SCENARIO, str(own), {}, SHORT)
    points = planned(setting, [parse_axis("amplifier.frequency=17,18Hz")], ok).points
    with (own / "spring.fmu").open("ab") as file:
        file.write(b" ")
    pool = WorkerPool(calculate, None, cluster.scheduler_address, None)
    with pool, pytest.raises(InputError, match=r"worker tcp.*other FMU files.*same place"):
        list(pool.answers(points, ok))
    (own / "spring.fmu").unlink()
    assert "spring" in calculate(points[0])["unfit"]
    whole = planned(
        Setting(SCENARIO, str(library), {}, SHORT), [Axis("linkage.damping", ("1",))], ok
    )
    assert "install the same" in calculate(replace(whole.points[0], release="9.9"))["unfit"]


def ok() -> None:
    """Nothing to interrupt."""


# ------------------------------------------------------------------------------------ peaks


@pytest.mark.parametrize("top", [3.3, 5.0, 7.9])
def test_bisection_finds_a_resonance(top: float) -> None:
    """From a grid of nine to the peak of |1 / (1 - r^2 + 2 i zeta r)|, in few points."""

    def response(place: float) -> float:
        r = place / top
        return float(1.0 / abs(1 - r**2 + 0.2j * r))

    values = {float(place): response(place) for place in range(1, 10)}
    finest = FINEST * spacing(values)
    while more := middles(values, finest):
        values |= {place: response(place) for place in more}
    found = peak_of(values)
    assert found is not None
    exact = top * math.sqrt(1 - 2 * 0.1**2)
    assert abs(found.at - exact) < finest
    assert found.value == pytest.approx(response(exact), rel=1e-3)
    assert len(values) <= 9 + 6


@pytest.mark.parametrize(
    ("values", "peak"),
    [
        ({}, None),
        ({1.0: math.nan}, None),
        ({1.0: 2.0}, Peak(1.0, 2.0)),
        ({1.0: 2.0, 2.0: 3.0}, Peak(2.0, 3.0)),
        ({0.0: 0.0, 1.0: 1.0, 2.0: 0.0}, Peak(1.0, 1.0)),
        ({0.0: 0.0, 1.0: 3.0, 2.0: 4.0, 3.0: 3.0}, Peak(2.0, 4.0)),
        ({0.0: 1.0, 1.0: 4.0, 3.0: 4.0}, Peak(2.0, 5.0)),
        ({0.0: 0.0, 1.0: 1.0, 2.0: math.nan}, Peak(1.0, 1.0)),
        ({0.0: 1.0, 1.0: 1.0, 2.0: 1.0}, Peak(0.0, 1.0)),
    ],
)
def test_the_top_of_a_parabola(values: Mapping[float, float], peak: Peak | None) -> None:
    found = peak_of(values)
    if peak is None or found is None:
        assert found is peak
    else:
        assert (found.at, found.value) == pytest.approx((peak.at, peak.value))


def test_whole_numbers_are_bisected_into_whole_numbers() -> None:
    values = {2.0: 1.0, 4.0: 3.0, 5.0: 2.0}
    assert middles(values, 0.1, whole=True) == [3.0]


def test_refining_adds_points_at_the_peak(swept: Sweep, tmp_path: Path) -> None:
    """They stand in order, are kept as others are, and the result says where the peak is."""
    target = tmp_path / "out.nc"
    coarse = "amplifier.frequency=8:26/4Hz"
    data = swept(coarse, target=target, refine=STROKE, keep=True)
    places, stroke = data["amplifier.frequency"].values, data[STROKE].values
    assert 4 < len(places) <= 10
    assert (np.diff(places) > 0).all()
    fine = swept("amplifier.frequency=15:23/17Hz", target=tmp_path / "fine.nc")
    best = int(np.argmax(fine[STROKE].values))
    assert abs(data.attrs["peak_at"] - fine["amplifier.frequency"].values[best]) <= 0.75
    assert data.attrs["peak"] == pytest.approx(float(fine[STROKE].values[best]), rel=5e-3)
    assert stroke.max() <= data.attrs["peak"] * (1 + 1e-12)
    before = files(target)
    again = swept(coarse, target=target, refine=STROKE, keep=True)
    assert files(target) == before
    xarray.testing.assert_identical(again, data)


def test_what_cannot_be_refined_is_told(swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    frequencies = "amplifier.frequency=17,18,19Hz"
    for axes, told in [
        ([frequencies, "linkage.damping=0.1,0.2"], "over one axis"),
        (["amplifier.waveform=square,sine,half_wave_sine"], "takes texts"),
        (["amplifier.frequency=17,18Hz"], "fewer than three"),
    ]:
        with pytest.raises(InputError, match=told):
            swept(*axes, target=target, refine=STROKE)
    with pytest.raises(InputError, match=r"did you mean 'flapping stroke'.*3 of 3 points"):
        swept(frequencies, target=target, refine="flaping stroke")
    assert len(files(target)) == 3


def test_a_record_survives_its_file(tmp_path: Path, library: Path) -> None:
    """Numbers that are none included; what is not whole is as if it were not there."""
    axes = [parse_axis("amplifier.frequency=17Hz")]
    point = planned(Setting(SCENARIO, str(library), {}, {}), axes, ok).points[0]
    record = Record("done", "", (("a", math.inf, "m"), ("b", 0.1, "N")), 1.5, 7)
    with Folder(tmp_path / "out.nc") as folder:
        folder.write(point, record)
        read = folder.read(point)
        assert read is not None and math.isnan(read.metrics[0][1])
        assert read.metrics[1] == ("b", 0.1, "N") and read.steps == 7
        path = folder.path / f"{point.key}.json"
        content = json.loads(path.read_text())
        for text in ("", "[]", "{}", json.dumps(content | {"sha256": "0"})):
            path.write_text(text)
            assert folder.read(point) is None
