"""Settings of a scenario as texts by name."""

from __future__ import annotations

import pytest

from orchestrator.scenario.settings import given, settings_of

SCENARIO = {
    "title": "Two masses",
    "time": {"stop": "2 s", "step": {"per_cycle": 40}, "tolerance": None},
    "components": {"mass": {"fmu": "mass", "start": {"mass": "3 g", "free": True}}},
    "wires": [{"from": "a.b", "to": "c.d", "gain": 2.0, "offset": 0.0}],
    "hold": {"mass.force": "1 N"},
    "plot": {"Place": "mass.*"},
}


def test_settings_are_named_like_options() -> None:
    assert settings_of(SCENARIO) == {
        "mass.mass": "3 g", "mass.free": "true", "components.mass.fmu": "mass",
        "wire a.b to c.d": "gain 2.0, offset 0.0", "time.stop": "2 s",
        "time.step": "40 per cycle", "hold.mass.force": "1 N",
    }  # fmt: skip
    assert given({"mass.mass": "4 g"}, {"time": {"step": {"per_cycle": 50}}}) == {
        "mass.mass": "4 g", "time.step": "50 per cycle",
    }  # fmt: skip


@pytest.mark.parametrize("key", ["components", "wires", "time", "hold"])
def test_of_a_damaged_scenario_the_rest_is_read(key: str) -> None:
    for damaged in (None, 7, [7], {"mass": 7}):
        assert isinstance(settings_of({**SCENARIO, key: damaged}), dict)
