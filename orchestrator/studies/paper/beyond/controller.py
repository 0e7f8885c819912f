"""A controller in the loop: it finds the resonance and holds a stroke, also without membranes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....report.plot import Axis, Curve, Figure, Plot
from ....report.table import Cell, Column, Table, quantity
from ..cached_runs import CachedRuns
from ..comparison import Comparison
from ..job import Answer, Job, plan_of, start_of
from .control_loops import Gains, Margin, closed, loop, measured, plant, predicted

if TYPE_CHECKING:
    import control

TITLE = "Beyond: a controller in the loop"
START = "flapping-controlled"
LOSS = "flapping-controlled-membrane-loss"
OPEN = "flapping-membrane-loss"
SENSED = "flapping-controlled-by-capacitance"
EXCITED = "flapping-controlled-excitation"
SCENARIOS = (START, LOSS, OPEN, SENSED, EXCITED)
KEPT = ("linkage.flap_angle", "controller.*")
FREE = {
    "controller.lag_gain": "0",
    "controller.lag_integral_gain": "0",
    "controller.stroke_gain": "0",
    "controller.stroke_integral_gain": "0",
    "controller.start_phase": "1 rad",
}
"""Loops open; edges between the instants at which the model is seen."""

INPUTS = ("controller.excitation.frequency", "controller.excitation.drive")
SHOWN = ("controller.lag", "controller.stroke")
BAND = 0.01
"""A stroke has settled from where on it stays within this of what is commanded."""

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Strokes:
    """Cycle by cycle: end [s], stroke peak to peak [rad] and drive frequency [Hz]."""

    times: Values
    sizes: Values
    frequencies: Values

    def settled(self, target: float, since: float = 0.0) -> tuple[float, int]:
        """Time and cycles from `since` until the stroke stays within `BAND` of the target."""
        after = self.times > since
        outside = np.flatnonzero(after & (np.abs(self.sizes / target - 1.0) > BAND))
        begin = int(np.argmax(after))
        last = int(outside[-1]) + 1 if len(outside) else begin
        if last >= len(self.times):
            return math.nan, 0
        return float(self.times[last] - since), last + 1 - begin


def controller(cached_runs: CachedRuns) -> Comparison:
    """Start-up, margins, the loss of the membranes, sensing by capacitance."""
    jobs = [Job(name, keep=KEPT, cycles=0) for name in SCENARIOS]
    answers = cached_runs.answers(jobs)
    model = _model_job(cached_runs, answers[-1])
    (averaged,) = cached_runs.answers([model]) if model else (None,)
    everything = [*answers, averaged] if averaged else answers
    failures = [
        f"{j.scenario}: {a.reason}"
        for j, a in zip([*jobs, *([model] if model else [])], everything, strict=True)
        if a.reason
    ]
    if failures or averaged is None:
        return Comparison("controller", TITLE, (), (), failures=failures)
    plans = {job.scenario: plan_of(job, cached_runs.library) for job in jobs}
    targets = {name: start_of(plan, "controller.stroke_target")
               for name, plan in plans.items() if "controller" in plan.starts}  # fmt: skip
    found = dict(zip(SCENARIOS, answers, strict=True))
    strokes = {name: cycles_of(found[name], plans[name].frequency or 1.0)
               for name in (START, LOSS, OPEN, SENSED)}  # fmt: skip
    gains = [
        Gains(start_of(plans[EXCITED], f"controller.{name}_gain"),
              start_of(plans[EXCITED], f"controller.{name}_integral_gain"))
        for name in ("lag", "stroke")
    ]  # fmt: skip
    system = plant(averaged, 1.0 / (plans[START].frequency or 1.0))
    excited = {
        name.rpartition(".")[2]: (action.time, float(value))
        for action in plans[EXCITED].actions
        for name, value in action.values.items()
    }
    margins = {
        name: (
            predicted(loop(system, gains, which)),
            _measured(found[EXCITED], name, *excited[name]),
        )
        for which, name in enumerate(("frequency", "drive"))
    }  # fmt: skip
    loss = next(action.time for action in plans[LOSS].actions)
    since, size = excited["drive"]
    beside = _beside(found[EXCITED], system, gains, since, excited["frequency"][0], size)
    return Comparison(
        key="controller",
        title=TITLE,
        words=_words(),
        rows=(),
        figures=[_started(strokes, targets, loss), beside],
        failures=(),
        extras=[_table(strokes, targets, loss), _margins(margins)],
    )


def cycles_of(answer: Answer, frequency: float) -> Strokes:
    """Stroke and frequency of each cycle of the drive, or of each 1/`frequency` [s] without one."""
    angle = answer.series("linkage.flap_angle")
    try:
        ends = _ends(answer)
        rates = answer.series("controller.frequency")
    except KeyError:
        count = math.floor(float(answer.times[-1]) * frequency + 1e-6)
        ends = np.searchsorted(answer.times, (np.arange(count) + 1.0) / frequency - 1e-9)
        rates = np.full(len(angle), frequency)
    starts = np.concatenate([[0], ends[:-1]])
    sizes = [float(np.ptp(angle[a : b + 1])) for a, b in zip(starts, ends, strict=True)]
    before = np.maximum(ends - 1, 0)
    return Strokes(answer.times[ends], np.asarray(sizes), rates[before])


def _ends(answer: Answer) -> NDArray[np.intp]:
    """Places of the rows at which the controller's cycles end: its sensed stroke changes there."""
    return np.flatnonzero(np.diff(answer.series("controller.stroke")) != 0.0) + 1


def _model_job(cached_runs: CachedRuns, excited: Answer) -> Job | None:
    """The averaged model at the drive that the excited run holds; None where that has failed.

    Seen once a cycle of the scenario: the drive has its frequency, so that the state is periodic.
    """
    if excited.reason:
        return None
    plan = plan_of(Job(EXCITED), cached_runs.library)
    until = np.searchsorted(excited.times, min(action.time for action in plan.actions)) - 1
    drive = float(excited.series("controller.drive")[until])
    state = {
        "controller.start_frequency": f"{plan.frequency!r} Hz",
        "controller.start_drive": repr(drive),
    }
    return Job(START, {**FREE, **state}, keep=SHOWN, per_cycle=400, inputs=INPUTS)


def _measured(answer: Answer, name: str, since: float, excitation: float) -> Margin:
    """Margin of a loop from its command once a cycle, from the step at `since` [s] on."""
    command = answer.series(f"controller.{name}")
    ends = _ends(answer)
    times = answer.times[ends]
    inside = (times > since) & (times < since + 2.0)
    before = command[ends[times <= since][-1]]
    total = command[ends[inside]] - before
    return measured(total, excitation, float(np.mean(np.diff(times[inside]))))


def _words() -> tuple[str, ...]:
    return (
        "The paper sets frequency and voltage by hand. A vehicle that flies has to find them: the"
        " FMU controller, in between sensor and the amplifier's external command, compares the"
        " motion's lag behind the drive with the 90 degrees of resonance, and the stroke with what"
        " is commanded, once a cycle.",
        "Its gains were chosen on the averaged linear model: the vehicle with open loops, seen once"
        " a cycle, is at rest, and linearise finds from there how lag and stroke answer frequency"
        " and drive. The margins of each loop, the other one closed, are predicted by"
        " python-control, and measured by adding a step to the loop's command in a run: what the"
        " loop then adds of its own, over the whole command, is its gain at every frequency.",
        "The membranes are lost by a timed action: inertia falls to that of the bare frames, and"
        " the air takes nothing any more. With the drive left as it was the stroke grows by a"
        " fifth, though the frames' resonance lies at 23 Hz; the controller goes there and lowers"
        " the voltage.",
        "Without a sensor the angle is read from the film's own capacitance, charge over voltage of"
        " the cone that is charged: it changes by 5 % over the stroke, so 1 % of noise on each of"
        " the 32 samples of a cycle is a fifth of the signal. The curve from capacitance to angle"
        " was fitted on the film model, between 1750 and 1920 V, and is off by 1.8 degrees there,"
        " root mean square. Without noise the stroke that is held is 62.8 degrees for 60 commanded;"
        " noise through the bent curve reads as stroke, so less of it is held.",
    )


def _table(strokes: dict[str, Strokes], targets: dict[str, float], loss: float) -> Table:
    """What each scenario comes to."""
    rows = []
    for name in (START, LOSS, SENSED, OPEN):
        each, target = strokes[name], targets.get(name, math.nan)
        since = loss if name in (LOSS, OPEN) else 0.0
        late = each.times > each.times[-1] - 1.0 if name != SENSED else each.times > 2.0
        size, rate = float(each.sizes[late].mean()), float(each.frequencies[late].mean())
        spread = float(each.sizes[late].std())
        time, count = each.settled(target, since) if name not in (OPEN, SENSED) else (math.nan, 0)
        over = float(each.sizes[each.times > since].max()) / target - 1.0
        rows.append(
            [
                Cell(name),
                Cell("-") if math.isnan(target) else _degrees(target),
                _degrees(size, f"+- {math.degrees(spread):.2f} over cycles"),
                quantity(rate, f"{rate:.2f} Hz"),
                Cell("-") if math.isnan(time) else quantity(time, f"{time:.2f} s, {count} cycles"),
                Cell("-") if math.isnan(over) else quantity(over, f"{100 * over:+.1f} %"),
            ]
        )
    columns = [
        Column("Scenario"), Column("Commanded", number=True), Column("Stroke held", number=True),
        Column("Frequency", number=True), Column("Within 1 % after", number=True),
        Column("Largest stroke over commanded", number=True),
    ]  # fmt: skip
    return Table("Commanded and held", columns, rows)


def _margins(margins: dict[str, tuple[Margin, Margin]]) -> Table:
    rows = []
    for name, (model, run) in margins.items():
        words = {"frequency": "lag by frequency", "drive": "stroke by drive"}[name]
        rows.append(
            [
                Cell(words),
                quantity(model.gain, f"{model.gain:.2f}")
                if math.isfinite(model.gain)
                else Cell("infinite"),
                _degrees(model.phase), _degrees(run.phase),
                quantity(model.crossover, f"{model.crossover:.2f} Hz"),
                quantity(run.crossover, f"{run.crossover:.2f} Hz"),
            ]
        )  # fmt: skip
    columns = [
        Column("Loop"), Column("Gain margin, predicted", number=True),
        Column("Phase margin, predicted", number=True),
        Column("Phase margin, measured", number=True),
        Column("Crossover, predicted", number=True), Column("Crossover, measured", number=True),
    ]  # fmt: skip
    return Table("Margins of both loops", columns, rows)


def _degrees(angle: float, note: str = "") -> Cell:
    return quantity(angle, f"{math.degrees(angle):.2f} deg", note)


def _started(strokes: dict[str, Strokes], targets: dict[str, float], loss: float) -> Figure:
    """Stroke and frequency over time: from rest, and through the loss."""
    plots = []
    for title, names in (
        ("From rest", {START: "angle sensor", SENSED: "capacitance, 1 % noise"}),
        (f"Membranes lost at {loss:g} s", {LOSS: "controlled", OPEN: "18 Hz, full voltage"}),
    ):
        curves = [
            Curve(words, strokes[n].times.tolist(), np.degrees(strokes[n].sizes).tolist())
            for n, words in names.items()
        ]
        rates = [
            Curve(words, strokes[n].times.tolist(), strokes[n].frequencies.tolist())
            for n, words in names.items()
        ]
        most = 5.0
        time = Axis("time (s)", least=0.0, most=most)
        plots += [
            Plot(f"{title}: stroke", time, Axis("stroke (deg)"), curves),
            Plot(f"{title}: drive frequency", time, Axis("frequency (Hz)"), rates),
        ]
    named = ", ".join(f"{math.degrees(t):.0f}" for t in sorted(set(targets.values())))
    return Figure(
        "controller",
        "A commanded stroke, held",
        f"Peak to peak of each cycle; {named} degrees are commanded. Scenarios {START}, {SENSED},"
        f" {LOSS}, {OPEN}.",
        plots,
    )


def _beside(
    answer: Answer,
    system: control.StateSpace,
    gains: list[Gains],
    since: float,
    until: float,
    size: float,
) -> Figure:
    """Answer of the loops to a step of the drive: run beside the linear model."""
    import control

    ends = _ends(answer)
    inside = (answer.times[ends] > since - 0.2) & (answer.times[ends] < min(until, since + 1.2))
    times = answer.times[ends][inside]
    first = int(np.argmax(times > since))
    count = len(times) - first
    _, linear = control.step_response(
        closed(system, gains),
        np.arange(count) * float(system.dt),
        input=1,
    )
    plots = []
    for k, (name, label) in enumerate((("lag", "lag (deg)"), ("stroke", "stroke (deg)"))):
        run = np.degrees(answer.series(f"controller.{name}")[ends][inside])
        model = run[first] + size * np.degrees(np.asarray(linear)[k].ravel())
        plots.append(
            Plot(
                f"{name.capitalize()} after a step of the drive",
                Axis("time (s)"),
                Axis(label),
                [Curve("run", times.tolist(), run.tolist(), "points"),
                 Curve("linear model", times[first:].tolist(), model.tolist())],
            )
        )  # fmt: skip
    return Figure(
        "controller-step",
        "The averaged linear model beside the run",
        f"The drive is raised by {size:g} at {since:g} s; a point is a cycle. Scenario {EXCITED}.",
        plots,
    )
