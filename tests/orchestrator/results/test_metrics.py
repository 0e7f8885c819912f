"""Metrics as a scenario defines them, on known signals."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import xarray

from orchestrator.results.metrics import Metric, left_out, metrics

VEHICLE = {
    "flapping stroke": "peak_to_peak(linkage.flap_angle) in deg",
    "travel": "peak_to_peak(linkage.displacement) in mm",
    "frequency": "frequency(linkage.displacement)",
    "phase": "phase(linkage.displacement, amplifier.top.voltage**2 - amplifier.bottom.voltage**2)",
    "peak voltage": "max(amplifier.top.voltage, amplifier.bottom.voltage)",
    "electrical power": "rate(amplifier.supplied_energy) in mW",
    "mean lift": "mean(aero.lift) in mgf",
    "efficiency": "rate(linkage.force_work) / rate(amplifier.supplied_energy)",
}


def synthetic(
    defined: dict[str, Any],
    frequency: float = 18.0,
    cycles: int = 10,
    per_cycle: int = 40,
    attribute: str = "scenario",
) -> xarray.Dataset:
    t = np.linspace(0.0, cycles / frequency, per_cycle * cycles + 1)
    w = 2 * np.pi * frequency
    top = np.where(np.sin(w * t + 1e-9) > 0, 1920.0, 0.0)
    columns = {
        "amplifier.top.voltage": (top, "V"),
        "amplifier.bottom.voltage": (1920.0 - top, "V"),
        "amplifier.supplied_energy": (0.2 * t, "J"),
        "linkage.displacement": (np.sin(w * t - np.pi / 2) + 0.1, "mm"),
        "linkage.flap_angle": (0.5 * np.sin(w * t), "rad"),
        "aero.lift": (np.full_like(t, 1e-3), "N"),
        "tank.odd": (np.linspace(0.0, 1.0, len(t)), "furlongs"),
    }
    return xarray.Dataset(
        {name: ("time", values, {"units": unit}) for name, (values, unit) in columns.items()},
        coords={"time": t},
        attrs={"frequency": frequency, attribute: json.dumps({"metrics": defined})},
    )


def found(defined: dict[str, Any], **shape: Any) -> dict[str, Metric]:
    return {metric.name: metric for metric in metrics(synthetic(defined, **shape))}


@pytest.mark.parametrize(
    ("text", "frequency", "reason"),
    [
        ("mean(room.C)", 18.0, '[record] write variables = ["room.C"]'),
        ("mean(aero.lift) - last(room.C)", 18.0, '= ["room.C"]'),
        ("frequency(aero.lift)", 18.0, "run longer"),
        ("phase(aero.lift, amplifier.top.voltage)", 18.0, "does not swing"),
        ("phase(linkage.flap_angle, amplifier.top.voltage)", 0.0, "give time.frequency"),
    ],
)
def test_a_metric_that_is_left_out_has_a_reason(text: str, frequency: float, reason: str) -> None:
    data = synthetic({"asked": text, "travel": "last(aero.lift)"})
    data.attrs["frequency"] = frequency
    (gone,) = left_out(data)
    assert gone.name == "asked" and reason in gone.reason
    assert [metric.name for metric in metrics(data)] == ["travel"]


def test_metrics_of_known_signals_are_in_si() -> None:
    known = found(VEHICLE)
    assert known["flapping stroke"].value == pytest.approx(1.0, rel=1e-3)
    assert known["travel"].value == pytest.approx(2e-3, rel=1e-3)
    assert known["frequency"].value == pytest.approx(18.0, rel=1e-3)
    assert known["phase"].value == pytest.approx(np.pi / 2, abs=0.1)
    assert known["peak voltage"].value == 1920.0
    assert known["electrical power"].value == pytest.approx(0.2, rel=1e-6)
    assert known["mean lift"].value == pytest.approx(1e-3)
    assert "efficiency" not in known, "its work was not recorded"


def test_each_is_shown_in_the_unit_asked_for_else_in_its_own() -> None:
    known = found(VEHICLE)
    assert known["flapping stroke"].shown == "57.30 deg"
    assert known["travel"].shown == "2.000 mm"
    assert known["electrical power"].shown == "200.0 mW"
    assert known["mean lift"].shown == "102.0 mgf"
    assert known["peak voltage"].shown == "1920 V"
    assert found({"x": "last(tank.odd)"})["x"].shown == "1.000 furlongs"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("min(linkage.flap_angle)", -0.5),
        ("rms(linkage.flap_angle)", 0.5 / np.sqrt(2.0)),
        ("first(amplifier.supplied_energy) * 0 + 2", 2.0),
        ("2 * max(linkage.flap_angle) - -1", 2.0),
        ("max(linkage.flap_angle ** 2)", 0.25),
        ("max('linkage.flap_angle')", 0.5),
        ("mean(linkage.flap_angle * 0 + aero.lift)", 1e-3),
    ],
)
def test_expressions_combine_functions_numbers_and_variables(text: str, value: float) -> None:
    assert found({"x": text})["x"].value == pytest.approx(value, abs=2e-3)


def test_a_result_of_the_previous_release_gives_the_same_metrics() -> None:
    """It carries its scenario as the attribute `scene`."""
    assert found(VEHICLE, attribute="scene") == found(VEHICLE)


def test_what_does_not_move_has_no_frequency() -> None:
    assert found({"f": "frequency(aero.lift)", "p": "phase(aero.lift, aero.lift)"}) == {}


def test_a_metric_that_is_not_a_number_shows_the_reason() -> None:
    known = found({"x": "rate(aero.lift) / rate(aero.lift)", "y": "max(aero.lift)"})
    assert np.isnan(known["x"].value)
    assert "comes to nan" in known["x"].shown
    short = found({"y": "max(aero.lift)"}, cycles=1, per_cycle=1)
    assert np.isnan(short["y"].value)
    assert "2 rows are fewer than the 3" in short["y"].shown


def test_a_scenario_without_metrics_shows_last_values() -> None:
    known = found({"cycles": 3})
    assert list(known) == [
        "last amplifier.top.voltage",
        "last amplifier.bottom.voltage",
        "last amplifier.supplied_energy",
        "last linkage.displacement",
    ]
