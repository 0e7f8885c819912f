"""An instance with faults injected: it drops out, or its outputs are falsified."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import InstanceFailure
from ..fmi.description import Variable
from ..fmi.instance.base import Instance, Values
from ..scenario.faults import Fault

GRAIN = 1e-12
"""Seconds within which two times are one."""


class FaultyInstance(Instance):
    """A wrapped instance and its faults; calls that no fault concerns are passed on unchanged."""

    def __init__(self, instance: Instance, faults: Sequence[Fault]) -> None:
        super().__init__(instance.name, instance.interface)
        self._instance = instance
        self._log = instance._log
        self._drops = [fault for fault in faults if fault.kind == "drop"]
        self._falsified = [fault for fault in faults if fault.kind != "drop"]
        self._places: list[list[int]] = []
        self._time = 0.0

    def prepare(
        self,
        start: dict[str, float | str],
        time: float,
        stop: float | None,
        tolerance: float | None,
    ) -> None:
        """Pass on, and note the start time."""
        self._time = time
        self._instance.prepare(start, time, stop, tolerance)

    def connect(
        self,
        inputs: list[Variable],
        input_values: Values,
        outputs: list[list[Variable]],
        output_values: Values,
    ) -> None:
        """Pass on, with a separate buffer for the true outputs."""
        self._output = output_values
        self._true = np.zeros_like(output_values)
        names = [variable.name for group in outputs for variable in group]
        self._ends = np.cumsum([len(group) for group in outputs]).tolist()
        self._places = [
            [k for k, name in enumerate(names) if name in fault.variables]
            for fault in self._falsified
        ]
        self._frozen = np.zeros_like(output_values)
        self._instance.connect(inputs, input_values, outputs, self._true)

    def read_whole_at_once(self) -> None:
        """Pass on."""
        self._instance.read_whole_at_once()
        self._ends = [self._ends[-1]] * len(self._ends)

    def enter_initialisation(self) -> None:
        """Pass on."""
        self._instance.enter_initialisation()

    def exit_initialisation(self) -> None:
        """Pass on."""
        self._instance.exit_initialisation()

    def send(self) -> None:
        """Pass on."""
        self._instance.send()

    def step(self, time: float, size: float) -> None:
        """Step the instance, unless it has dropped out by the end of this step."""
        for fault in self._drops:
            if fault.begin < time + size - GRAIN and time < fault.end - GRAIN:
                raise InstanceFailure(
                    f"{self.name}: step to t = {time + size:.9g} s: has dropped out (a fault of"
                    f" the scenario, from t = {fault.begin:.9g} s)"
                )
        self._instance.step(time, size)
        self._time = time + size
        self.steps, self.rollbacks = self._instance.steps, self._instance.rollbacks
        self.warned = self._instance.warned

    def receive(self, group: int = -1) -> None:
        """Read the outputs, then falsify those that have a fault at this time."""
        self._instance.receive(group)
        end = self._ends[group]
        self._output[:end] = self._true[:end]
        for fault, places in zip(self._falsified, self._places, strict=True):
            now = fault.begin - GRAIN <= self._time < fault.end - GRAIN
            for k in (k for k in places if k < end):
                if not now:
                    self._frozen[k] = self._true[k]
                elif fault.kind == "freeze":
                    self._output[k] = self._frozen[k]
                elif fault.kind == "nan":
                    self._output[k] = np.nan
                elif fault.kind == "bias":
                    self._output[k] += fault.size
                else:
                    self._output[k] += fault.size * _deviate(fault.seed, self._time)

    def texts(self, variables: list[Variable]) -> list[str]:
        """Pass on: no fault concerns a text."""
        return self._instance.texts(variables)

    def set(self, start: dict[str, float | str]) -> None:
        """Pass on."""
        self._instance.set(start)

    def save(self) -> Any:
        """State of the instance, the time, and the frozen outputs."""
        return self._instance.save(), self._time, self._frozen.copy()

    def restore(self, state: Any) -> None:
        """Go back to a saved state."""
        inner, self._time, frozen = state
        self._frozen[:] = frozen
        self._instance.restore(inner)
        self.rollbacks = self._instance.rollbacks

    def forget(self, state: Any) -> None:
        """Free a saved state."""
        self._instance.forget(state[0])

    def close(self) -> None:
        """Free the instance."""
        self._instance.close()


def _deviate(seed: int, time: float) -> float:
    """Normal deviate that a seed and a time determine."""
    grain = struct.unpack("<Q", struct.pack("<d", round(time, 12)))[0]
    return float(np.random.default_rng([seed, grain]).standard_normal())
