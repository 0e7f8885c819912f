"""What is fitted to what, as checked data of a TOML file."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ...errors import ScenarioError, nearest
from ...recording.settings import Quantity, Text
from ...scenario.files import read_toml

SHIPPED = "cases/calibration.toml"


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Parameter(_Table):
    """A start value `component.parameter` of some scenarios; `value` is what they carry.

    A scenario named in `times` carries so many times the value: two layers, twice the mass.
    """

    name: Text
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


class Datum(_Table):
    """A number of the paper: a metric's peak over a parameter, in height or place, or its value.

    A datum that is `held_out` is not fitted but predicted. `set`, `stop` and `step` change the
    scenario; the paper's number is `share` times the metric, one half for an amplitude of a travel.
    `within` is how well it is known, relative: it counts by the inverse.
    """

    name: Text
    where: Text
    scenario: Text
    metric: Text
    of: Literal["place", "height", "value"]
    value: Quantity
    over: Text = ""
    between: tuple[Quantity, Quantity] | None = None
    set: dict[str, Quantity] = {}
    stop: Quantity | None = None
    step: Quantity | None = None
    share: Annotated[float, Field(gt=0.0)] = 1.0
    within: Annotated[float, Field(gt=0.0)] = 1.0
    held_out: bool = False

    @model_validator(mode="after")
    def _ranged(self) -> Self:
        if (self.of == "value") == bool(self.over and self.between):
            raise ValueError("a peak needs over and between, a value neither")
        return self


class Fit(_Table):
    """Parameters and the data that they are fitted to."""

    name: Text
    title: Text = ""
    parameters: Annotated[list[Parameter], Field(min_length=1)]
    data: Annotated[list[Datum], Field(min_length=1)]

    @model_validator(mode="after")
    def _determined(self) -> Self:
        fitted = sum(not datum.held_out for datum in self.data)
        if fitted < len(self.parameters):
            raise ValueError(f"{len(self.parameters)} parameters on {fitted} data: not determined")
        return self


class _List(_Table):
    fits: Annotated[list[Fit], Field(min_length=1)]


def shipped() -> Path:
    """File of the fits behind the scenarios that come with the package."""
    return Path(str(resources.files("scenarios") / SHIPPED))


def load_fits(path: Path, names: list[str] | None = None) -> list[Fit]:
    """Fits of a file, or those that are named; `ScenarioError` with what is wrong."""
    tree = read_toml(path)
    try:
        fits = _List.model_validate(tree).fits
    except ValidationError as error:
        raise ScenarioError(
            f"{path}: {'.'.join(map(str, e['loc']))}: {e['msg']}"
            for e in error.errors(include_url=False)
        ) from None
    known = [fit.name for fit in fits]
    for name in names or []:
        if name not in known:
            raise ScenarioError(f"{path}: no fit {name!r}; {nearest(name, known)}")
    return [fit for fit in fits if not names or fit.name in names]
