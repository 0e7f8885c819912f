"""A parameter to be estimated: its start value and its bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

from ...errors import InputError, nearest, printable
from ...scenario.plan import Plan
from ...scenario.start_values import MOST_NAMED, start_value
from ...units import UnitError


@dataclass(frozen=True)
class Unknown:
    """A real parameter of a component, SI.

    The search moves `value = start + scale (u - 1)` from u = 1 on, within `low` and `high`.
    """

    component: str
    name: str
    unit: str
    start: float
    low: float
    high: float

    @property
    def full(self) -> str:
        """`component.parameter`."""
        return f"{self.component}.{self.name}"

    @property
    def scale(self) -> float:
        """Size of a change that counts: the start value, else the range."""
        return abs(self.start) or self.high - self.low

    def value(self, u: float) -> float:
        """The parameter at a place of the search, within its bounds whatever rounding does."""
        return min(max(self.start + self.scale * (u - 1.0), self.low), self.high)

    def place(self, value: float) -> float:
        """The place of the search for a value; infinite for an infinite value."""
        return 1.0 + (value - self.start) / self.scale if isfinite(value) else value


def unknowns_of(texts: Sequence[str], plan: Plan, parts: Sequence[str]) -> list[Unknown]:
    """Parameters named as `mass`, `payload.mass` or `payload.mass=0.3 g:2 g`.

    Start values are the plan's; bounds are by default the FMU's. Raises :class:`InputError` where
    a parameter does not exist, or where it cannot be searched for.
    """
    found: list[Unknown] = []
    for text in texts:
        name, equals, span = text.partition("=")
        unknown = _unknown(name.strip(), span if equals else "", plan, parts)
        if any(unknown.full == other.full for other in found):
            raise InputError(f"--parameter {printable(text)}: is named twice")
        found.append(unknown)
    if not found:
        raise InputError("--parameter: name at least one parameter to fit")
    return found


def _unknown(name: str, span: str, plan: Plan, parts: Sequence[str]) -> Unknown:
    where = f"--parameter {printable(name)}"
    component, dot, parameter = name.partition(".")
    if component not in parts and len(parts) == 1:
        component, parameter = parts[0], name
    elif not dot or component not in parts:
        raise InputError(f"{where}: is not of a part here; {nearest(component, parts)}")
    interface = plan.interfaces[component]
    known = {v.name: v for v in interface.of("parameter") if v.real}
    if parameter not in known:
        hint = nearest(parameter, known, show=MOST_NAMED)
        raise InputError(f"{where}: no real parameter {printable(parameter)!r}; {hint}")
    variable = known[parameter]
    start = float(plan.starts[component].get(parameter, variable.start or 0.0))
    low = -inf if variable.least is None else variable.least
    high = inf if variable.most is None else variable.most
    if span:
        ends = span.split(":")
        if len(ends) != 2:
            raise InputError(f'{where}: write its bounds as "{parameter}=low:high"')
        try:
            given = [float(start_value(variable, end.strip())) for end in ends]
        except UnitError as error:
            raise InputError(f"{where}: {error}") from None
        if not low <= given[0] < given[1] <= high:
            raise InputError(f"{where}: {span.strip()} is not a range within {low:g} to {high:g}")
        low, high = given
    if start == 0.0 and not (isfinite(low) and isfinite(high)):
        raise InputError(
            f"{where}: starts at zero, which gives no size to search by; give bounds,"
            f' as "{parameter}=low:high"'
        )
    if not low <= start <= high:
        raise InputError(
            f"{where}: starts at {start:g} {variable.unit}, outside {low:g} to {high:g}; --set it"
        )
    return Unknown(component, parameter, variable.unit, start, low, high)
