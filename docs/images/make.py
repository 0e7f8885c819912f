"""The pictures of the README and of the pages beside it, each from runs of the built parts.

    python docs/images/make.py            all of them
    python docs/images/make.py vehicle    one of: vehicle, wiring, steps

`vehicle` draws the mechanism to scale in the pose of a recorded point, with the parts that compute
it, the ports between them and the stroke of the same run. `wiring` is the diagram of
`resilin inspect`. `steps` is the error of the motion over the step, with and without laws.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np

from orchestrator.results.outcome import Outcome
from orchestrator.scenario.plan import LIBRARY, Plan
from orchestrator.studies.paper.figure4 import POINTS, outline
from orchestrator.studies.paper.linkage_pose import joints, links
from orchestrator.studies.paper.published_values import given, number
from orchestrator.studies.reference.monolith import as_recorded, monolithic
from resilin import load, run

mpl.use("Agg")
from matplotlib import pyplot
from matplotlib.patches import FancyBboxPatch

HERE = Path(__file__).resolve().parent
SCENARIO = "flapping-full-wings"
SHAPES = "flapping-shapes"
"""The same vehicle with the shapes of both cones recorded."""

CYCLES = 30
FRAME = -17.0
"""Height of the frames' plane below the cranks' pivots [mm]; assumed, the paper prints none."""
INNER = 1.3
"""Inner radius of the cones [mm]; see fmus/membrane/materials.toml."""

INK, FAINT = "#1f2933", "#9aa5b1"
BLUE, ORANGE, GREEN, RED, VIOLET = "#2563a8", "#c2410c", "#2f7d4f", "#b4232c", "#6b46a8"

mpl.rcParams.update(
    {
        "font.family": "DejaVu Sans",
        "font.size": 10,
        "text.color": INK,
        "axes.edgecolor": FAINT,
        "axes.labelcolor": INK,
        "xtick.color": INK,
        "ytick.color": INK,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "svg.hashsalt": "resilin",
        "figure.facecolor": "white",
    }
)


def saved(figure: Any, name: str) -> None:
    """Write a figure as SVG with an opaque background, the same bytes for the same figure."""
    figure.savefig(HERE / f"{name}.svg", metadata={"Date": None, "Creator": None})
    pyplot.close(figure)


def actuator_of(outcome: Outcome) -> str:
    """Name of the component whose force drives the linkage."""
    to_linkage = (c for c in outcome.plan.connections if c.target == "linkage")
    return next(c.source for c in to_linkage if c.output.name.startswith("force."))


def vehicle() -> None:
    """Mechanism, parts and ports, and the stroke, from one run."""
    outcome = run(load(SHAPES, time={"stop": f"{CYCLES} cycles"}))
    if outcome.failure is not None:
        raise outcome.failure
    figure = pyplot.figure(figsize=(10.0, 4.9))
    left = figure.add_axes((0.005, 0.01, 0.635, 0.98))
    drawn(left, outcome)
    stroke(figure, outcome)
    saved(figure, "vehicle")


def drawn(axes: Any, outcome: Outcome) -> None:
    """The vehicle from the front in the pose of the highest wings of the last cycle."""
    axes.set(xlim=(-68.0, 68.0), ylim=(-57.0, 46.0), aspect="equal")
    axes.axis("off")
    last = last_cycle(outcome)
    k = last.start + int(np.argmin(outcome.series("linkage.flap_angle")[last]))
    film(axes, outcome, k)
    mechanism(axes, outcome, k)
    ports(axes, actuator_of(outcome))


def last_cycle(outcome: Outcome) -> slice:
    """Rows of the last cycle."""
    frequency = outcome.plan.frequency or 1.0
    first = int(np.searchsorted(outcome.times, outcome.times[-1] - 1.0 / frequency))
    return slice(first, len(outcome.times))


def film(axes: Any, outcome: Outcome, k: int) -> None:
    """Both cones in section; the one under voltage in full colour."""
    outer, half = 1e3 * float(given("outer_radius")), 0.5e3 * float(given("spacer"))
    place = 1e3 * float(outcome.series("linkage.displacement")[k])
    for cone, sign in (("top", 1.0), ("bottom", -1.0)):
        radii, axial = (
            np.array(
                [
                    1e3 * float(outcome.series(f"profile.{cone}_shape.{way}_{n + 1}")[k])
                    for n in range(POINTS)
                ]
            )
            for way in ("radius", "axial")
        )
        r, z = outline(radii, axial, (INNER, sign * half + place), outer, 30)
        charged = float(outcome.series(f"amplifier.{cone}.voltage")[k]) / float(given("drive"))
        for side in (-1.0, 1.0):
            axes.plot(side * r, FRAME + z, color=ORANGE, lw=3.2, alpha=0.4 + 0.6 * charged)
    for side in (-1.0, 1.0):
        x = [side * outer, side * (outer + 3.0)]
        axes.plot(x, [FRAME, FRAME], color=INK, lw=5, solid_capstyle="butt")


def mechanism(axes: Any, outcome: Outcome, k: int) -> None:
    """Rod, links and wings of both sides."""
    sizes = links()
    place = np.array([float(outcome.series("linkage.displacement")[k])])
    angle = np.array([float(outcome.series("linkage.flap_angle")[k])])
    at = {
        name: (1e3 * (float(x[0]) + sizes.crank), 1e3 * float(y[0]))
        for name, (x, y) in joints(sizes, place, angle).items()
    }
    half = 0.5e3 * float(given("spacer"))
    foot = FRAME - half + 1e3 * float(place[0])
    axes.plot([0.0, 0.0], [foot, at["slider"][1]], color=INK, lw=4, solid_capstyle="round")
    length = 1e3 * float(given("wing_length"))
    root, down = np.array(at["root"]), -float(angle[0])
    along = length * np.array([np.cos(down), np.sin(down)])
    tip = root + along
    for side in (-1.0, 1.0):
        for names in (("slider", "crank"), ("crank", "pivot", "arm"), ("arm", "rocker"),
                      ("rocker", "root")):  # fmt: skip
            x = [side * at[name][0] for name in names]
            axes.plot(x, [at[n][1] for n in names], color=BLUE, lw=2.6, solid_capstyle="round")
        for name in ("slider", "crank", "arm", "rocker"):
            axes.plot(side * at[name][0], at[name][1], "o", color="white", mec=BLUE, ms=4.5)
        for name in ("pivot", "root"):
            axes.plot(side * at[name][0], at[name][1], "^", color=INK, ms=6)
        axes.plot([side * root[0], side * tip[0]], [root[1], tip[1]], color=GREEN, lw=3.4)
        bend = f"arc3,rad={-0.22 * side * np.sign(down)}"
        axes.annotate("", (side * tip[0], -tip[1] + 2 * root[1]), (side * tip[0], tip[1]),
                      arrowprops={"arrowstyle": "<->", "color": GREEN, "lw": 1.2,
                                  "connectionstyle": bend})  # fmt: skip


WIDTH, HEIGHT, LEVEL = 24.0, 13.0, -47.0
"""Size of a part's box and the height of the row of boxes [mm]."""
PLACES = (-55.5, -18.5, 18.5, 55.5)


def ports(axes: Any, actuator: str) -> None:
    """The four parts in a row, lines to what each computes, and the ports between them."""
    top = LEVEL + 0.5 * HEIGHT
    boxes = (
        ("amplifier", "drive, electrodes", RED),
        (actuator, "film, double cone", ORANGE),
        ("linkage", "slider, links, wings", BLUE),
        ("aero", "load of the air", GREEN),
    )
    for x, (name, words, colour) in zip(PLACES, boxes, strict=True):
        corner = (x - 0.5 * WIDTH, LEVEL - 0.5 * HEIGHT)
        axes.add_patch(FancyBboxPatch(corner, WIDTH, HEIGHT, boxstyle="round,pad=0,rounding_size=2",
                                      fc="white", ec=colour, lw=1.5, zorder=4))  # fmt: skip
        centred = {"ha": "center", "va": "center", "zorder": 5}
        axes.text(x, LEVEL + 2.6, name, color=colour, weight="bold", fontsize=10.5, **centred)
        axes.text(x, LEVEL - 2.8, words, fontsize=8, **centred)
    for place, level, colour in ((0.0, FRAME + 3.2, RED), (-4.0, FRAME - 3.2, FAINT)):
        x = PLACES[0] + place
        axes.plot([x, x, -8.0], [top, level, level], color=colour, lw=1.2, zorder=1)
    for line, colour in (
        (((PLACES[1], top), (PLACES[1], -29.0), (-4.0, FRAME - 5.0)), ORANGE),
        (((PLACES[2], top), (PLACES[2], 6.5)), BLUE),
        (((PLACES[3], top), (PLACES[3], -28.0), (44.0, 18.0)), GREEN),
    ):
        axes.plot(*zip(*line, strict=True), color=colour, lw=1.0, ls=(0, (1, 2)), zorder=1)
    for first, there, back in ((0, "voltage", "charge"), (1, "force", "motion"),
                               (2, "motion", "load")):  # fmt: skip
        start, end = PLACES[first] + 0.5 * WIDTH, PLACES[first + 1] - 0.5 * WIDTH
        for height, words, ends in ((2.2, there, (start, end)), (-2.2, back, (end, start))):
            arrow(axes, LEVEL + height, words, *ends)


def arrow(axes: Any, level: float, words: str, start: float, end: float) -> None:
    """A port from one part to the next, its name above or below."""
    axes.annotate("", (end, level), (start, level),
                  arrowprops={"arrowstyle": "-|>", "color": VIOLET, "lw": 1.3,
                              "shrinkA": 1, "shrinkB": 1})  # fmt: skip
    away = 3.0 if level > LEVEL else -3.0
    axes.text(0.5 * (start + end), level + away, words, ha="center", va="center", color=VIOLET,
              fontsize=9, style="italic")  # fmt: skip


def stroke(figure: Any, outcome: Outcome) -> None:
    """Voltages and flap angle over the last three cycles, with the stroke marked."""
    frequency = outcome.plan.frequency or 1.0
    begin = outcome.times[-1] - 3.0 / frequency
    shown = outcome.times >= begin - 1e-9
    time = 1e3 * (outcome.times[shown] - begin)
    above = figure.add_axes((0.72, 0.765, 0.26, 0.155))
    for cone, colour in (("top", RED), ("bottom", FAINT)):
        above.plot(time, 1e-3 * outcome.series(f"amplifier.{cone}.voltage")[shown], color=colour)
    above.set(ylabel="kV", xticks=[], xlim=(0.0, time[-1]), yticks=[0.0, 2.0])
    above.set_title("voltage of the top and the bottom cone", fontsize=9, loc="left", pad=5)
    below = figure.add_axes((0.72, 0.125, 0.26, 0.535))
    angle = np.degrees(outcome.series("linkage.flap_angle")[shown])
    below.plot(time, angle, color=GREEN, lw=2.0)
    low, high = float(angle.min()), float(angle.max())
    measured = float(number("figure11.full_wings_stroke").value)
    at = time[int(np.argmax(angle))]
    for level in (low, high):
        below.axhline(level, color=FAINT, lw=0.8, ls=":")
    below.annotate("", (at, low), (at, high), arrowprops={"arrowstyle": "<->", "color": INK})
    below.text(at, 0.5 * (low + high), f"{high - low:.1f}°", ha="center", va="center",
               fontsize=12, weight="bold", bbox={"fc": "white", "ec": "none"})  # fmt: skip
    below.set(xlabel="time (ms)", ylabel="flap angle (°)", xlim=(0.0, time[-1]))
    below.set_title(f"stroke at {frequency:g} Hz; measured: {measured:g}°", fontsize=9,
                    loc="left", pad=5)  # fmt: skip


def wiring() -> None:
    """The diagram of the command line."""
    command = [sys.executable, "-m", "orchestrator.cli", "inspect", SCENARIO, "--output"]
    subprocess.run([*command, HERE / "wiring.svg"], check=True, stdout=subprocess.DEVNULL)


LADDER = (20, 50, 100, 200, 400)
TRAVEL = "linkage.displacement"


def steps() -> None:
    """Largest error of the slider's travel over its largest value, against one ODE at 1e-10."""
    plan = setting("curvature", LADDER[-1])
    exact = as_recorded(run(monolithic(plan, LIBRARY)), plan).series(TRAVEL)
    figure, axes = pyplot.subplots(figsize=(6.4, 3.6))
    for laws, words, colour in (
        ("held", "plain numbers", RED),
        ("affine", "laws, without curvature", BLUE),
        ("curvature", "laws", GREEN),
    ):
        errors = [error(laws, count, exact) for count in LADDER]
        axes.loglog(LADDER, errors, "o-", color=colour)
        behind = {"fc": "white", "ec": "none", "pad": 1}
        axes.annotate(words, (LADDER[-1], errors[-1]), (8, 0), textcoords="offset points",
                      color=colour, va="center", bbox=behind)  # fmt: skip
    axes.axhline(1e-3, color=INK, lw=0.8, ls=":")
    axes.set_xticks(LADDER, [str(count) for count in LADDER])
    axes.minorticks_off()
    axes.set(xlabel="communication steps per cycle", ylabel="error of the travel", xlim=(17, 1900))
    axes.set_title(f"{SCENARIO}, gauss-seidel, 10 cycles", fontsize=10, loc="left")
    figure.tight_layout()
    saved(figure, "steps")


def setting(laws: str, count: int) -> Plan:
    """The scenario with so much of each port connected, at so many steps per cycle."""
    time = {"stop": "10 cycles", "step": {"per_cycle": count}}
    return load(SCENARIO, time=time, master={"laws": laws, "kind": "gauss-seidel"})


def error(laws: str, count: int, exact: Any) -> float:
    """Error of one setting; `exact` holds the travel at the finest step's points."""
    mine = run(setting(laws, count)).series(TRAVEL)
    there = exact[:: LADDER[-1] // count]
    return float(np.abs(mine - there).max() / np.abs(exact).max())


PICTURES: dict[str, Callable[[], None]] = {"vehicle": vehicle, "wiring": wiring, "steps": steps}

if __name__ == "__main__":
    for chosen in sys.argv[1:] or PICTURES:
        if chosen not in PICTURES:
            raise SystemExit(f"no picture {chosen!r}; there is {', '.join(PICTURES)}")
        PICTURES[chosen]()
        print(HERE / f"{chosen}.svg")
