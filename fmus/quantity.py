"""One number of the physics: its unit, meaning, bounds, port and provenance.

A field of a part's `Params`, `Input` or `Output` is declared once with
:func:`parameter`, :func:`received` or :func:`provided`. From that one line come the
FMI variable, its unit and bounds, the table in the part's README and the checks on
what a user sets.
"""

from __future__ import annotations

import dataclasses
from typing import Any

UNLIMITED = 1.0e30
"""A limit at or above this value does not limit."""

NO_REFERENCE = -1.0e30
"""Reference time of a plain number: the value is taken as present, whatever the time."""


@dataclasses.dataclass(frozen=True)
class Quantity:
    """What FMI and a reader need to know of one scalar.

    `unit` is written as in FMI (`"N.s/m"`, `"1"` for a pure number). `least` and `most`
    are inclusive. `port` groups variables into a terminal; `order` says what a member of
    a terminal carries: 0 a value, 1 part of the affine law around it, 2 its curvature.
    `choices` names the items of an enumeration, numbered from 1. `depends` lists the
    ports or variables an output follows without a step in between. `name`, where given,
    is the FMI name in place of the one made of port and field. `tunable` parameters may
    change while the part runs. `discrete` outputs change at events only.
    """

    unit: str
    meaning: str
    least: float | None = None
    most: float | None = None
    source: str = ""
    port: str = ""
    order: int = 0
    choices: tuple[str, ...] = ()
    depends: tuple[str, ...] = ()
    name: str = ""
    tunable: bool = False
    discrete: bool = False

    def fmi_name(self, field: str) -> str:
        """FMI name of the dataclass field: `force_value` in port `force` is `force.value`."""
        if self.name:
            return self.name
        return f"{self.port}.{field.removeprefix(self.port + '_')}" if self.port else field


def parameter(
    start: float,
    unit: str,
    meaning: str,
    source: str,
    *,
    least: float | None = None,
    most: float | None = None,
    choices: tuple[str, ...] = (),
    tunable: bool = False,
) -> Any:
    """Field of `Params`; `source` opens with printed, inferred, calibrated, assumed or chosen."""
    if choices:
        least, most = 1.0, float(len(choices))
    quantity = Quantity(unit, meaning, least, most, source, choices=choices, tunable=tunable)
    return dataclasses.field(default=start, metadata={"quantity": quantity})


def received(
    start: float, unit: str, meaning: str, *, port: str = "", order: int = 0, name: str = ""
) -> Any:
    """Field of `Input`; `start` holds where nothing is connected."""
    quantity = Quantity(unit, meaning, port=port, order=order, name=name)
    return dataclasses.field(default=start, metadata={"quantity": quantity})


def provided(
    unit: str,
    meaning: str,
    *,
    port: str = "",
    order: int = 0,
    depends: tuple[str, ...] = (),
    least: float | None = None,
    most: float | None = None,
    name: str = "",
    discrete: bool = False,
) -> Any:
    """Field of `Output`; `depends` names the ports or inputs it follows directly."""
    quantity = Quantity(
        unit, meaning, least, most,
        port=port, order=order, depends=depends, name=name, discrete=discrete,
    )  # fmt: skip
    return dataclasses.field(metadata={"quantity": quantity})


def quantities(record: type[Any]) -> dict[str, Quantity]:
    """Field name -> :class:`Quantity` of a dataclass made of the declarations above."""
    return {f.name: f.metadata["quantity"] for f in dataclasses.fields(record) if f.metadata}


def starts(record: type[Any]) -> list[float]:
    """Start values of the declared fields, in order; 0 where a field has none."""
    values = (f.default for f in dataclasses.fields(record) if f.metadata)
    return [0.0 if value is dataclasses.MISSING else float(value) for value in values]
