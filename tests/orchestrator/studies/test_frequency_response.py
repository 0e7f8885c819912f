"""The plot of a frequency response: units, phases without jumps, nothing below the floor."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orchestrator.simulation.linear.state_space import Linear
from orchestrator.studies.frequency_response import draw, phase, ratio

COMMAND, MOVED, NOISE = "drive.voltage", "mass.displacement", "mass.noise"


def lag(noise: float) -> Linear:
    """A first-order lag of one second, seen every 0.1 s, and an output of the given size."""
    pole = np.exp(-0.1)
    return Linear(
        a=np.array([[pole]]),
        b=np.array([[1.0 - pole]]),
        c=np.array([[-1.0], [noise]]),
        d=np.zeros((2, 1)),
        step=0.1,
        inputs=[COMMAND],
        outputs=[MOVED, NOISE],
        rest=np.zeros(2),
        units={COMMAND: "V", MOVED: "m", NOISE: "m/s"},
        floor=np.full(2, 1e-6),
    )


@pytest.mark.parametrize(
    ("output", "source", "wanted"),
    [
        ("m", "V", "m/V"),
        ("m/s", "V", "m/(s V)"),
        ("1", "V", "1/V"),
        ("", "V", "1/V"),
        ("m", "1", "m"),
        ("N", "m/s", "N/(m/s)"),
        ("V", "V", "V/V"),
    ],
)
def test_the_unit_of_a_ratio(output: str, source: str, wanted: str) -> None:
    assert ratio(output, source) == wanted


@pytest.mark.parametrize("start", [-180.0, -179.9, 179.9, 180.0])
def test_a_negative_gain_is_half_a_turn_behind(start: float) -> None:
    """On either side of the half turn, where rounding decides the sign."""
    degrees = np.linspace(start, start - 400.0, 60)
    found = phase(np.exp(1j * np.radians(degrees)))
    assert found[0] == pytest.approx(-180.0, abs=0.2)
    assert np.abs(np.diff(found)).max() < 10.0


def test_a_rate_leads_by_a_quarter() -> None:
    degrees = np.linspace(90.2, -90.0, 30)
    np.testing.assert_allclose(phase(np.exp(1j * np.radians(degrees))), degrees)


def test_a_gap_of_the_unknown_stays_a_gap() -> None:
    response = np.exp(1j * np.radians(np.linspace(0.0, -350.0, 40)))
    response[10:13] = np.nan
    found = phase(response)
    assert np.isnan(found[10:13]).all()
    assert np.isfinite(np.delete(found, [10, 11, 12])).all()
    assert found[-1] == pytest.approx(-350.0)


def test_what_is_below_the_floor_is_not_drawn(tmp_path: Path) -> None:
    """The texts of an SVG stand in its comments."""
    quiet = draw(lag(1e-7), tmp_path / "quiet.svg", 1.0).read_text()
    loud = draw(lag(1e-5), tmp_path / "loud.svg", 1.0).read_text()
    assert "magnitude (m/V)" in quiet
    assert MOVED in quiet
    assert NOISE not in quiet
    assert NOISE in loud
    assert "magnitude (m/(s V))" in loud
