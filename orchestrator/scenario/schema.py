"""A scenario: the TOML text as checked data; no FMU is loaded yet.

`extends` takes another scenario as it is and changes what differs; `without` drops components
with all their wires, holds and records. All problems of a file are reported at once, each with
its key and the nearest right name.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from ..recording.settings import Flag, Number, Quantity, RecordingSettings, Table, Text

AUTO = "auto"


class PerCycle(Table):
    """A communication step as a fraction of the drive's cycle."""

    per_cycle: Annotated[int, Field(strict=True, ge=1, le=10_000_000)]


class Time(Table):
    """Time span and communication step; `frequency` defines the cycle where it is needed.

    Without a step, or with `step = "auto"`, a trial run finds the coarsest one that is stable and
    accurate; beside a `tolerance`, step control needs none.
    """

    start: Quantity = 0.0
    stop: Quantity = "50 cycles"
    step: PerCycle | Quantity = AUTO
    frequency: Quantity | None = None
    tolerance: Annotated[float, Field(strict=True, gt=0.0, lt=1.0)] | None = None


RECORDED = set(RecordingSettings.model_fields) - {"data", "memory"}
"""Keys that only a recorded component has."""


class Component(RecordingSettings):
    """A built part by name or any FMU by path, with its start values; or a recording.

    The start values named in `inherited` are those that a base scenario has for another FMU in this
    place; they are dropped unless all of them fit. `isolate` puts it into a process to itself, or
    into the master's; outside the master's `patience` is the time that one call may take, and
    `memory` what may be allocated. `stop_time = false` keeps the end of the run from an FMU that
    would integrate up to it at once, `rollback = false` does without its saved states. A recording
    is the file `data` with the keys of docs/reference/recordings.md; `memory` is how large it may
    be.
    """

    fmu: Text | None = None
    start: dict[str, Quantity | Flag] = {}
    inherited: list[Text] = []
    isolate: Flag | None = None
    patience: Quantity | None = None
    stop_time: Flag = True
    rollback: Flag = True

    @model_validator(mode="after")
    def _one_source(self) -> Component:
        """Check that there is an FMU or a recording, and no key that means nothing to it."""
        fields = type(self).model_fields
        given = {key for key in fields if getattr(self, key) != fields[key].default}
        if (self.fmu is None) == (self.data is None):
            fault = "fmu: is missing" if self.fmu is None else "data: an fmu is named too; keep one"
            raise PydanticCustomError("component", "{fault}", {"fault": fault})
        if self.data is None:
            foreign = given & RECORDED
            fault = ": means nothing without data, the file of a recording"
        else:
            foreign = given & {"start", "isolate", "patience", "stop_time", "rollback"}
            fault = ": means nothing to a recording, which has no parameters and runs in no process"
        if self.repeat is not False and not foreign:
            foreign = given & {"before", "after"}
            fault = ": means nothing beside repeat, which goes on in both directions"
        if foreign:
            raise PydanticCustomError("component", "{fault}", {"fault": min(foreign) + fault})
        return self


class ActionSpec(Table):
    """Values given at a time: tunable parameters, or inputs that are held."""

    at: Quantity
    set: dict[str, Quantity | Flag]


class FaultSpec(Table):
    """A fault injected into a component, `on` one of its outputs or on all of it.

    It begins `at` a time and ends at `until`, if ever; `size` is that of a bias, or the standard
    deviation of noise, which `seed` determines.
    """

    at: Quantity
    on: Text
    kind: Literal["drop", "freeze", "nan", "bias", "noise"]
    until: Quantity | None = None
    size: Quantity | None = None
    seed: Annotated[int, Field(strict=True, ge=0, lt=1 << 63)] = 0


class Wire(Table):
    """A connection between ports or single variables; `gain` and `offset` for variables."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)
    source: Annotated[Text, Field(alias="from")]
    target: Annotated[Text, Field(alias="to")]
    gain: Number = 1.0
    offset: Number = 0.0


class MasterSettings(Table):
    """The method that steps the components; `laws` sets how much of each port is connected.

    The `kind` follows from the wires where it is "auto":
    see :func:`orchestrator.scenario.plan.usual`.

    The rest is for some methods only: `degree` of the polynomial that carries plain numbers
    over a step (1, and 3 where a tolerance controls the steps), `acceleration` of iterations with
    its `relaxation`, when they count as `settled` (relative) and how many `passes` they get.
    """

    kind: Text = "auto"
    laws: Literal["held", "affine", "curvature"] = "curvature"
    order: list[Text] = []
    degree: Annotated[int, Field(strict=True, ge=1, le=3)] | None = None
    acceleration: Literal["none", "relaxed", "aitken", "anderson"] = "none"
    relaxation: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] = 0.5
    settled: Annotated[float, Field(strict=True, gt=0.0, lt=0.1)] = 1e-9
    passes: Annotated[int, Field(strict=True, ge=2, le=1000)] = 30


class Record(Table):
    """Which outputs are kept, by pattern, at every how many steps, and over what last stretch.

    `leading` are patterns of those whose error counts in studies and in the automatic step;
    without it, the recorded outputs that are wired count. Beside `extends`, `inherit = false`
    leaves out the whole table of the scenario that is extended; else patterns add to its own.
    """

    inherit: Annotated[Flag, Field(exclude=True)] = True

    variables: list[Text] = ["*"]
    leading: list[Text] = []
    every: Annotated[int, Field(strict=True, ge=1)] = 1
    last: Quantity | None = None


class Metrics(Table):
    """The metrics in a run's table, and over how many of the last cycles they are taken.

    Every other key is the name of a metric, its value an expression such as
    `peak_to_peak(linkage.flap_angle) in deg`: :mod:`orchestrator.scenario.metric_expression`.
    """

    model_config = ConfigDict(extra="allow", frozen=True)
    __pydantic_extra__: dict[str, Text] = Field(init=False)
    cycles: Annotated[int, Field(strict=True, ge=1)] = 5

    @property
    def defined(self) -> dict[str, str]:
        """Expressions by the names of their metrics."""
        return dict(self.__pydantic_extra__ or {})


class Scenario(Table):
    """A whole scenario, `extends` resolved; `without` lists what was left out on the way.

    `of_replaced` are record patterns and metrics that were inherited for another FMU or recording
    than their component has now: they are dropped where that lacks their variables.
    `plot` gives the panels of the plot: label, and patterns of variables, as
    `amplifier.*.voltage in kV`. `strict` refuses FMUs with findings that are warnings else.
    """

    title: Text = ""
    strict: Flag = False
    without: list[Text] = []
    of_replaced: list[Text] = []
    time: Time = Time()
    master: MasterSettings = MasterSettings()
    components: dict[str, Component] = {}
    wires: list[Wire] = []
    hold: dict[str, Quantity | Flag] = {}
    actions: list[ActionSpec] = []
    faults: list[FaultSpec] = []
    record: Record = Record()
    metrics: Metrics = Metrics()
    plot: dict[str, Text] = {}


def json_schema() -> dict[str, Any]:
    """JSON Schema of a scenario file, `extends` and `without` included.

    A component's `fmu` or `data` may come from the scenario that is extended.
    """
    schema = Scenario.model_json_schema(by_alias=True)
    schema["title"] = "Resilin scenario"
    del schema["properties"]["of_replaced"]
    schema["properties"] = {
        "extends": {"type": "string", "description": "Scenario that this one changes."},
        "without": {
            "type": "array",
            "items": {"type": "string"},
            "description": "Components left out, with their wires, holds and records.",
        },
        **schema["properties"],
    }
    return schema
