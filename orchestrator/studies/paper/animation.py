"""The vehicle: one settled cycle of it with full wings, from the recorded run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ...report.animation import Animation, Body, Kind, Label, View
from ...report.plot import Axis, Curve, Plot
from .cached_runs import CachedRuns
from .comparison import Comparison
from .figure4 import outline, points
from .job import Answer, Job
from .linkage_pose import joints, links
from .published_values import given, number

Values = NDArray[np.float64]
Line = tuple[Values, Values]

INNER = 1.3e-3
"""Inner radius of the cones [m]; calibrated on table 2, see fmus/membrane/materials.toml."""

FRAME = -14e-3
"""Height of the frames' plane below the cranks' pivots [m]; assumed, the paper prints none."""

TITLE = "The vehicle"
HOW = (
    "The last cycle that the run of flapping-shapes recorded, to scale: cones, spacer, rod and"
    " links in section, wings from the front. The cones are the film's own equilibrium at the"
    " recorded voltages and displacement; fuller colour is higher voltage. The wing's chord is seen"
    " as far as feathering turns it into view; a positive angle is down. Which link is which, and"
    " how far the actuator sits below the linkage, are inferred."
)
VEHICLE = (
    Label("wing", (44.0, 30.0), "wing", (0, 1, 2, 3)),
    Label("linkage", (0.0, 24.0), "left coupler", (0, 1)),
    Label("film", (28.0, -27.0), "bottom cone", (19,)),
    Label("spacer", (-27.0, -23.0), "spacer", (0, 1)),
)
CLOSE = (
    Label("slider", (-7.0, 11.5), "slider", (0,)),
    Label("conrod", (-8.5, 6.5), "conrod", (0, 1)),
    Label("rod", (-7.0, -4.0), "rod", (0, 1)),
    Label("bell crank", (13.0, -0.5), "bell crank", (1, 2)),
    Label("coupler", (13.0, 12.5), "coupler", (0, 1)),
    Label("rocker", (25.0, 12.5), "rocker joint", (0,)),
    Label("to the wing", (23.0, -2.0), "root", (0,)),
    Label("top film", (14.0, -6.0), "top cone", (17,)),
    Label("bottom film", (15.0, -22.0), "bottom cone", (18,)),
    Label("frame", (22.0, -17.5), "right frame", (0, 1)),
    Label("spacer", (-12.0, -22.0), "spacer", (0, 1)),
)
"""Places of names, in millimetres from the linkage's middle, clear of what moves."""

KEPT = (
    "linkage.displacement", "linkage.velocity", "linkage.flap_angle", "linkage.flap_rate",
    "aero.angle_of_attack", "amplifier.*.voltage", "amplifier.supplied_energy",
    "actuator.force.value", "profile.*_shape.*",
)  # fmt: skip


def flight(cached_runs: CachedRuns) -> Comparison:
    """One run of `flapping-shapes`; its last cycle as frames."""
    frequency = float(number("figure11.full_wings_frequency").value)
    changes = {"amplifier.frequency": f"{frequency!r} Hz"}
    job = Job("flapping-shapes", changes, keep=KEPT, length=60, per_cycle=120, cycles=1)
    (answer,) = cached_runs.answers([job])
    if answer.status != "done":
        return Comparison("animation", TITLE, (), (), (), [f"{job.scenario}: {answer.reason}"])
    words = (_told(answer, frequency), HOW)
    return Comparison("animation", TITLE, words, (), extras=[_film(answer, frequency)])


def _told(answer: Answer, frequency: float) -> str:
    """What the vehicle is, in three sentences, with what it does in this run."""
    wing, spacer, drive = (float(given(name)) for name in ("wing_length", "spacer", "drive"))
    travel = float(np.ptp(answer.series("linkage.displacement")))
    stroke = math.degrees(float(np.ptp(answer.series("flap_angle"))))
    return (
        f"A micro air vehicle with two flapping wings of {1e3 * wing:g} mm, driven at resonance by"
        " a dielectric elastomer instead of a motor with gears. Its actuator is two cones of"
        f" silicone film in a frame, which a spacer of {1e3 * spacer:g} mm keeps taut:"
        f" {1e-3 * drive:g} kV slackens one of them, the other pulls, and the rod on the"
        f" spacer travels {1e3 * travel:.1f} mm. The linkage turns this into a wing stroke of"
        f" {stroke:.0f} degrees at {frequency:g} Hz."
    )


def _film(answer: Answer, frequency: float) -> Animation:
    middle, right = _actuator(answer), _links(answer)
    wings = _wing(answer)
    whole = [*middle, *wings, *right, *map(_mirrored, [*wings, *right])]
    views = [
        View("Vehicle", (-66.0, -35.0, 66.0, 35.0), whole, VEHICLE),
        View("Linkage and actuator", (-17.0, -26.0, 29.0, 15.0), [*middle, *right], CLOSE),
    ]
    return Animation(
        "animation",
        f"One cycle at {frequency:g} Hz.",
        "On the slider of time, arrow keys go by frames.",
        answer.times.tolist(),
        views,
        list(_strips(answer)),
    )


def _shown(name: str, kind: Kind, lines: Iterable[Line], level: Sequence[float] = ()) -> Body:
    """A body of outlines in metres, one for each frame."""
    every = list(lines)
    return Body(
        name=name,
        kind=kind,
        x=[(1e3 * x).tolist() for x, _ in every],
        y=[(1e3 * y).tolist() for _, y in every],
        level=level,
    )


def _mirrored(body: Body) -> Body:
    x = [[-x for x in frame] for frame in body.x]
    return Body(f"left {body.name}", body.kind, x, body.y, body.level)


def _actuator(answer: Answer) -> list[Body]:
    """Both cones in section, the frames, the spacer, and the rod that carries the slider."""
    outer, half = float(given("outer_radius")), 0.5 * float(given("spacer"))
    place = answer.series("linkage.displacement")
    count = len(place)

    def cone(name: str, sign: float) -> Iterator[Line]:
        for k in range(count):
            rim = (INNER, sign * half + float(place[k]))
            r, z = outline(*points(answer, name, k), rim, outer)
            yield (
                np.concatenate([-r[::-1], r]),
                FRAME + np.concatenate([z[::-1], z]),
            )

    levels = [
        np.clip(answer.series(f"{name}.voltage") / float(given("drive")), 0.0, 1.0).tolist()
        for name in ("top", "bottom")
    ]
    slider = links().conrod
    rod = [(np.zeros(2), np.array([FRAME + half + x, slider + x])) for x in place]
    spacer = [(np.zeros(2), FRAME + x + half * np.array([-1.0, 1.0])) for x in place]
    frames = {
        name: (np.array([sign * outer, sign * (outer + 2e-3)]), np.array([FRAME, FRAME]))
        for name, sign in (("left frame", -1.0), ("right frame", 1.0))
    }
    return [
        *(_shown(name, "fixed", [line]) for name, line in frames.items()),
        _shown("top cone", "film", cone("top", 1.0), levels[0]),
        _shown("bottom cone", "film", cone("bottom", -1.0), levels[1]),
        _shown("spacer", "spacer", spacer),
        _shown("rod", "link", rod),
    ]


def _places(answer: Answer) -> dict[str, Line]:
    """Joints of the right side, the slider's axis at x = 0."""
    sizes = links()
    found = joints(sizes, answer.series("linkage.displacement"), answer.series("flap_angle"))
    return {name: (x + sizes.crank, y) for name, (x, y) in found.items()}


def _links(answer: Answer) -> list[Body]:
    at = _places(answer)

    def chain(*names: str) -> list[Line]:
        return [
            (np.array([at[n][0][k] for n in names]), np.array([at[n][1][k] for n in names]))
            for k in range(len(answer.times))
        ]

    return [
        _shown("conrod", "link", chain("slider", "crank")),
        _shown("bell crank", "link", chain("crank", "pivot", "arm")),
        _shown("coupler", "link", chain("arm", "rocker")),
        _shown("rocker", "link", chain("rocker", "root")),
        *(_shown(name, "joint", chain(name)) for name in ("slider", "crank", "arm")),
        _shown("rocker joint", "joint", chain("rocker")),
        *(_shown(name, "joint", chain(name)[:1]) for name in ("pivot", "root")),
    ]


def _wing(answer: Answer) -> list[Body]:
    """The right wing from the front: a plate from its leading edge, turned by feathering."""
    at = _places(answer)
    length = float(given("wing_length"))
    chord = 2.0 * length / float(given("aspect_ratio"))
    down = -answer.series("flap_angle")
    seen = chord * np.cos(answer.series("angle_of_attack")) * np.sign(answer.series("flap_rate"))
    lines = []
    for k in range(len(answer.times)):
        along = np.array([math.cos(down[k]), math.sin(down[k])])
        # the trailing edge stays behind: against the direction in which the leading edge moves
        across = seen[k] * np.array([-math.sin(down[k]), math.cos(down[k])])
        root = np.array([at["root"][0][k], at["root"][1][k]])
        corners = [root, root + length * along, root + length * along + across, root + across, root]
        lines.append((np.array([c[0] for c in corners]), np.array([c[1] for c in corners])))
    return [_shown("wing", "wing", lines)]


def _strips(answer: Answer) -> Iterator[Plot]:
    time = (1e3 * (answer.times - answer.times[0])).tolist()
    across = Axis("time (ms)", least=0.0, most=float(time[-1]))

    def curve(name: str, values: Values) -> Curve:
        return Curve(name, time, values.tolist())

    yield Plot(
        title="Voltage",
        x=across,
        y=Axis("voltage (kV)"),
        curves=[curve(n, 1e-3 * answer.series(f"{n}.voltage")) for n in ("top", "bottom")],
    )
    force = answer.series("force.value")
    yield Plot("Force of the actuator", across, Axis("force (N)"), [curve("force", force)])
    electric = np.gradient(answer.series("supplied_energy"), answer.times)
    mechanical = force * answer.series("velocity")
    for name, values in (("Electrical power", electric), ("Mechanical power", mechanical)):
        yield Plot(name, across, Axis("power (mW)"), [curve(name, 1e3 * values)])
    angle, place = np.degrees(answer.series("flap_angle")), answer.series("linkage.displacement")
    yield Plot("Flap angle", across, Axis("angle (deg)"), [curve("right wing", angle)])
    yield Plot("Slider", across, Axis("displacement (mm)"), [curve("slider", 1e3 * place)])
