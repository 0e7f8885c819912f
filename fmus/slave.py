"""Dataclasses to FMI variables: the one slave behind every part.

Call order, as FMI 2.0 has it: parameters, then initialisation mode (inputs in, outputs
out), then steps. Outputs follow the inputs as they are now, so a master that sets the
inputs of a communication point may read outputs that hold at that very point.

An error never leaves a step as an exception: it is logged with component, time and cause,
and the call returns "discard", after which the instance keeps its last good state.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import astuple, fields
from operator import attrgetter
from typing import Any, ClassVar

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from .part import Part
from .quantity import quantities


class PhysicsSlave(Fmi2Slave):
    """FMI co-simulation slave of a :class:`Part`.

    A part's own slave is a subclass that names the part; a build derives from that one and
    adds what identifies it, and the start values it changes. Values of
    all variables stand in one list by value reference: inputs, parameters, outputs. The
    state is one immutable record, so that an FMU state is a handful of references.
    """

    part: Part
    changes: ClassVar[dict[str, float]] = {}
    digest = ""
    sources = ""
    release = ""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        physics = self.part.physics
        self._variables = self.part.variables_with(self.changes)
        self._physics = physics
        inputs = len(quantities(physics.Input))
        parameters = len(quantities(physics.Params))
        self._inputs = slice(0, inputs)
        self._parameters = slice(inputs, inputs + parameters)
        self._outputs = slice(inputs + parameters, len(self._variables))
        self._read = _reader([field.name for field in fields(physics.Output)])
        self._values = [variable.start for variable in self._variables]
        self._params: Any = None
        self._state: Any = None
        self._running = False
        self._stale = True
        self._input: Any = None
        self._time = 0.0

    def to_xml(self, model_options: dict[str, str] | None = None) -> Any:
        """Describe the part; the exporter asks once, at build time."""
        del model_options
        from .model_description import model_description

        return model_description(
            self.part,
            type(self).__name__,
            self.digest,
            self.release,
            self._variables,
            sources=self.sources,
        )

    def setup_experiment(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        del stop_time, tolerance
        self._time = start_time

    def exit_initialization_mode(self) -> None:
        """Freeze parameters and initial state; a fault here ends the instance."""
        try:
            self._initialise()
            self._refresh()
        except Exception as error:
            self._report("initialisation", error)
            raise
        self._running = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        try:
            u = self._input or self._gathered()
            if not math.isfinite(sum(self._values[self._inputs])):
                raise ValueError(self._first_not_finite())
            self._time = current_time
            state = self._physics.advance(self._params, self._state, u, current_time, step_size)
        except Exception as error:
            self._report("step", error)
            return False
        self._state = state
        self._time = current_time + step_size
        self._stale = True
        return True

    def get_real(self, vrs: list[int]) -> list[float]:
        values = self._values
        if self._stale:
            self._observe(vrs)
        return [values[reference] for reference in vrs]

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        own = self._values
        for reference, value in zip(vrs, values):  # noqa: B905  (the exporter pairs them)
            own[reference] = value
        self._input = None
        self._stale = True
        if self._running and max(vrs, default=-1) >= self._inputs.stop:
            self._retune()

    def get_integer(self, vrs: list[int]) -> list[int]:
        return [int(self._values[reference]) for reference in vrs]

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        self.set_real(vrs, [float(value) for value in values])

    def _get_fmu_state(self) -> Any:
        return (tuple(self._values), self._params, self._state, self._time, self._running)

    def _set_fmu_state(self, state: Any) -> None:
        values, self._params, self._state, self._time, self._running = state
        self._values[:] = values
        self._input = None
        self._stale = True

    @staticmethod
    def _fmu_state_to_bytes(state: Any) -> bytes:
        values, params, inner, time, running = state
        records = [None if record is None else astuple(record) for record in (params, inner)]
        return json.dumps([values, *records, time, running]).encode()

    @classmethod
    def _fmu_state_from_bytes(cls, state: bytes) -> Any:
        values, params, inner, time, running = json.loads(state.decode())
        physics = cls.part.physics
        return (
            tuple(values),
            None if params is None else physics.Params(*params),
            None if inner is None else physics.State(*inner),
            time,
            running,
        )

    def _retune(self) -> None:
        """Take over parameters set in mid-run; a bad one is refused and the old ones stay."""
        try:
            self._tune()
        except Exception as error:
            self._values[self._parameters] = list(astuple(self._params))
            self._report("parameter", error)

    def _tune(self) -> None:
        """Parameters from the values as they are now, within their bounds."""
        values = self._values[self._parameters]
        for variable, value in zip(self._variables[self._parameters], values, strict=True):
            least, most = variable.quantity.least, variable.quantity.most
            if not math.isfinite(value) or not (
                (least is None or value >= least) and (most is None or value <= most)
            ):
                bounds = f"{least if least is not None else '-inf'} to "
                bounds += f"{most if most is not None else 'inf'} {variable.quantity.unit}"
                raise ValueError(f"{variable.name} = {value:g} is outside {bounds}")
        self._params = self._physics.Params(*values)

    def _initialise(self) -> None:
        """Parameters within their bounds, and the state they start from."""
        self._tune()
        self._state = self._physics.initial(self._params, self._gathered(), self._time)

    def _gathered(self) -> Any:
        """The inputs as they are now, as the physics takes them."""
        self._input = self._physics.Input(*self._values[self._inputs])
        return self._input

    def _refresh(self) -> None:
        """Outputs from the state and the inputs as they are now."""
        u = self._input or self._gathered()
        output = self._physics.observe(self._params, self._state, u, self._time)
        self._values[self._outputs] = self._read(output)
        self._stale = False

    def _observe(self, vrs: list[int]) -> None:
        """Bring the outputs up to date if any of `vrs` is one; a fault reads as NaN."""
        first = self._outputs.start
        if max(vrs, default=-1) < first:
            return
        try:
            if not self._running:
                self._initialise()
            self._refresh()
        except Exception as error:
            self._report("output", error)
            count = self._outputs.stop - first
            self._values[self._outputs] = [math.nan] * count

    def _first_not_finite(self) -> str:
        for variable, value in zip(self._variables, self._values):  # noqa: B905
            if variable.causality == "input" and not math.isfinite(value):
                return f"input {variable.name} is {value}"
        return "inputs are too large to add"

    def _report(self, call: str, error: Exception) -> None:
        cause = str(error) if isinstance(error, ValueError) else repr(error)
        message = f"{self.instance_name}: {call} at t = {self._time:g} s: {cause}"
        self.log(message, Fmi2Status.error)


def _reader(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """All of these attributes in a tuple; of one alone `attrgetter` would give the bare value."""
    read = attrgetter(*names)
    return read if len(names) > 1 else lambda record: (read(record),)
