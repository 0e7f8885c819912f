"""Bad connections of a scenario."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.orchestrator.good_scenario import HOLD, SCENARIO, TWO, Refuse, changed, label


@pytest.mark.parametrize(
    ("wire", "reasons"),
    [
        ('from="spring.force.value"\nto="payload.force.value"', ["fed twice", "wires[0]"]),
        ('from="spring.forse"\nto="payload.force"', ["wires[2]", "did you mean 'force'?"]),
        ('from="spring.force"\nto="payload.forse"', ["wires[2]", "did you mean 'force'?"]),
        ('from="sprig.force"\nto="payload.force"', ["wires[2]", "did you mean 'spring'?"]),
        ('from="spring.force.value"\nto="payload.mass"', ["wires[2]", "parameter", ".start"]),
        ('from="payload.mass"\nto="spring.top.voltage"', ["wires[2]", "parameter"]),
        ('from="payload.force.value"\nto="spring.top.voltage"', ["wires[2]", "expected an output"]),
        ('from="payload.velocity"\nto="spring.force.value"', ["wires[2]", "expected an input"]),
        ('from="payload.displacement"\nto="spring.top.voltage"', ["m is not convertible to V"]),
        ('from="payload.motion"\nto="spring.top"', ["wires[2]", "share no member"]),
        ('from="spring"\nto="payload"', ["wires[2]", "no input '' in payload"]),
        ('from=""\nto="payload.force"', ["wires[2]", "no component ''"]),
        ('from="a\\u001b[31m"\nto="payload.force"', ["wires[2]", "a\\x1b"]),
    ],
    ids=label,
)
def test_bad_wire_is_named(wire: str, reasons: list[str], refuse: Refuse, desk: Path) -> None:
    held = '"spring.top.voltage" = "0 V"\n"spring.bottom.voltage" = "0 V"'
    (desk / "bad.toml").write_text(changed(HOLD, held) + TWO + f"[[wires]]\n{wire}")
    lines = [line for line in refuse("bad.toml") if "neither wired nor held" not in line]
    assert any(all(reason in line for reason in reasons) for line in lines), lines


def test_input_held_and_wired_is_refused(refuse: Refuse, desk: Path) -> None:
    (desk / "bad.toml").write_text(SCENARIO + TWO)
    lines = refuse("bad.toml")
    assert any("hold.payload.force.value: is wired too, by wires[0]" in line for line in lines)


def test_input_neither_wired_nor_held_is_refused(refuse: Refuse, desk: Path) -> None:
    (desk / "bad.toml").write_text(changed(HOLD, ""))
    (line,) = refuse("bad.toml")
    assert 'payload.force.value: neither wired nor held; wire it, or hold: "payload.force' in line
