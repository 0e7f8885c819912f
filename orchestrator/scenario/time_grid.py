"""Time of a scenario: cycles, communication points, windows, and when something is to happen."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, isclose, isfinite

from ..errors import Problems
from ..fmi.description import Interface
from ..units import UnitError, si_value
from .schema import AUTO, PerCycle, Scenario

MOST_STEPS = 1_000_000_000
FIRST = 0.1
"""Share of the coarsest step of a search that step control by a tolerance starts with."""


@dataclass(frozen=True)
class Grid:
    """Communication points start + k step for k = 0 ... count, the last one at `stop`."""

    start: float
    stop: float
    step: float
    count: int

    def point(self, k: int) -> float:
        """Time of communication point `k` [s]."""
        return self.stop if k == self.count else self.start + k * self.step


def frequency_of(
    scenario: Scenario,
    interfaces: dict[str, Interface],
    starts: dict[str, dict[str, float | str]],
    problems: Problems,
) -> float | None:
    """Frequency of a cycle: `time.frequency`, else the one parameter of that name."""
    if scenario.time.frequency is not None:
        try:
            value = si_value(scenario.time.frequency, "Hz")
        except UnitError as error:
            problems.add("time.frequency", error)
            return None
        if value <= 0.0:
            problems.add("time.frequency", "must be above zero")
            return None
        return value
    found = [
        starts[name].get("frequency", interface.variables["frequency"].start)
        for name, interface in interfaces.items()
        if "frequency" in starts[name] or _has_parameter(interface, "frequency")
    ]
    if len(found) == 1 and isinstance(found[0], float) and found[0] > 0.0:
        return found[0]
    return None


def _has_parameter(interface: Interface, name: str) -> bool:
    variable = interface.variables.get(name)
    return variable is not None and variable.causality == "parameter"


def grid_of(scenario: Scenario, frequency: float | None, problems: Problems) -> Grid | None:
    """Communication points; the last step is shortened where `stop` is not a multiple."""
    time = scenario.time
    before = len(problems)
    if problems.at("time.frequency"):
        return None
    start = seconds("time.start", time.start, frequency, problems)
    if frequency is None and "stop" not in time.model_fields_set:
        problems.add(
            "time.stop", "is missing: 50 cycles is usual, and nothing here has a frequency"
        )
        return None
    stop = seconds("time.stop", time.stop, frequency, problems)
    if isinstance(time.step, PerCycle):
        if frequency is None:
            problems.add("time.step", "per_cycle needs a frequency; give time.frequency")
        step = 1.0 / frequency / time.step.per_cycle if frequency else 1.0
    elif time.step == AUTO:
        step = trial_step(start, stop, frequency)
        if time.tolerance is not None:
            step *= FIRST
    else:
        step = seconds("time.step", time.step, frequency, problems)
    if len(problems) > before:
        return None
    span = stop - start
    if not (isfinite(span) and isfinite(step)):
        problems.add("time.stop", "start, stop and step have to be finite; see the frequency")
    elif step <= 0.0:
        problems.add("time.step", f"must be above zero, got {step:g} s")
    elif span <= 0.0:
        problems.add("time.stop", f"{stop:g} s is not after time.start, {start:g} s")
    elif step > span * (1.0 + 1e-12):
        problems.add("time.step", f"{step:g} s is longer than the run of {span:g} s")
    elif not span / MOST_STEPS <= step:
        problems.add("time.step", f"with {step:g} s the steps are more than {MOST_STEPS:.0e}")
    if len(problems) > before:
        return None
    whole = round(span / step)
    count = whole if isclose(whole * step, span, rel_tol=1e-9) else ceil(span / step)
    return Grid(start, stop, step, max(1, count))


def trial_step(start: float, stop: float, frequency: float | None) -> float:
    """Where the search for a step begins [s]: a tenth of a cycle, or of the run without one."""
    return min(stop - start, 1.0 / frequency if frequency else stop - start) / 10.0


def seconds(where: str, value: float | str, frequency: float | None, problems: Problems) -> float:
    """A time [s], given in seconds or cycles; 0 and a problem where it is neither."""
    try:
        if isinstance(value, str):
            number, _, unit = value.strip().partition(" ")
            if unit.strip() in {"cycle", "cycles"}:
                if frequency is None:
                    problems.add(where, "cycles need a frequency; give time.frequency")
                    return 0.0
                return si_value(number, "1") / frequency
        return si_value(value, "s")
    except UnitError as error:
        problems.add(where, error)
        return 0.0
