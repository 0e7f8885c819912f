"""Inputs that rise over a step: third order for units of others that exchange plain numbers."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from orchestrator.fmi.description import read_interface
from orchestrator.simulation.load import load
from orchestrator.simulation.masters.extrapolation import mean_weights, tilt_weights
from orchestrator.simulation.run import run
from tests.foreign.build import foreign
from tests.foreign.scenarios import part, scenario, wires


def test_the_line_has_the_mean_and_the_first_moment() -> None:
    """Of the parabola 3 s^2 - 2 s on [0, 1]: 0 and 1/12 - 0; s from points at other times."""
    times = (0.7, 0.2, -0.5)
    values = [3.0 * t * t - 2.0 * t for t in times]
    mean, tilt = (
        sum(w * y for w, y in zip(weights(times, 0.0, 1.0), values, strict=True))
        for weights in (mean_weights, tilt_weights)
    )
    assert mean == pytest.approx(0.0, abs=1e-15)
    moment = 3.0 / 4.0 - 2.0 / 3.0 - 0.5 * mean
    assert tilt == pytest.approx(6.0 * moment)


def deviation(folder: Path, fmu: Path, step: float, **keys: str) -> float:
    """Largest error of two lags that follow each other: (x + i y)' = (-1 + i) (x + i y)."""
    folder.mkdir()
    path = scenario(
        folder,
        part("a", fmu, start={"start": 1.0}),
        part("b", fmu),
        wires("b.y -> a.u * -1.0", "a.y -> b.u"),
        '[master]\nkind = "extrapolated"',
        *(f"{key} = {value}" for key, value in keys.items()),
        '[record]\nvariables = ["a.y", "b.y"]',
        stop=2.0,
        step=step,
    )
    done = run(load(path), estimate=False).checked()
    exact = np.exp((-1.0 + 1.0j) * done.times)
    found = done.series("a.y") + 1.0j * done.series("b.y")
    return float(np.abs(found - exact).max())


@pytest.mark.parametrize(("interpolates", "order"), [(False, 2), (True, 3)])
def test_two_lags_by_fmi2(tmp_path: Path, interpolates: bool, order: int) -> None:
    fmu = foreign("LAG", tmp_path, interpolates=interpolates)
    assert read_interface(fmu).interpolates == interpolates
    errors = [deviation(tmp_path / f"{n}", fmu, 2.0 / n) for n in (40, 80, 160)]
    falls = [math.log2(a / b) for a, b in itertools.pairwise(errors)]
    assert falls == pytest.approx([order] * 2, abs=0.3), errors


def test_a_gain_scales_the_rate(tmp_path: Path) -> None:
    """The wire to a has the gain -1, without which the answer would be another one."""
    fmu = foreign("LAG", tmp_path, interpolates=True)
    assert deviation(tmp_path / "fine", fmu, 1e-3) < 1e-8
