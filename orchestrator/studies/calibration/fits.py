"""What is fitted to what, as checked data of a TOML file."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ...errors import nearest
from ...recording.settings import Quantity, Text
from ..named_list import Named, load_list

SHIPPED = "cases/calibration.toml"


class Parameter(Named):
    """A start value `component.parameter` of some scenarios; `value` is what they carry.

    A scenario named in `times` carries so many times the value: two layers, twice the mass.
    """

    sets: Text
    scenarios: Annotated[list[Text], Field(min_length=1)]
    value: Quantity
    low: Quantity
    high: Quantity
    times: dict[str, Annotated[float, Field(gt=0.0)]] = {}

    @model_validator(mode="after")
    def _known(self) -> Self:
        if strange := sorted(set(self.times) - set(self.scenarios)):
            raise ValueError(f"times: {', '.join(strange)} is not among the scenarios")
        return self


class Datum(Named):
    """A number of the paper: a metric's peak over a parameter, in height or place, or its value.

    A datum that is `held_out` is not fitted but predicted. `set`, `stop` and `step` change the
    scenario; the paper's number is `share` times the metric, one half for an amplitude of a travel.
    With `against` it is the ratio to the datum of that name. `within` is how well it is known,
    relative: it counts by the inverse. One without a `value` has not been measured. `uncertainty`
    is the standard deviation of the measured value, in its unit or in %: from those of the fitted
    data follow the bands. `key` names it among the paper's numbers.
    """

    where: Text
    scenario: Text
    metric: Text
    of: Literal["place", "height", "value"]
    value: Quantity | None = None
    over: Text = ""
    between: tuple[Quantity, Quantity] | None = None
    set: dict[str, Quantity] = {}
    stop: Quantity | None = None
    step: Quantity | None = None
    share: Annotated[float, Field(gt=0.0)] = 1.0
    against: Text = ""
    key: Text = ""
    within: Annotated[float, Field(gt=0.0)] = 1.0
    uncertainty: Quantity | None = None
    held_out: bool = False

    @model_validator(mode="after")
    def _ranged(self) -> Self:
        if (self.of == "value") == bool(self.over and self.between):
            raise ValueError("a peak needs over and between, a value neither")
        if self.value is None and not self.held_out:
            raise ValueError("value: is missing; only a datum that is held out may have none")
        return self


class Profile(Named):
    """A start value that is set to shares of `value`, all parameters fitted again at each.

    It is none of the fit's own parameters: the data do not fix it beside them.
    """

    sets: Text
    scenarios: Annotated[list[Text], Field(min_length=1)]
    value: Quantity
    shares: Annotated[list[Annotated[float, Field(gt=0.0)]], Field(min_length=2)]


class Fit(Named):
    """Parameters and the data that they are fitted to.

    Those of an `experiment` are of a variant that the data's `set` makes: no scenario carries them.
    """

    title: Text = ""
    experiment: bool = False
    parameters: Annotated[list[Parameter], Field(min_length=1)]
    data: Annotated[list[Datum], Field(min_length=1)]
    profile: Profile | None = None

    @model_validator(mode="after")
    def _determined(self) -> Self:
        fitted = sum(not datum.held_out for datum in self.data)
        if fitted < len(self.parameters):
            raise ValueError(f"{len(self.parameters)} parameters on {fitted} data: not determined")
        names = {datum.name: datum for datum in self.data}
        for datum in self.data:
            if datum.against and (datum.against not in names or names[datum.against].against):
                closest = nearest(datum.against, [n for n, d in names.items() if not d.against])
                raise ValueError(f"{datum.name}: against no datum {datum.against!r}; {closest}")
        return self


def shipped() -> Path:
    """File of the fits behind the scenarios that come with the package."""
    return Path(str(resources.files("scenarios") / SHIPPED))


def load_fits(path: Path, names: list[str] | None = None) -> list[Fit]:
    """Fits of a file, or those that are named; `ScenarioError` with what is wrong."""
    return load_list(path, "fits", Fit, names)
