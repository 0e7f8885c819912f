"""Places of the boxes, wires and texts of a diagram, in inches, y downwards."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any, Literal

from ...errors import printable
from ..connections import Connection
from ..plan import Plan

Align = Literal["left", "center", "right"]


SETTINGS: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "resilin",
    "font.family": ["DejaVu Sans", "sans-serif"],
}
MARGIN = 0.3
NARROWEST = 5.0
WIDEST = 8.0
"""Width up to which a title alone widens the sheet before it is broken."""
MOST_LINES = 10
"""Lines of one label, and held inputs of one component; those beyond are only counted."""
LONGEST = 40
LINE = 0.165
PITCH = 0.22
STUB = 0.4
PAIR = 0.16
"""Half the distance between the two directions of a pair of neighbours."""
BEND = -0.12
"""`rad` of arc3; with one sign for both directions, a pair bends apart."""
BADGE = 0.14
PAD = 0.1
SPACE = 0.35


TITLE, NAME, SMALL, LABEL = 12.0, 11.0, 8.0, 8.0


INK = "#1c2733"
EDGE = "#34567a"
FACE = "#eef3f9"
GREY = "#6b7480"
ALERT = "#a04a00"


WITH, AGAINST = "#1f6f5c", "#8a3b6b"
"""Colours of wires with the execution order, and against it."""


@dataclass(frozen=True)
class Arrow:
    """All wires from one component to another, by places in the order; a line for each port."""

    source: int
    target: int
    lines: tuple[str, ...]

    @property
    def first(self) -> int:
        """Place of the upper one of its two components."""
        return min(self.source, self.target)

    @property
    def span(self) -> int:
        """How many places it bridges; 0 for a component wired to itself."""
        return abs(self.target - self.source)

    @property
    def gap(self) -> int:
        """Gap that holds the label, counted from the component above it: the one by the source."""
        return self.source if self.target >= self.source else self.source - 1

    @property
    def colour(self) -> str:
        """Colour by the direction, as the side is."""
        return WITH if self.target >= self.source else AGAINST


@dataclass(frozen=True)
class Text:
    """One line of text, centred in height at y."""

    x: float
    y: float
    text: str
    size: float = LABEL
    align: Align = "left"
    colour: str = INK
    bold: bool = False

    @property
    def width(self) -> float:
        """Room it takes, with some to spare for viewers that lack the font."""
        from matplotlib.font_manager import FontProperties
        from matplotlib.textpath import text_to_path

        font = FontProperties(
            family=SETTINGS["font.family"],
            size=self.size,
            weight="bold" if self.bold else "normal",
        )
        points, _, _ = text_to_path.get_text_width_height_descent(self.text, font, ismath=False)
        return 1.05 * float(points) / 72.0


@dataclass(frozen=True)
class Box:
    """The box of one component: centre at x = 0."""

    top: float
    width: float
    height: float


@dataclass(frozen=True)
class Line:
    """A bent line between two points, or one through corners; the head is at the last."""

    points: tuple[tuple[float, float], ...]
    colour: str
    thick: float = 1.4
    bend: float = 0.0


@dataclass(frozen=True)
class Sheet:
    """All that is drawn, and the extent: left, right, top, bottom."""

    boxes: tuple[Box, ...]
    lines: tuple[Line, ...]
    badges: tuple[Text, ...]
    texts: tuple[Text, ...]
    extent: tuple[float, float, float, float]


def layout(plan: Plan) -> Sheet:
    """Places of all boxes, wires and texts of a scenario."""
    cards = [_card(plan, name, number) for number, name in enumerate(plan.order, 1)]
    held = [_held(plan, name) for name in plan.order]
    arrows = _arrows(plan)
    down = _tracks([a for a in arrows if a.span != 1 and a.target >= a.source])
    up = _tracks([a for a in arrows if a.span != 1 and a.target < a.source])
    rights = [_ends(down, [], k) for k in range(len(cards))]
    lefts = [_ends(up, held[k], k) for k in range(len(cards))]
    boxes = _boxes(cards, [max(map(len, pair)) for pair in zip(lefts, rights, strict=True)], arrows)
    near = [a for a in arrows if a.span == 1]
    lines, texts = _joined(near, boxes)
    stubs, values = _stubs(lefts, boxes)
    routes, words = _routed(down, rights, boxes, _reach([*texts, *values], boxes, 1.0), 1.0)
    returns, notes = _routed(up, lefts, boxes, _reach([*texts, *values], boxes, -1.0), -1.0)
    badges = []
    for card, box in zip(cards, boxes, strict=True):
        badge, *rest = _placed(card, box)
        badges.append(badge)
        texts += rest
    lines += stubs + routes + returns
    texts += values + words + notes
    extent, frame = _framed(plan, boxes, lines, texts)
    return Sheet(tuple(boxes), tuple(lines), tuple(badges), tuple(texts + frame), extent)


def _card(plan: Plan, name: str, number: int) -> list[Text]:
    """Texts of a component, top to bottom: its number, name, file, and what it cannot do."""
    interface = plan.interfaces[name]
    lacking = [] if interface.rollback else ["no rollback"]
    lacking += [] if interface.variable_step else ["no variable step"]
    card = [
        Text(0.0, 0.0, str(number), 8.5, "center", "white", bold=True),
        Text(0.0, 0.0, _cut(name), NAME, bold=True),
        Text(0.0, 0.0, _cut(interface.path.name), SMALL, colour=GREY),
    ]
    return card + [Text(0.0, 0.0, ", ".join(lacking), SMALL, colour=ALERT)] * bool(lacking)


def _cut(text: str) -> str:
    return printable(text, most=LONGEST)


def _arrows(plan: Plan) -> list[Arrow]:
    """Connections merged by the pair of components, and in it by the pair of ports."""
    place = {name: k for k, name in enumerate(plan.order)}
    pairs: dict[tuple[int, int], dict[tuple[str, str], list[Connection]]] = {}
    for c in plan.connections:
        ports = pairs.setdefault((place[c.source], place[c.target]), {})
        ends = (c.output.port or c.output.name, c.input.port or c.input.name)
        ports.setdefault(ends, []).append(c)
    return [
        Arrow(source, target, _few([_described(ends, group) for ends, group in ports.items()]))
        for (source, target), ports in sorted(pairs.items())
    ]


def _described(ends: tuple[str, str], group: list[Connection]) -> str:
    """Ports of a wire, and how many values and law members it carries."""
    source, target = (_cut(end) for end in ends)
    values = sum(c.input.order == 0 for c in group)
    laws = len(group) - values
    counts = [f"{values} value{'s' * (values != 1)}"] * bool(values)
    counts += [f"{laws} law member{'s' * (laws != 1)}"] * bool(laws)
    return f"{source if source == target else f'{source} → {target}'}: {', '.join(counts)}"


def _held(plan: Plan, name: str) -> list[str]:
    """Held inputs of a component with their values."""
    found = []
    for key, value in plan.held.items():
        component, _, variable = key.partition(".")
        if component == name:
            unit = plan.interfaces[name].variables[variable].unit
            shown = "" if unit == "1" else f" {_cut(unit)}"
            found.append(f"{_cut(variable)} = {value:g}{shown}".rstrip())
    return list(_few(found))


def _few(lines: list[str]) -> tuple[str, ...]:
    if len(lines) <= MOST_LINES:
        return tuple(lines)
    return (*lines[: MOST_LINES - 1], f"and {len(lines) - MOST_LINES + 1} more")


def _tracks(arrows: list[Arrow]) -> dict[Arrow, int]:
    """Track of each arrow, short ones inside; arrows in one track do not share a gap."""
    tracks: dict[Arrow, int] = {}
    taken: list[set[int]] = []
    for arrow in sorted(arrows, key=lambda a: (a.span, a.first)):
        gaps = set(range(arrow.first, arrow.first + max(1, arrow.span)))
        track = next((t for t, used in enumerate(taken) if not used & gaps), len(taken))
        if track == len(taken):
            taken.append(set())
        taken[track] |= gaps
        tracks[arrow] = track
    return tracks


def _ends(tracks: dict[Arrow, int], held: list[str], k: int) -> list[tuple[Arrow | str, bool]]:
    """What meets one side of component `k`, top to bottom; the flag is true where arrows start.

    Tracks from above come first, the inner before the outer, and those from below last, the
    outer before the inner, so that they cross least.
    """
    inner = sorted(tracks, key=lambda a: tracks[a])
    above = [(a, a.source == k) for a in inner if a.span and a.first + a.span == k]
    below = [(a, a.source == k) for a in reversed(inner) if a.span and a.first == k]
    own = [(a, start) for a in inner if not a.span and a.first == k for start in (True, False)]
    return [*above, *((text, False) for text in held), *own, *below]


def _boxes(cards: list[list[Text]], ends: list[int], arrows: list[Arrow]) -> list[Box]:
    """Boxes of one width below each other, with gaps that hold the labels."""
    width = max(text.width for card in cards for text in card[1:]) + 2.0 * (PAD + 2.0 * BADGE)
    width = max(1.7, width + 2.0 * PAD)
    lines = [
        max((len(a.lines) for a in arrows if a.gap == k), default=0) for k in range(len(cards))
    ]
    heights = [
        max(0.24 * len(card) - 0.02, PITCH * (count + 1))
        for card, count in zip(cards, ends, strict=True)
    ]
    spaces = [max(0.55, LINE * count + 0.3) for count in lines]
    tops = accumulate((h + s for h, s in zip(heights, spaces, strict=True)), initial=0.0)
    return [Box(top, width, height) for top, height in zip(tops, heights, strict=False)]


def _placed(card: list[Text], box: Box) -> list[Text]:
    """Texts of a card in its box: the number at the left, the lines beside it."""
    number, *lines = card
    middle = box.top + box.height / 2.0
    left = -box.width / 2.0 + PAD + BADGE
    start = middle - 0.2 * (len(lines) - 1) / 2.0
    return [
        replace(number, x=left, y=middle),
        *(replace(line, x=left + BADGE + PAD, y=start + 0.2 * k) for k, line in enumerate(lines)),
    ]


def _label(arrow: Arrow, boxes: list[Box], x: float, sign: float) -> list[Text]:
    """Lines of an arrow's label in its gap, growing away from x."""
    box = boxes[arrow.gap]
    top = box.top + box.height
    last = arrow.gap + 1 == len(boxes)
    middle = (
        top + 0.1 + LINE * len(arrow.lines) / 2.0
        if last
        else (top + boxes[arrow.gap + 1].top) / 2.0
    )
    start = middle - LINE * (len(arrow.lines) - 1) / 2.0
    align: Align = "left" if sign > 0.0 else "right"
    return [
        Text(x, start + LINE * k, line, LABEL, align, arrow.colour)
        for k, line in enumerate(arrow.lines)
    ]


def _joined(near: list[Arrow], boxes: list[Box]) -> tuple[list[Line], list[Text]]:
    """Arrows between neighbours, down at the right and up at the left, labels outside."""
    lines: list[Line] = []
    texts: list[Text] = []
    for arrow in near:
        sign = 1.0 if arrow.target > arrow.source else -1.0
        upper, lower = boxes[arrow.first], boxes[arrow.first + 1]
        ends = ((sign * PAIR, upper.top + upper.height), (sign * PAIR, lower.top))
        lines.append(Line(ends if sign > 0.0 else ends[::-1], arrow.colour, bend=BEND))
        bulge = abs(BEND) * (lower.top - ends[0][1]) / 2.0
        texts += _label(arrow, boxes, sign * (PAIR + bulge + PAD), sign)
    return lines, texts


def _height(box: Box, ends: int, place: int) -> float:
    """Where the end number `place` of those at one side meets a box."""
    return box.top + box.height * (place + 1) / (ends + 1)


def _stubs(
    lefts: list[list[tuple[Arrow | str, bool]]], boxes: list[Box]
) -> tuple[list[Line], list[Text]]:
    """Held inputs: a short arrow into the component, and the value that it carries."""
    lines: list[Line] = []
    texts: list[Text] = []
    for box, ends in zip(boxes, lefts, strict=True):
        edge = -box.width / 2.0
        for place, (end, _) in enumerate(ends):
            if isinstance(end, str):
                y = _height(box, len(ends), place)
                lines.append(Line(((edge - STUB, y), (edge, y)), GREY, 0.9))
                texts.append(Text(edge - STUB - 0.06, y, end, SMALL, "right", GREY))
    return lines, texts


def _reach(texts: list[Text], boxes: list[Box], sign: float) -> float:
    """How far out from the middle a side is taken."""
    ends = [abs(t.x) + t.width for t in texts if t.align == ("left" if sign > 0.0 else "right")]
    return max([boxes[0].width / 2.0, *ends])


def _routed(
    tracks: dict[Arrow, int],
    sides: list[list[tuple[Arrow | str, bool]]],
    boxes: list[Box],
    reach: float,
    sign: float,
) -> tuple[list[Line], list[Text]]:
    """Arrows around other components: out of a side, along a track, and in again."""
    count = max(tracks.values(), default=-1) + 1
    room = [0.0] * count
    for arrow, track in tracks.items():
        widths = (text.width for text in _label(arrow, boxes, 0.0, sign))
        room[track] = max(room[track], *widths)
    out = list(accumulate((width + PAD + SPACE for width in room), initial=reach + SPACE))
    lines: list[Line] = []
    texts: list[Text] = []
    for arrow, track in tracks.items():
        x, edge = sign * out[track], sign * boxes[0].width / 2.0
        leaves, enters = (
            _height(boxes[k], len(sides[k]), sides[k].index((arrow, start)))
            for k, start in ((arrow.source, True), (arrow.target, False))
        )
        lines.append(Line(((edge, leaves), (x, leaves), (x, enters), (edge, enters)), arrow.colour))
        texts += _label(arrow, boxes, x + sign * PAD, sign)
    return lines, texts


def _framed(
    plan: Plan, boxes: list[Box], lines: list[Line], texts: list[Text]
) -> tuple[tuple[float, float, float, float], list[Text]]:
    """Extent of the sheet; the title above, the time and the order below."""
    spans = [(t.x, t.x + t.width) for t in texts if t.align == "left"]
    spans += [(t.x - t.width, t.x) for t in texts if t.align == "right"]
    spans += [(x, x) for line in lines for x, _ in line.points]
    half = boxes[0].width / 2.0
    left = min([-half, *(low for low, _ in spans)])
    right = max([half, *(high for _, high in spans)])
    below = [Text(0.0, 0.0, words, SMALL, "center", GREY) for words in _footer(plan, lines)]
    heading = _heading(plan)
    widest = max([NARROWEST, min(heading.width, WIDEST), *(text.width for text in below)])
    spare = max(0.0, widest - (right - left)) / 2.0
    left, right = left - spare, right + spare
    middle = (left + right) / 2.0
    title = _broken(heading, right - left)
    top = -0.15 - 0.24 * len(title)
    low = max([boxes[-1].top + boxes[-1].height, *(text.y + LINE / 2.0 for text in texts)]) + 0.4
    frame = [replace(text, x=middle, y=top + 0.24 * k) for k, text in enumerate(title)]
    frame += [replace(text, x=middle, y=low + 0.19 * k) for k, text in enumerate(below)]
    bottom = low + 0.19 * (len(below) - 1) + MARGIN
    return (left - MARGIN, right + MARGIN, top - MARGIN, bottom), frame


def _heading(plan: Plan) -> Text:
    """The scenario's title, else the name of its file."""
    words = printable(plan.scenario.title.strip() or plan.path.name)
    return Text(0.0, 0.0, words, TITLE, "center", bold=True)


def _broken(text: Text, width: float) -> list[Text]:
    """A centred text in as few lines of about the same length as fit into a width."""
    lines = [text]
    for count in range(1, len(text.text)):
        if max(line.width for line in lines) <= 1.001 * width:
            break
        letters = len(text.text) // (count + 1) + 5
        words = textwrap.wrap(text.text, letters, break_on_hyphens=False)
        lines = [replace(text, text=line) for line in words]
    return lines


def _footer(plan: Plan, lines: list[Line]) -> list[str]:
    """When the components communicate, and how to read the sides."""
    grid = plan.grid
    step = f"communication step {grid.step:.6g} s"
    if plan.frequency:
        step += f", {1.0 / (plan.frequency * grid.step):.4g} per cycle of {plan.frequency:.6g} Hz"
    footer = [f"{step}; {grid.start:.6g} s to {grid.stop:.6g} s in {grid.count} steps"]
    if any(line.colour == AGAINST for line in lines):
        footer.append(
            "numbers: execution order; wires with it at the right, against it at the left"
        )
    return footer
