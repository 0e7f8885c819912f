"""The process of an isolated instance: one FMU instance behind a pipe.

Started as `python -m orchestrator.fmi.instance.isolated_child` with the pipe as standard input
and output; what the FMU itself prints goes to standard error. It ends when the pipe does; one that
hangs then is ended by the keeper of its master.
"""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import FmuError, InstanceFailure
from ..description import Interface, Variable, read_interface
from . import in_process
from .child_process import limit_memory, serve_pipes
from .in_process import InProcessInstance
from .protocol import COMMAND, STEP, answer, read_exactly, write_all


class Host:
    """The instance, its buffers, and one method for each command."""

    def __init__(self) -> None:
        self.instance: InProcessInstance | None = None
        self.interface: Interface | None = None
        self.reported = 0
        self.states: dict[int, Any] = {}
        self.inputs = np.zeros(0)
        self.outputs = np.zeros(0)

    def serve(self, commands: int, answers: int) -> None:
        """Answer commands until the pipe ends."""
        while True:
            letter, size = COMMAND.unpack(read_exactly(commands, COMMAND.size))
            payload = read_exactly(commands, size)
            try:
                text, values = self.execute(letter.decode(), payload)
                reply = answer(b"k", self._with_messages(text), values)
            except InstanceFailure as error:
                reply = answer(b"f", self._with_messages(str(error)))
            except FmuError as error:
                reply = answer(b"e", self._with_messages(str(error)))
            write_all(answers, reply)

    def _with_messages(self, text: Any) -> Any:
        """Text of an answer, with the messages that have come since the last answer."""
        fresh: list[tuple[int, str]] = []
        warned = 0
        if self.instance is not None:
            warned, self.instance.warned = self.instance.warned, 0
            if self.instance.message_count > self.reported:
                fresh = self.instance.logged[self.reported - self.instance.message_count :]
                self.reported = self.instance.message_count
        if text is None and not fresh and not warned:
            return None
        return {"text": text, "messages": fresh, "warned": warned}

    def execute(self, letter: str, payload: bytes) -> tuple[Any, bytes]:
        """Carry out one command; text and values of the answer."""
        if letter == "o":
            given = json.loads(payload)
            limit_memory(given["memory"])
            self.interface = read_interface(Path(given["path"]))
            importlib.import_module(f"fmpy.fmi{self.interface.version}")
            return None, b""
        if letter == "n" and self.interface is not None:
            given = json.loads(payload)
            self.instance = in_process(given["name"], self.interface, Path(given["folder"]))
            return None, b""
        if self.instance is None:
            raise InstanceFailure("the instance is not open yet")
        return self._execute(self.instance, letter, payload)

    def _execute(
        self, instance: InProcessInstance, letter: str, payload: bytes
    ) -> tuple[Any, bytes]:
        if letter == "d":
            size = STEP.size
            moment, step, fresh = STEP.unpack(payload[:size])
            if fresh:
                self.inputs[:] = np.frombuffer(payload[size:])
                instance.send()
            instance.step(moment, step)
            instance.receive()
            return None, self.outputs.tobytes()
        if letter == "g":
            if len(payload) > 1:
                self.inputs[:] = np.frombuffer(payload[1:])
                instance.send()
            if payload[0]:
                instance.receive()
            return None, self.outputs.tobytes()
        if letter == "s":
            number = max(self.states, default=0) + 1
            self.states[number] = instance.save()
            return number, b""
        return self._control(instance, letter, json.loads(payload or b"null")), b""

    def _control(self, instance: InProcessInstance, letter: str, given: Any) -> Any:
        if letter == "r":
            instance.restore(self.states[given])
        elif letter == "f":
            instance.forget(self.states.pop(given))
        elif letter == "p":
            instance.prepare(*given)
        elif letter == "t":
            instance.set(given)
        elif letter == "c":
            self._connect(instance, given)
        elif letter == "i":
            instance.enter_initialisation()
        elif letter == "x":
            instance.exit_initialisation()
        elif letter == "w":
            known = instance.interface.variables
            return instance.texts([known[name] for name in given])
        elif letter == "q":
            instance.close()
        return None

    def _connect(self, instance: InProcessInstance, given: Any) -> None:
        known = instance.interface.variables
        inputs: list[Variable] = [known[name] for name in given["inputs"]]
        outputs = [known[name] for name in given["outputs"]]
        self.inputs, self.outputs = np.zeros(len(inputs)), np.zeros(len(outputs))
        instance.connect(inputs, self.inputs, [outputs], self.outputs)


def main() -> None:
    """Take the pipe off the standard streams and serve."""
    serve_pipes(lambda commands, answers: Host().serve(commands, answers))


if __name__ == "__main__":
    main()
