"""Scenarios that extend others wrongly."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.orchestrator.good_scenario import SCENARIO, Refuse, label


@pytest.mark.parametrize(
    ("base", "top", "reason"),
    [
        (SCENARIO, 'extends = "bad.toml"', "extends itself: bad.toml -> bad.toml"),
        ('extends = "bad.toml"', 'extends = "base.toml"', "extends itself: bad.toml -> base.toml"),
        (SCENARIO, "extends = 3", "extends: "),
        (SCENARIO, 'extends = "bsae.toml"', "bsae.toml: no such scenario file"),
        (SCENARIO, 'extends = "oscilator-1"', "did you mean 'oscillator-1'?"),
        (SCENARIO, 'extends = "a\\u001b[31m.toml"', "a\\x1b"),
        (SCENARIO, 'extends = "a\\u0000.toml"', "no such scenario file"),
        (SCENARIO, f'extends = "{"n" * 300}.toml"', "nnn"),
        (SCENARIO, 'extends = "base.toml"\nwithout = ["paylod"]', "without: no component 'paylod'"),
        (SCENARIO, 'extends = "base.toml"\nwithout = "payload"', "without: expected a list"),
        (SCENARIO, 'extends = "base.toml"\nwithout = [["payload"]]', "without"),
        (SCENARIO, 'extends = "base.toml"\nwithout = [1]', "without"),
        (SCENARIO, SCENARIO.join(['without = ["payload"]\n', ""]), "without: "),
        (SCENARIO, 'extends = "base.toml"\nwires = 3', "wires: "),
        (SCENARIO, 'extends = "base.toml"\nwires = [3]', "wires"),
        ("hold = 3", 'extends = "base.toml"\nwires = []', "hold: "),
        ("components = 3", 'extends = "base.toml"\nwithout = ["payload"]', "components: "),
        ("wires = [3]\n" + SCENARIO, 'extends="base.toml"\nwithout=["payload"]', "wires"),
        ("wires = 3\n" + SCENARIO, 'extends="base.toml"\nwithout=["payload"]', "wires: "),
        ("record = 3\n" + SCENARIO, 'extends="base.toml"\nwithout=["payload"]', "record: "),
        (
            "record.variables = [3]\n" + SCENARIO,
            'extends="base.toml"\nwithout=["payload"]',
            "record.",
        ),
        ("a." * 3000 + "x = 1", 'extends = "base.toml"\n' + "a." * 3000 + "y = 1", ""),
    ],
    ids=label,
)
def test_bad_extension_is_refused(
    base: str, top: str, reason: str, refuse: Refuse, desk: Path
) -> None:
    (desk / "base.toml").write_text(base)
    (desk / "bad.toml").write_text(top)
    assert any(reason in line for line in refuse("bad.toml"))
