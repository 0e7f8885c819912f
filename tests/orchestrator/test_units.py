"""Texts with units to SI, and FMI's unit strings to each other."""

from __future__ import annotations

import pytest

from orchestrator.units import Definition, UnitError, declared, definition, factor, si_value


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


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("Nm", "N.m"),
        ("kNm/rad", "kN.m/rad"),
        ("N-m", "N.m"),
        ("Nmm", "mN.m"),
        ("sec", "s"),
        ("Volts", "V"),
        ("\u03bcs", "us"),
        ("\u00b5s", "us"),
        ("\u00b0", "deg"),
        ("\u00b0/s", "deg/s"),
        ("m/s\u00b2", "m/s2"),
        ("m.s-1", "m/s"),
        ("---", "1"),
        ("n/a", "1"),
        ("0.5 rad/s", "0.5 rad/s"),
        ("2.5", "2.5 1"),
    ],
)
def test_spellings(written: str, meant: str) -> None:
    assert factor(written, meant) == pytest.approx(1.0)


@pytest.mark.parametrize(("one", "other"), [("Hz", "rad/s"), ("N.m", "N.m/rad"), ("rpm", "Hz")])
def test_the_radian_is_a_base_unit(one: str, other: str) -> None:
    with pytest.raises(UnitError, match="not convertible"):
        factor(one, other)


@pytest.mark.parametrize(
    ("name", "base", "text"),
    [
        ("1/min", {"s": "-1", "rad": "1", "factor": "0.1047"}, "0.1047 rad/s"),
        ("1/min", {"s": "-1", "factor": "0.0166667"}, "1/min"),
        ("Nm", {"kg": "1", "m": "2", "s": "-2"}, "Nm"),
        ("rad/s", {"s": "-1"}, "rad/s"),
        ("Hz", {"s": "-1", "rad": "1"}, "rad/s"),
        ("Furz", {"kg": "1", "factor": "0.5"}, "0.5 kg"),
        ("degC", {"K": "1", "offset": "273.15"}, "degC"),
        ("percent_of", {"factor": "0.01"}, "0.01"),
        ("deg", {"rad": "1", "factor": "0.0174533"}, "deg"),
    ],
)
def test_what_a_file_declares_decides(name: str, base: dict[str, str], text: str) -> None:
    assert declared(name, Definition.of(base)) == text


def test_a_definition_comes_back_from_its_text() -> None:
    meaning = Definition.of({"kg": "1", "s": "-2", "rad": "1", "factor": "2.5e-3"})
    assert definition(meaning.text()) == meaning


def test_an_offset_that_no_name_has_is_not_converted() -> None:
    text = declared("Grad", Definition.of({"K": "1", "offset": "100"}))
    with pytest.raises(UnitError):
        factor(text, "K")


@pytest.mark.parametrize("base", [{"kg": "heavy"}, {"factor": "0"}, {"factor": "nan"}])
def test_base_units_that_are_no_numbers(base: dict[str, str]) -> None:
    with pytest.raises(ValueError, match=r"heavy|factor"):
        Definition.of(base)
