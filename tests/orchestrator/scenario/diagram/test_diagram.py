"""Diagrams of scenarios: complete, literal, the same each time, and nothing on top of another."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import pytest
from lxml import etree

from orchestrator.errors import OutputError
from orchestrator.scenario.connections import Connection
from orchestrator.scenario.diagram.draw import draw
from orchestrator.scenario.diagram.layout import Sheet, Text, layout
from orchestrator.scenario.files import scenario_names
from orchestrator.scenario.plan import Plan
from orchestrator.simulation.load import load

STRANGE = "$x_ <script>alert('&')</script> $y^"
NAMESPACE = "{http://www.w3.org/2000/svg}"


def shown(path: Path) -> list[str]:
    """All texts of an SVG; fails where it is not well-formed."""
    root = etree.parse(path).getroot()
    assert root.tag == f"{NAMESPACE}svg"
    return ["".join(map(str, entry.itertext())) for entry in root.iter(f"{NAMESPACE}text")]


def renamed(plan: Plan, old: str, new: str) -> Plan:
    """The plan with another name for one of its components."""

    def name(text: str) -> str:
        return new if text == old else text

    return replace(
        plan,
        interfaces={name(key): value for key, value in plan.interfaces.items()},
        starts={name(key): value for key, value in plan.starts.items()},
        connections=[
            replace(c, source=name(c.source), target=name(c.target)) for c in plan.connections
        ],
        order=[name(key) for key in plan.order],
    )


def titled(plan: Plan, title: str) -> Plan:
    return replace(plan, scenario=plan.scenario.model_copy(update={"title": title}))


def crowd(plan: Plan, count: int = 12) -> Plan:
    """Copies of a scenario's components, wired forwards, backwards, far and to themselves."""
    names = [f"component_{k}" for k in range(count)]
    kinds = list(plan.interfaces.values())
    interfaces = {
        name: replace(kinds[k % len(kinds)], rollback=k % 3 > 0, variable_step=k % 4 > 0)
        for k, name in enumerate(names)
    }
    pairs = [(k, (k + step) % count) for k in range(count) for step in (0, 1, 3, 7, count - 1)]
    wires = [
        Connection(names[a], c.output, names[b], c.input, 1.0, 0.0)
        for a, b in pairs
        for c in plan.connections[: 2 + 9 * ((a + b) % 3)]
    ]
    held = {f"{name}.{v.name}": 0.5 for name in names[::2] for v in interfaces[name].of("input")}
    return replace(
        plan, interfaces=interfaces, order=names, connections=wires, held=held, starts={}
    )


def test_every_component_and_port_is_named(library: Path, tmp_path: Path) -> None:
    plan = load("oscillator-1", None, library)
    texts = shown(draw(plan, tmp_path / "scenario.svg"))
    assert plan.scenario.title in texts
    assert set(plan.order) <= set(texts)
    assert {plan.interfaces[name].path.name for name in plan.order} <= set(texts)
    assert {"1", "2", "3"} <= set(texts)
    for connection in plan.connections:
        assert any(text.startswith(f"{connection.input.port}: ") for text in texts)
    assert "command.top = 0 V" in texts
    assert any("60 per cycle of 51.8 Hz" in text for text in texts)


def test_wires_show_how_much_they_carry(library: Path, tmp_path: Path) -> None:
    for laws, label in (("curvature", "force: 1 value, 7 law members"), ("held", "force: 1 value")):
        plan = load("oscillator-1", None, library, master={"laws": laws})
        assert label in shown(draw(plan, tmp_path / "scenario.svg"))


def test_a_wire_between_unlike_ports_names_both(library: Path, tmp_path: Path) -> None:
    plan = load("oscillator-1", None, library)
    wire = next(c for c in plan.connections if c.output.name == "force.value")
    odd = replace(wire, output=replace(wire.output, name="push", port=""))
    texts = shown(draw(replace(plan, connections=[odd]), tmp_path / "scenario.svg"))
    assert "push → force: 1 value" in texts


def test_components_that_lack_an_ability_are_marked(library: Path, tmp_path: Path) -> None:
    plan = load("pull-test-L20", None, library)
    assert not any("no rollback" in text for text in shown(draw(plan, tmp_path / "able.svg")))
    unable = replace(plan.interfaces["rig"], rollback=False, variable_step=False)
    marked = replace(plan, interfaces={**plan.interfaces, "rig": unable})
    assert "no rollback, no variable step" in shown(draw(marked, tmp_path / "unable.svg"))


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_the_same_scenario_gives_the_same_bytes(library: Path, tmp_path: Path, suffix: str) -> None:
    plan = load("flapping-full-wings", None, library)
    first, second = (draw(plan, tmp_path / f"{name}{suffix}") for name in ("one", "two"))
    assert first.read_bytes() == second.read_bytes()


def test_a_png_is_one(library: Path, tmp_path: Path) -> None:
    path = draw(load("oscillator-1", None, library), tmp_path / "new" / "scenario.PNG")
    assert path.read_bytes().startswith(b"\x89PNG")


def test_strange_texts_are_shown_as_they_are(library: Path, tmp_path: Path) -> None:
    plan = titled(renamed(load("oscillator-1", None, library), "payload", STRANGE), STRANGE)
    path = draw(plan, tmp_path / "scenario.svg")
    assert shown(path).count(STRANGE) == 2
    assert "<script" not in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("title", "seen"),
    [("a\x00b\nc", r"a\x00b\x0ac"), ("\u202eabc", r"\u202eabc"), ("羽ばたき", "羽ばたき")],
)
def test_no_title_breaks_a_diagram(library: Path, tmp_path: Path, title: str, seen: str) -> None:
    """Controls and bidi marks are escaped; a script that the font lacks is not an error."""
    plan = titled(load("pull-test-L20", None, library), title)
    assert seen in shown(draw(plan, tmp_path / "scenario.svg"))
    draw(plan, tmp_path / "scenario.png")


def test_a_long_title_is_broken_and_an_empty_one_replaced(library: Path, tmp_path: Path) -> None:
    plan = load("pull-test-L20", None, library)
    long = " ".join(["words"] * 30)
    lines = shown(draw(titled(plan, long), tmp_path / "long.svg"))
    assert " ".join(text for text in lines if text.startswith("words")) == long
    assert plan.path.name in shown(draw(titled(plan, ""), tmp_path / "empty.svg"))


def test_one_component_without_wires(library: Path, tmp_path: Path) -> None:
    plan = load("oscillator-1", None, library)
    alone = replace(plan, order=["payload"], connections=[], held={})
    texts = shown(draw(alone, tmp_path / "scenario.svg"))
    assert "payload" in texts
    assert not any("at the right" in text for text in texts)


@pytest.mark.parametrize("name", ["scenario.pdf", "scenario", "folder.svg"])
def test_a_file_that_cannot_be_drawn_is_refused(library: Path, tmp_path: Path, name: str) -> None:
    (tmp_path / "folder.svg").mkdir()
    with pytest.raises(OutputError, match=name):
        draw(load("pull-test-L20", None, library), tmp_path / name)


Area = tuple[float, float, float, float]


def area(text: Text) -> Area:
    left = text.x - text.width * {"left": 0.0, "center": 0.5, "right": 1.0}[text.align]
    half = 0.4 * text.size / 72.0
    return left, left + text.width, text.y - half, text.y + half


def meet(a: Area, b: Area) -> bool:
    return a[0] < b[1] and b[0] < a[1] and a[2] < b[3] and b[2] < a[3]


def check_clear(sheet: Sheet) -> None:
    """No text on another, across the edge of a box, on a wire, or off the sheet."""
    texts = [(text.text, area(text)) for text in (*sheet.texts, *sheet.badges)]
    boxes = [(-b.width / 2, b.width / 2, b.top, b.top + b.height) for b in sheet.boxes]
    for (one, first), (other, second) in combinations(texts, 2):
        assert not meet(first, second), (one, other)
    for text, (left, right, top, bottom) in texts:
        low, high, above, below = sheet.extent
        assert low <= left and right <= high and above <= top and bottom <= below, text
        for box in boxes:
            inside = box[0] < left and right < box[1] and box[2] < top and bottom < box[3]
            assert inside or not meet((left, right, top, bottom), box), text
        for line in sheet.lines:
            for (x, y), (u, v) in zip(line.points, line.points[1:], strict=False):
                wire = (min(x, u) - 0.01, max(x, u) + 0.01, min(y, v) - 0.01, max(y, v) + 0.01)
                assert not meet((left, right, top, bottom), wire), text


@pytest.mark.parametrize("name", scenario_names())
def test_nothing_lies_on_anything_in_shipped_scenarios(library: Path, name: str) -> None:
    check_clear(layout(load(name, None, library)))


@pytest.mark.parametrize("count", [2, 5, 12])
def test_nothing_lies_on_anything_in_a_crowd(library: Path, tmp_path: Path, count: int) -> None:
    plan = crowd(load("flapping-full-wings", None, library), count)
    check_clear(layout(plan))
    assert set(plan.order) <= set(shown(draw(plan, tmp_path / "crowd.svg")))


def test_no_two_tracks_share_a_stretch(library: Path) -> None:
    """Routed wires that run along the same vertical do not touch there."""
    lines = layout(crowd(load("flapping-full-wings", None, library))).lines
    routed = [line.points[1:3] for line in lines if len(line.points) == 4]
    runs = [(min(a[1], b[1]), max(a[1], b[1]), a[0]) for a, b in routed]
    assert runs
    for (top, bottom, x), (high, low, u) in combinations(runs, 2):
        assert x != u or bottom < high or low < top
