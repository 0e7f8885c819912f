"""Which texts are metrics, and what is wrong with others."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.errors import ScenarioError
from orchestrator.scenario.files import read_toml, scenario_names, scenario_path
from orchestrator.scenario.metric_expression import expression_of, unit_of
from orchestrator.scenario.parse import scenario_of
from orchestrator.simulation.load import load
from orchestrator.units import UnitError


def test_variables_are_found_whole() -> None:
    text = 'max(a.b.c, "tank.der(x)") - mean(x.y[1,2]) * rate(a.b) in deg'
    expression = expression_of(text)
    assert expression.variables == ("a.b.c", "tank.der(x)", "x.y[1,2]", "a.b")
    assert expression.unit == "deg"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("linkage.flap_angle", "is a series over time and not one number"),
        ("maxi(a.b)", "did you mean 'max'?"),
        ("mean(a.b, c.d)", "mean takes 1 argument"),
        ("phase(a.b)", "phase takes 2 arguments"),
        ("max(3)", "is not a variable over time"),
        ("max(a.b", "cannot be read"),
        ("__import__('os').system('x')", "is not a variable"),
        ("max(a.b for a in b)", "cannot be read"),
        ("max(a.b for a in b if a)", "is not a variable"),
        ("max(a.b) if 1 else 2", "is not a variable"),
        ("max(a.b) + True", "is not a number"),
        ("max(a.b)" + " + 1" * 200, "longer than 500 characters"),
    ],
)
def test_what_is_not_a_metric_is_refused(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason.replace("?", r"\?").replace("(", r"\(")):
        expression_of(text)


def test_units_follow_from_the_variables() -> None:
    units = {"a.b": "m", "c.d": ""}
    assert unit_of(expression_of("max(a.b)"), units) == "m"
    assert unit_of(expression_of("max(a.b) in mm"), units) == "mm"
    assert unit_of(expression_of("rate(a.b)"), units) == "m/s"
    assert unit_of(expression_of("frequency(a.b)"), units) == "Hz"
    assert unit_of(expression_of("max(a.b) * max(a.b)"), units) == "1"
    assert unit_of(expression_of("last(c.d)"), units) == "1"
    with pytest.raises(UnitError):
        unit_of(expression_of("max(a.b) in deg"), units)
    with pytest.raises(UnitError):
        unit_of(expression_of("max(a.b) + 1 in bananas"), units)


@pytest.mark.parametrize(
    ("metrics", "reason"),
    [
        ({"x": "max(payload.displacment)"}, "did you mean 'payload.displacement'?"),
        ({"x": "max(payload.displacement) in deg"}, "not convertible"),
        ({"x": "payload.displacement"}, "apply one of"),
        ({"x": 5}, "metrics.x: "),
    ],
)
def test_a_scenario_with_a_wrong_metric_is_refused(
    library: Path, metrics: dict[str, object], reason: str
) -> None:
    from orchestrator.scenario.plan import check

    path = scenario_path("oscillator-1")
    tree = {**read_toml(path), "metrics": metrics}
    with pytest.raises(ScenarioError) as caught:
        check(scenario_of(tree, path), path, library)
    assert reason in str(caught.value)


def test_a_component_left_out_drops_its_metrics(library: Path) -> None:
    path = scenario_path("flapping-full-wings")
    tree = {
        "extends": "flapping-full-wings",
        "without": ["aero"],
        "hold": {"linkage.load.torque": "0 N*m"},
    }
    scenario = scenario_of(tree, path.with_name("new.toml"))
    assert "mean lift" not in scenario.metrics.defined
    assert "flapping stroke" in scenario.metrics.defined


@pytest.mark.parametrize("name", scenario_names())
def test_every_shipped_scenario_defines_metrics(library: Path, name: str) -> None:
    assert load(name, None, library).scenario.metrics.defined
