"""An instance in a process of its own: a crash, a hang or full memory ends that process alone."""

from __future__ import annotations

import json
import math
import subprocess
import threading
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import FmuError, InstanceFailure
from ..description import Interface, Variable
from .base import Instance, Limits, Values
from .place import step_text
from .process import CLOSING_TIME, Tail, dispose, ended, how_it_ended, kill, no_answer, started
from .protocol import STEP, Garbled, Gone, command, read_answer, write_all


class IsolatedInstance(Instance):
    """The master's end of an isolated instance.

    A step is one round trip: inputs, doStep and outputs together. Where a call has no answer
    within `limits.patience`, the process is killed; before the first call of the FMU a running
    process is waited for, however long it takes to start. `_lost` is set once the process has
    ended, and while an answer is outstanding.
    """

    def __init__(
        self,
        name: str,
        interface: Interface,
        folder: Path,
        limits: Limits,
        working: Path | None = None,
    ) -> None:
        super().__init__(name, interface)
        self._limits = limits
        self._inputs: Values = np.zeros(0)
        self._outputs: Values = np.zeros(0)
        self._fresh = False
        self._current = False
        self._lost = False
        self._reason = f"{name}: its process has been given up"
        try:
            self._process = started("orchestrator.fmi.instance.isolated_child", working or folder)
        except OSError as error:
            reason = f"its process cannot be started ({error.strerror})"
            raise InstanceFailure(f"{name}: {reason}") from None
        assert self._process.stdin and self._process.stdout and self._process.stderr
        self._to, self._from = self._process.stdin.fileno(), self._process.stdout.fileno()
        self._output_tail = Tail(self._process.stderr)
        self._watch = _Watch(self._process, math.inf)
        try:
            path, memory = str(interface.path.resolve()), limits.memory
            self._ask(b"o", {"path": path, "memory": memory}, "starting its process")
            self._watch.patience = limits.patience
            self._ask(b"n", {"name": name, "folder": str(folder.resolve())}, "instantiating")
        except BaseException:
            self.close()
            raise

    def _ask(self, letter: bytes, given: Any, what: str) -> Any:
        """Send a command with JSON; the text of the answer."""
        payload = b"" if given is None else json.dumps(given).encode()
        return self._exchange(letter, payload, what)[0]

    def _exchange(self, letter: bytes, payload: bytes, what: str) -> tuple[Any, bytes]:
        """One round trip; `InstanceFailure` where the FMU fails or its process does not answer."""
        if self._lost:
            raise InstanceFailure(self._reason)
        self._lost = True
        self._watch.begin()
        try:
            write_all(self._to, command(letter, payload))
            kind, text, log, values = read_answer(self._from)
        except Gone:
            self._reason = f"{self.name}: {what}: {self._end_of_process()}{self.last_message()}"
            raise InstanceFailure(self._reason) from None
        except Garbled:
            self._reason = f"{self.name}: {what}: its process sent an answer that cannot be read"
            raise InstanceFailure(self._reason) from None
        finally:
            self._watch.end()
        self._lost = False
        for status, message in log.messages:
            self.log(status, message)
        self.warned += log.warned
        if kind == b"k":
            return text, values
        raise (FmuError if kind == b"e" else InstanceFailure)(str(text))

    def _end_of_process(self) -> str:
        """How the process ended, which has closed its pipe; the watch kills one that runs on."""
        code = ended(self._process)
        if self._watch.fired:
            end = no_answer(self._watch.patience)
        else:
            end = how_it_ended(code, self._limits.memory)
        return self._output_tail.behind(end)

    def prepare(
        self,
        start: dict[str, float | str],
        time: float,
        stop: float | None,
        tolerance: float | None,
    ) -> None:
        self._ask(b"p", [start, time, stop, tolerance], "setting start values")

    def set(self, start: dict[str, float | str]) -> None:
        self._ask(b"t", start, "setting parameters")
        self._current = False

    def connect(
        self,
        inputs: list[Variable],
        input_values: Values,
        outputs: list[list[Variable]],
        output_values: Values,
    ) -> None:
        self._inputs, self._outputs = input_values, output_values
        names = [v.name for group in outputs for v in group]
        self._ask(b"c", {"inputs": [v.name for v in inputs], "outputs": names}, "connecting")

    def read_whole_at_once(self) -> None:
        """Nothing to do: an isolated instance always reads all outputs."""

    def enter_initialisation(self) -> None:
        self._ask(b"i", None, "entering initialisation")

    def exit_initialisation(self) -> None:
        self._ask(b"x", None, "leaving initialisation")

    def send(self) -> None:
        """Leave the inputs to the next call, which passes them on."""
        self._fresh = True
        self._current = False

    def step(self, time: float, size: float) -> None:
        self.steps += 1
        payload = STEP.pack(time, size, self._fresh)
        if self._fresh:
            payload += self._inputs.tobytes()
        what = step_text(time, size)
        self._take(self._exchange(b"d", payload, what)[1])

    def receive(self, group: int = -1) -> None:
        if not self._current:
            payload = b"\x01" + (self._inputs.tobytes() if self._fresh else b"")
            self._take(self._exchange(b"g", payload, "reading outputs")[1])

    def _take(self, values: bytes) -> None:
        self._fresh = False
        self._current = True
        if len(values) != self._outputs.nbytes:
            raise InstanceFailure(f"{self.name}: its process sent other values than were asked for")
        self._outputs[:] = np.frombuffer(values)

    def texts(self, variables: list[Variable]) -> list[str]:
        self._flush()
        found = self._ask(b"w", [v.name for v in variables], "reading texts")
        if not isinstance(found, list) or len(found) != len(variables):
            raise InstanceFailure(f"{self.name}: its process sent other texts than were asked for")
        return [str(text) for text in found]

    def _flush(self) -> None:
        """Pass on inputs that wait, before a state is saved or texts are read."""
        if self._fresh:
            self._exchange(b"g", b"\x00" + self._inputs.tobytes(), "setting inputs")
            self._fresh = False

    def save(self) -> Any:
        self._flush()
        return self._ask(b"s", None, "saving its state")

    def restore(self, state: Any) -> None:
        self.rollbacks += 1
        self._fresh = self._current = False
        self._ask(b"r", state, "going back to a state")

    def forget(self, state: Any) -> None:
        if not self._lost:
            self._ask(b"f", state, "freeing a state")

    def close(self) -> None:
        """End the process by a command or, where that fails, by force. No orphan is left."""
        try:
            if not self._lost:
                self._watch.patience = min(CLOSING_TIME, self._limits.patience)
                self._ask(b"q", None, "closing")
                self._lost = True
        except (InstanceFailure, FmuError, OSError) as error:
            self.log(0, str(error))
        finally:
            self._lost = True
            dispose(self._process, self._output_tail)
            self._watch.stop()


class _Watch:
    """Kills a process whose call has begun and not ended within `patience` seconds.

    Only time in which this process runs counts: a master that is stopped and continued keeps its
    instances.
    """

    def __init__(self, process: subprocess.Popen[bytes], patience: float) -> None:
        self.patience = patience
        self.fired = False
        self._process = process
        self._turns = 0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)
        self._thread.start()

    def begin(self) -> None:
        self._turns += 1

    def end(self) -> None:
        self._turns += 1

    def _look(self) -> None:
        seen, waited = 0, 0.0
        while not self._over.wait(pause := min(0.2, max(0.005, 0.2 * self.patience))):
            turns = self._turns
            waited = waited + pause if turns == seen and turns % 2 else 0.0
            seen = turns
            if waited > self.patience:
                self.fired = True
                kill(self._process)
                return

    def stop(self) -> None:
        self._over.set()
        self._thread.join()
