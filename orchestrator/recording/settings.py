"""Keys of a recording in a scenario, and the types of value in the tables of a scenario."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Quantity = Number | Annotated[str, Field(strict=True, min_length=1, max_length=200)]
Text = Annotated[str, Field(strict=True, max_length=2000)]
Flag = Annotated[bool, Field(strict=True)]
Line = Annotated[int, Field(strict=True, ge=0, le=1_000)]
Outside = Literal["hold", "zero", "stop"]


class Table(BaseModel):
    """A TOML table: unknown keys are errors, values are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class RecordingSettings(Table):
    """The file `data` and how it is read: docs/reference/recordings.md lists the keys.

    `memory` limits the size of the file; `before` and `after` set the values outside the record,
    `repeat` continues it periodically. From `skip` to `decimal` the keys say how a text is laid
    out, lines counted from 1; `interval` is the time between rows that have none.
    """

    data: Text | None = None
    memory: Quantity | None = None
    component: Text | None = None
    columns: dict[str, Text] = {}
    units: dict[str, Text] = {}
    gains: dict[str, Number] = {}
    shifts: dict[str, Number] = {}
    skip: Line = 0
    headings: Line | None = None
    units_row: Line | None = None
    names: list[Text] = []
    encoding: Text = ""
    decimal: Literal["", ".", ","] = ""
    interval: Quantity | None = None
    interpolation: Literal["held", "linear", "cubic", "band-limited"] = "cubic"
    repeat: Flag | Quantity = False
    offset: Quantity = 0.0
    before: Outside = "hold"
    after: Outside = "stop"
    gaps: Literal["refuse", "bridge"] = "refuse"
