"""What the scenarios say of each datum, for given values of the parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...errors import InputError, SimulationError, nearest
from ...results.metrics import metrics
from ...scenario.library import LIBRARY
from ...scenario.plan import Plan
from ...scenario.start_values import MOST_NAMED, start_value
from ...simulation.interrupt import Interrupt
from ...simulation.load import load
from ...simulation.run import run
from ...units import UnitError, in_base, si_value
from ..sweep.metric_units import shown_units
from ..sweep.peak import Peak, middles, peak_of
from .fits import Datum, Fit, Parameter, Profile

FIRST = 7
"""Runs over the range of a peak, before it is refined."""

FINEST = 1.0 / 16.0
"""Smallest spacing beside the peak, of that of the first runs."""


class Model:
    """Scenarios of a fit as a function from its parameters to its data, all in SI.

    A peak is looked for once for every scenario and range, however many data are of it; `runs`
    counts the runs of scenarios.
    """

    def __init__(self, fit: Fit, library: Path = LIBRARY, interrupt: Interrupt | None = None):
        self.fit = fit
        self.runs = 0
        self._library = library
        self._interrupt = interrupt
        self._plans = {d.scenario: load(d.scenario, None, library) for d in fit.data}
        self.start = [self._si(parameter, parameter.value) for parameter in fit.parameters]
        self.low = [self._si(parameter, parameter.low) for parameter in fit.parameters]
        self.high = [self._si(parameter, parameter.high) for parameter in fit.parameters]
        self.paper = [self._paper(datum) for datum in fit.data]
        self.uncertainty = [self._uncertainty(datum) for datum in fit.data]

    def values(self, parameters: Sequence[float], share: float | None = None) -> list[float]:
        """Each datum as the scenarios have it; `SimulationError` where a run stops.

        `share` is that of the fit's profile; None leaves the scenarios as they are.
        """
        known: dict[tuple[Any, ...], Peak] = {}
        found = []
        for datum in self.fit.data:
            key = (
                datum.scenario,
                datum.metric,
                datum.over,
                datum.between,
                tuple(datum.set.items()),
            )
            if key not in known:
                known[key] = self._peak(datum, parameters, share)
            peak = known[key]
            found.append(peak.at if datum.of == "place" else datum.share * peak.value)
        names = [datum.name for datum in self.fit.data]
        return [
            value / found[names.index(datum.against)] if datum.against else value
            for datum, value in zip(self.fit.data, found, strict=True)
        ]

    def carried(self, parameter: Parameter) -> list[float]:
        """The value [SI] that each scenario of a parameter really has, its own times taken out."""
        component, _, name = parameter.sets.partition(".")
        found = []
        for scenario in parameter.scenarios:
            plan = self._plans.get(scenario) or load(scenario, None, self._library)
            known = plan.interfaces[component].variables[name]
            value = plan.starts[component].get(name, known.start)
            found.append(float(value) / parameter.times.get(scenario, 1.0))  # type: ignore[arg-type]
        return found

    def _si(self, parameter: Parameter | Profile, value: float | str) -> float:
        component, _, name = parameter.sets.partition(".")
        plan = self._plans.get(parameter.scenarios[0])
        if plan is None or component not in plan.interfaces:
            raise InputError(f"{parameter.name}: no datum is of scenario {parameter.scenarios[0]}")
        known = plan.interfaces[component].variables
        if name not in known:
            settable = [key for key, v in known.items() if v.causality == "parameter"]
            hint = nearest(name, settable, show=MOST_NAMED)
            raise InputError(f"{parameter.name}: no parameter {name!r}; {hint}")
        try:
            return float(start_value(known[name], value))
        except UnitError as error:
            raise InputError(f"{parameter.name}: {error}") from None

    def _paper(self, datum: Datum) -> float:
        """The paper's value [SI]; NaN where it has none."""
        unit = _unit(self._plans[datum.scenario], datum)
        return math.nan if datum.value is None else si_value(datum.value, unit)

    def _uncertainty(self, datum: Datum) -> float:
        """Relative standard deviation of the paper's value; NaN where none is stated."""
        if datum.uncertainty is None or datum.value is None:
            return math.nan
        try:
            if str(datum.uncertainty).endswith("%"):
                return si_value(datum.uncertainty, "1")
            unit = _unit(self._plans[datum.scenario], datum)
            return abs(si_value(datum.uncertainty, unit) / si_value(datum.value, unit))
        except UnitError as error:
            raise InputError(f"{datum.name}: uncertainty: {error}") from None

    def _peak(self, datum: Datum, parameters: Sequence[float], share: float | None) -> Peak:
        """The metric as the scenario stands, or its peak over a range, bisected beside it."""
        changes: dict[str, Any] = dict(datum.set)
        for parameter, value in zip(self.fit.parameters, parameters, strict=True):
            if datum.scenario in parameter.scenarios:
                changes[parameter.sets] = value * parameter.times.get(datum.scenario, 1.0)
        profile = self.fit.profile
        if profile is not None and share is not None and datum.scenario in profile.scenarios:
            changes[profile.sets] = share * self._si(profile, profile.value)
        if datum.between is None:
            return Peak(0.0, self._metric(datum, changes))
        low, high = (si_value(end, "Hz") for end in datum.between)
        first = (high - low) / (FIRST - 1)
        places = [low + k * first for k in range(FIRST)]
        values: dict[float, float] = {}
        while places:
            for place in places:
                values[place] = self._metric(datum, changes | {datum.over: place})
            places = middles(values, FINEST * first)
        peak = peak_of(values)
        if peak is None or not low < peak.at < high:
            raise SimulationError(f"{datum.name}: no peak between {low:g} and {high:g} Hz")
        return peak

    def _metric(self, datum: Datum, changes: Mapping[str, Any]) -> float:
        """A metric of one run [SI]."""
        given = {"stop": datum.stop, "step": datum.step}
        time = {key: value for key, value in given.items() if value is not None}
        plan = load(datum.scenario, dict(changes), self._library, time=time)
        done = run(plan, estimate=False, interrupt=self._interrupt)
        if done.failure is not None:
            raise done.failure
        self.runs += 1
        found = {m.name: m.value for m in metrics(done)}
        if datum.metric not in found:
            raise InputError(f"{datum.name}: {datum.scenario} has no {datum.metric}")
        return found[datum.metric]


def _unit(plan: Plan, datum: Datum) -> str:
    """SI unit of a datum: that of the parameter swept over, of the metric, or none of a ratio."""
    known = shown_units(plan)
    if datum.metric not in known:
        raise InputError(
            f"{datum.name}: no metric {datum.metric!r}; {nearest(datum.metric, known)}"
        )
    if datum.against:
        return "1"
    if datum.of != "place":
        return in_base(known[datum.metric])[0]
    component, _, name = datum.over.partition(".")
    return plan.interfaces[component].variables[name].unit or "1"
