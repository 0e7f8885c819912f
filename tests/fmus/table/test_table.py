"""A table: through its points, its slopes, outside of it, in the place of a part, and refused."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import build_fmus
import fmus
from fmus.aero import physics as aero
from orchestrator.fmi.description import read_interface
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.fmus.test_parts import instance

Array = NDArray[np.float64]
HERE = Path(fmus.__file__).parent / "table"


def written(path: Path, heading: str, rows: Sequence[Sequence[float]]) -> Path:
    lines = [heading, *(",".join(map(repr, map(float, row))) for row in rows)]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def table(data: Path, into: Path, *, native: bool = True) -> Path:
    """An FMU of a file's points, in the folder `into`."""
    return build_fmus.build("table", alias=data.stem, data=data, native=native, into=into).path


def answers(
    path: Path, folder: Path, points: Sequence[Sequence[float]], **start: float
) -> dict[str, Array]:
    """Outputs of an FMU at points of its inputs."""
    folder.mkdir(exist_ok=True)
    rows = []
    with instance(path, folder, {**start}) as (unit, interface, sent, got):
        for point in points:
            sent[:] = point
            unit.send()
            unit.receive()
            rows.append(got.copy())
    names = [variable.name for variable in interface.of("output")]
    return dict(zip(names, np.array(rows).T, strict=True))


def test_the_sample_is_made_of_its_file() -> None:
    made = build_fmus.tabulated_files(HERE / "sample.csv")
    for name, text in made.items():
        assert (HERE.parent / name).read_bytes() == text


def wave(u: float, v: float) -> float:
    return float(np.sin(2.0 * u) * np.cosh(v))


def test_two_arguments(tmp_path: Path) -> None:
    """Through the points; the error between them falls with the spacing, its slopes fit."""
    points = np.random.default_rng(2).uniform(0.1, 0.65, (40, 2))
    exact = np.array([wave(u, v) for u, v in points])
    scales = np.array([1e-3, 1.0])
    step = 1e-7 * scales
    errors: dict[float, list[float]] = {1.0: [], 2.0: []}
    for count in (9, 17, 33):
        grid = np.linspace(0.0, 0.75, count)
        rows = [(u, v, wave(u, v)) for v in grid for u in grid]
        path = table(
            written(tmp_path / f"wave{count}.csv", "in.u [mm], v, out.y [V]", rows), tmp_path
        )
        asked = [points * scales]
        asked += [points * scales + side * step * axis for axis in np.eye(2) for side in (-1, 1)]
        asked.append(np.array(rows)[:, :2] * scales)
        for how, found_errors in errors.items():
            folder = tmp_path / f"{count}"
            found = answers(path, folder, np.concatenate(asked).tolist(), interpolation=how)
            y = found["out.y"]
            found_errors.append(float(np.abs(y[:40] - exact).max()))
            for k, name in enumerate(("out.y_by_u", "out.y_by_v")):
                low, high = y[40 + 80 * k : 80 + 80 * k], y[80 + 80 * k : 120 + 80 * k]
                slope = (high - low) / (2.0 * step[k])
                near = pytest.approx(slope, rel=1e-5, abs=1e-6 * np.abs(slope).max())
                assert found[name][:40] == near
            assert y[200:] == pytest.approx([row[2] for row in rows], abs=1e-13)
    for how, order in ((1.0, 2.7), (2.0, 1.8)):
        falls = np.log2(np.array(errors[how][:-1]) / np.array(errors[how][1:]))
        assert (falls > order).all(), errors
    units = {name: v.unit for name, v in read_interface(path).variables.items()}
    assert (units["in.u"], units["out.y"]) == ("m", "V")


def test_cubics_do_not_overshoot(tmp_path: Path) -> None:
    rows = [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0), (3.0, 1.0), (4.0, 5.0)]
    path = table(written(tmp_path / "stairs.csv", "u, y", rows), tmp_path)
    found = answers(path, tmp_path / "x", [(u,) for u in np.linspace(0.0, 4.0, 401)])
    assert (np.diff(found["y"]) >= -1e-15).all()
    assert found["y"][:101] == pytest.approx(np.zeros(101), abs=1e-15)


@pytest.mark.parametrize("native", [True, False])
def test_outside(tmp_path: Path, native: bool) -> None:
    """The slope of a monotone cubic at an end is that of a parabola through three points."""
    rows = [(u, u * u) for u in (0.0, 1.0, 2.0, 3.0)]
    data = written(tmp_path / "square.csv", "u [s], y", rows)
    path = table(data, tmp_path, native=native)
    for outside, value, slope in ((2.0, 9.0, 0.0), (3.0, 12.0, 6.0)):
        found = answers(path, tmp_path / "x", [(3.5,)], outside=outside)
        assert found["y"][0] == pytest.approx(value)
        assert found["y_by_u"][0] == pytest.approx(slope)


def test_a_law_instead_of_a_slope(tmp_path: Path) -> None:
    rows = [(x, -200.0 * x) for x in (-1.0, 0.0, 1.0)]
    data = written(tmp_path / "k.csv", "motion.displacement [mm], force.value [mN]", rows)
    path = table(data, tmp_path)
    found = answers(path, tmp_path / "x", [(2.5e-4,)])
    assert found["force.stiffness"][0] == pytest.approx(200.0)
    assert found["force.reference_displacement"][0] == 2.5e-4
    orders = {n: v.order for n, v in read_interface(path).variables.items() if v.port == "force"}
    names = ("force.value", "force.stiffness", "force.reference_displacement")
    assert orders == dict(zip(names, (0, 1, 1), strict=True))


def drag(count: int) -> list[tuple[float, float, float]]:
    """The load of `aero` at flap rates up to 120 rad/s."""
    p = aero.Params()
    rows = []
    for rate in np.linspace(-120.0, 120.0, count):
        u = aero.Input(motion_flap_angle=0.0, motion_flap_rate=float(rate))
        found = aero.observe(p, aero.initial(p, u, 0.0), u, 0.0)
        rows.append((float(rate), found.load_torque, found.load_added_inertia))
    return rows


SCENARIO = """
extends = "flapping-full-wings"
[components.aero]
fmu = "drag.fmu"
[record]
inherit = false
variables = ["linkage.flap_angle", "linkage.displacement"]
"""
HEADING = "motion.flap_rate [rad/s], load.torque [N.m], load.added_inertia [kg.m2]"


@pytest.fixture
def in_place_of_aero(tmp_path: Path) -> Callable[[int], Path]:
    """A scenario with the drag of `aero`, at so many flap rates, in its place."""

    def made(count: int) -> Path:
        table(written(tmp_path / "drag.csv", HEADING, drag(count)), tmp_path)
        (tmp_path / "drag.toml").write_text(SCENARIO, encoding="utf-8")
        return tmp_path / "drag.toml"

    return made


def swing(path: str | Path, library: Path, steps: int, laws: str = "curvature") -> float:
    """Range of the flap angle over the last cycle."""
    given = {"stop": "20 cycles", "step": {"per_cycle": steps}}
    found = run(load(path, None, library, time=given, master={"laws": laws}))
    return float(np.ptp(found.series("linkage.flap_angle")[-steps:]))


def test_in_the_place_of_aero(native: Path, in_place_of_aero: Callable[[int], Path]) -> None:
    """The same stroke, and nearer to its own with the law than by numbers alone."""
    path = in_place_of_aero(41)
    fine = swing(path, native, 800)
    assert fine == pytest.approx(swing("flapping-full-wings", native, 800), rel=1e-4)
    law, numbers = (abs(swing(path, native, 50, laws) - fine) for laws in ("curvature", "held"))
    assert law < 0.2 * numbers


def test_a_run_that_leaves_the_table_stops(tmp_path: Path, native: Path) -> None:
    rows = [row for row in drag(41) if abs(row[0]) < 40.0]
    table(written(tmp_path / "drag.csv", HEADING, rows), tmp_path)
    (tmp_path / "drag.toml").write_text(SCENARIO, encoding="utf-8")
    found = run(load(tmp_path / "drag.toml", None, native))
    assert found.failure is not None
    assert "motion.flap_rate is outside of the table, -36 to 36 rad/s" in str(found.failure)


@pytest.mark.parametrize(
    ("heading", "rows", "words"),
    [
        ("u, v, y", [(0, 0, 1), (0, 1, 1), (1, 0, 1)], "the point u = 1, v = 1 is missing"),
        ("u, v, y", [(0, 0, 1), (0, 0, 1), (1, 0, 1), (1, 1, 1)], "is there more than once"),
        ("u, y", [(0, 1), (0, 2)], "no column is left for an output"),
        ("u, y", [(0, 1)], "one row"),
        ("u [furlong/x], y", [(0, 1), (1, 1)], "furlong"),
        ("u, y z", [(0, 1), (1, 1)], "no column is left"),
        ("u, u", [(0, 1), (1, 1)], "u"),
    ],
)
def test_what_is_no_table_is_refused(
    tmp_path: Path, heading: str, rows: list[tuple[float, ...]], words: str
) -> None:
    data = written(tmp_path / "bad.csv", heading, rows)
    with pytest.raises(build_fmus.BuildError, match=words):
        table(data, tmp_path)
    assert not (tmp_path / "bad.fmu").exists()


def test_words_of_python_can_be_names(tmp_path: Path) -> None:
    rows = [(0.0, 1.0), (1.0, 3.0)]
    path = table(written(tmp_path / "odd.csv", "lambda, class", rows), tmp_path)
    assert answers(path, tmp_path / "x", [(0.5,)])["class"][0] == pytest.approx(2.0)
    assert importlib.util.find_spec("fmus.table") is not None
