"""A measured cone in the place of the solver's: its own force, sampled, gives the film back."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import build_fmus
from fmus.constants import VACUUM_PERMITTIVITY
from fmus.membrane import tables
from fmus.membrane.measured import measured_table
from fmus.membrane.physics import Params
from fmus.membrane.potential import potential
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run

P = Params()
FILM = 0
UNIT = 2.0 * math.pi * P.layers * P.thickness * P.outer_radius * P.modulus
"""Force [N] of one cone that is 1 in the table's units."""
GROUP = VACUUM_PERMITTIVITY * P.permittivity / (P.modulus * P.thickness * P.thickness)
TOP = 1950.0
HEAD = (
    f"[measured]\nouter_radius = {P.outer_radius}\nthickness = {P.thickness}\n"
    f"modulus = {P.modulus}\npermittivity = {P.permittivity}\nlayers = {P.layers}\n"
)


def cone(height: float, voltage: float) -> tuple[float, float]:
    """Force [N] and capacitance [F] of one cone of the vehicle's film."""
    p = potential(FILM, height / P.outer_radius, GROUP * voltage * voltage)
    size = UNIT * P.outer_radius
    return UNIT * p.px, -2.0 * size * GROUP * p.pe


def sampled(count: int) -> str:
    """The film's own force on a grid of so many heights and voltages, as CSV."""
    heights = np.linspace(0.3, 1.1, count) * P.outer_radius
    lines = ["height, voltage, force, capacitance"]
    for height in heights:
        for voltage in np.linspace(0.0, TOP, count):
            lines.append(
                ", ".join(
                    map(repr, (float(height), float(voltage), *map(float, cone(height, voltage))))
                )
            )
    return "\n".join(lines)


def entry(count: int) -> dict[str, object]:
    return {
        "outer_radius": P.outer_radius, "thickness": P.thickness, "modulus": P.modulus,
        "permittivity": P.permittivity, "layers": P.layers, "measured": sampled(count),
    }  # fmt: skip


def deviations(count: int, monkeypatch: pytest.MonkeyPatch) -> tuple[float, float]:
    """Largest errors of force and capacitance over the domain, by their largest values."""
    made = measured_table(dict(entry(count)), tables.NODES, (tables.CELLS_X, tables.CELLS_E))
    rng = np.random.default_rng(3)
    places = [(rng.uniform(0.31, 1.09), rng.uniform(0.0, 1920.0)) for _ in range(300)]
    wanted = np.array([cone(x * P.outer_radius, v) for x, v in places])
    with monkeypatch.context() as patch:
        for name, key in (("LOWEST", "lowest"), ("HIGHEST", "highest"), ("LOADING", "loading")):
            patch.setattr(f"fmus.membrane.potential.{name}", (made[key],))
        rows = tuple(map(tuple, made["potential"]))
        patch.setattr("fmus.membrane.potential.POTENTIAL", (rows,))
        found = np.array([cone(x * P.outer_radius, v) for x, v in places])
    force, capacitance = np.abs(found - wanted).max(axis=0) / np.abs(wanted).max(axis=0)
    return float(force), float(capacitance)


def test_the_films_own_force_gives_it_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cubic through the points: the error falls with the third power of the spacing."""
    coarse, middle, fine = (deviations(count, monkeypatch) for count in (6, 11, 21))
    assert fine[0] < 1e-4
    assert fine[1] < 1e-3
    assert fine[0] < middle[0] / 6.0 < coarse[0] / 24.0
    assert fine[1] < middle[1] / 5.0 < coarse[1] / 20.0


def test_the_vehicle_flies_on_a_measured_cone(native: Path, tmp_path: Path) -> None:
    """In the place of the film in the flagship, its own force on a grid of 15 by 15."""
    films = tmp_path / "films.toml"
    films.write_text(f'{HEAD}measured = """\n{sampled(15)}\n"""\n')
    build_fmus.build("membrane", alias="cone", data=films, into=tmp_path, native=True)
    for path in native.glob("*.fmu"):
        (tmp_path / path.name).symlink_to(path)
    time = {"stop": "40 cycles"}
    strokes = []
    for fmu in ("membrane", "cone"):
        scenario = tmp_path / f"{fmu}.toml"
        scenario.write_text(
            f'extends = "flapping-full-wings"\n[components.actuator]\nfmu = "{fmu}"\n'
            "start = { layers = 8.0 }\n"
        )
        outcome = run(load(str(scenario), None, tmp_path, time=time), estimate=False).checked()
        late = outcome.times > outcome.times[-1] - 0.1
        strokes.append(float(np.ptp(outcome.series("linkage.flap_angle")[late])))
    assert strokes[1] == pytest.approx(strokes[0], rel=2e-3)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("height, voltage", "height, volts", "needs the columns height, voltage, force, cap"),
        ("0.0039, 0.0,", "0.0039, zero,", "line 2 is not four numbers"),
        ("0.0039, 0.0,", "0.0039, 650.0,", "line 3 repeats"),
        ("0.0039, 0.0,", "nan, 0.0,", "line 2 is not four finite numbers"),
        ("layers = 8.0", "layers = 0.0", "layers are above zero"),
        ("layers = 8.0", "layer = 8.0", "layers is missing"),
        ("layers = 8.0", "layers = 8.0\nprestrech = 1.0", "prestrech is not known"),
    ],
)
def test_a_map_that_cannot_be_is_told(tmp_path: Path, old: str, new: str, reason: str) -> None:
    text = f'{HEAD}measured = """\n{sampled(4)}\n"""\n'
    assert old in text
    films = tmp_path / "films.toml"
    films.write_text(text.replace(old, new, 1))
    with pytest.raises(build_fmus.BuildError, match=reason):
        build_fmus.build("membrane", alias="cone", data=films, into=tmp_path)
    assert not list(tmp_path.glob("*.fmu"))


def test_a_map_with_a_hole_is_told(tmp_path: Path) -> None:
    lines = sampled(4).splitlines()
    films = tmp_path / "films.toml"
    text = "\n".join([*lines[:5], *lines[6:]])
    films.write_text(f'{HEAD}measured = """\n{text}\n"""\n')
    with pytest.raises(build_fmus.BuildError, match="1 points are missing, as "):
        build_fmus.build("membrane", alias="cone", data=films, into=tmp_path)
