"""How accurate a run is by its estimate: its worst leading variable, and what would help."""

from __future__ import annotations

from math import ceil, floor, log10

import numpy as np

from ..errors import printable
from ..scenario.plan import Plan, usual
from ..scenario.schema import PerCycle
from ..units import UnitError, in_base
from .outcome import Outcome

INACCURATE = 0.01
"""Estimated error of a leading variable, by its largest value, from which on a run warns."""
MARGIN = 0.7
"""Share of it that the step aims at which a warning names."""
MEANINGLESS = 0.5
"""The same from which on the numbers of a run say nothing."""
UNRELATED = 1.0
"""The same from which on a run and that at half its steps have nothing in common."""
NONE_SEEN = 1e-12
"""The same below which only rounding is left."""
STILL = 1e-9
"""Travel [m] or [rad] of a leading variable up to which it does not move."""


def still(outcome: Outcome) -> dict[str, float]:
    """Leading displacements and angles that stay where they are, with their travel in SI."""
    if not len(outcome.rows):
        return {}
    found = {}
    units = {f"{c}.{v.name}": v.unit for c, v in outcome.plan.records}
    for name in outcome.plan.leading:
        try:
            unit, scale = in_base(units[name])
        except UnitError:
            continue
        if unit not in {"m", "rad"}:
            continue
        travel = scale * float(np.ptp(outcome.series(name)))
        if travel < STILL:
            found[name] = travel
    return found


def largest_error(outcome: Outcome) -> tuple[str, float]:
    """The leading variable with the largest estimated relative error, and that error.

    Variables that do not move do not count. "" and 0 where nothing is estimated.
    """
    estimates, resting = outcome.estimates or {}, still(outcome)
    found = {
        name: estimates[name].relative
        for name in outcome.plan.leading
        if name in estimates and name not in resting
    }
    return max(found.items(), key=lambda entry: entry[1], default=("", 0.0))


def accuracy(outcome: Outcome) -> str:
    """One line on the estimated error of a run, "" where there is none."""
    name, relative = largest_error(outcome)
    if not name:
        return ""
    if relative < NONE_SEEN:
        return "estimated error of the coupling: none seen at half the step"
    return f"estimated error of the coupling: {relative:.1e} of the largest {printable(name)}"


def meaningless(outcome: Outcome) -> str:
    """Why the numbers of a run say nothing, "" where they do."""
    name, relative = largest_error(outcome)
    if relative < MEANINGLESS:
        return ""
    return (
        f"{name}: estimated error {relative:.0%} of its largest value, these numbers say nothing;"
        f" {remedy(outcome.plan, relative)}"
    )


def remedy(plan: Plan, relative: float) -> str:
    """The setting that would bring the error of a leading variable below `INACCURATE`.

    No order is seen in an error of `UNRELATED` and more, where trials may find a step.
    """
    searched = plan.scenario.time.tolerance is None and not (plan.fixed_step or plan.step_reason)
    if relative >= UNRELATED and searched:
        return "--step auto finds one that would do"
    first = plan.scenario.master.laws == "held" or usual(plan.connections) == "extrapolated"
    share = (MARGIN * INACCURATE / relative) ** (1.0 if first else 0.5)
    time = plan.scenario.time
    if time.tolerance is not None:
        return f"--tolerance {_rounded_down(share**2 * time.tolerance):g} would do"
    if isinstance(time.step, PerCycle):
        return f'--step "{_rounded_up(time.step.per_cycle / share)} per cycle" would do'
    return f'--step "{_rounded_down(plan.grid.step * share):g} s" would do'


def _rounded_down(value: float) -> float:
    """The next number below that has two digits."""
    unit = 10.0 ** (floor(log10(value)) - 1)
    return float(f"{floor(value / unit) * unit:.2g}")


def _rounded_up(count: float) -> int:
    """The next whole number above that has two digits."""
    unit = int(10 ** max(floor(log10(count)) - 1, 0))
    return ceil(count / unit) * unit
