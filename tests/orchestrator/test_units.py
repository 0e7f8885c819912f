"""Texts with units to SI, and FMI's unit strings to each other."""

from __future__ import annotations

import pytest

from orchestrator.units import UnitError, factor, si_value


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1.9 mm", "m", 1.9e-3),
        ("0 N*m", "N.m", 0.0),
        ("20 Hz", "Hz", 20.0),
        ("40um", "m", 40e-6),
        ("1 kV", "V", 1000.0),
        ("0.1 Mohm", "Ohm", 1e5),
        ("1e-3", "s", 1e-3),
        (2, "s", 2.0),
        ("5 %", "1", 0.05),
        ("90 deg", "rad", 1.5707963267948966),
    ],
)
def test_values(text: str | float, unit: str, value: float) -> None:
    assert si_value(text, unit) == pytest.approx(value)


@pytest.mark.parametrize(
    "text", ["50 kg", "nan", "inf", "1e999", "ten s", "", "5 s 3", "20 degC", "1 furlongs^"]
)
def test_what_is_refused(text: str) -> None:
    with pytest.raises(UnitError):
        si_value(text, "s")


def test_truth_is_not_a_number() -> None:
    with pytest.raises(UnitError, match="not numbers"):
        si_value(True, "s")


def test_factors_between_fmi_units() -> None:
    assert factor("mm", "m") == pytest.approx(1e-3)
    assert factor("N.s/m", "kg/s") == pytest.approx(1.0)
    assert factor("V2/s2", "V2/s2") == 1.0
    with pytest.raises(UnitError, match="not convertible"):
        factor("N", "N.m")
    with pytest.raises(UnitError):
        factor("degC", "K")
