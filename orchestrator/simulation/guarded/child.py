"""The process of a guarded run: all instances of a plan, stepped here.

Started as `python -m orchestrator.simulation.guarded.child` with a pipe as standard input, from
which it takes its job, and one as standard output for its answers; what FMUs print goes to
standard error.
"""

from __future__ import annotations

import importlib
import os
import pickle
import sys
from collections.abc import Callable
from contextlib import chdir
from pathlib import Path
from time import perf_counter
from typing import Any

from ...errors import InputError, OutputError, SimulationError
from ...fmi.description import Interface
from ...fmi.instance import Instance
from ...fmi.instance.child_process import limit_memory, serve_pipes
from ...fmi.instance.placed import placed_instance
from ...fmi.instance.protocol import COMMAND, answer, read_exactly, write_all
from ...results.texts import Texts
from ...scenario.processes import shared_memory
from ..interrupt import Interrupt, Interrupted
from ..rollback_probe import Spent, check_rollback
from ..stepping import stepped
from ..system import System, home
from .job import DONE, FULL, MESSAGE, REFUSED, REPORT, TEXT, WRITTEN, Job, noted, report
from .shared import Board, Header, SharedRows


class StopFlag(Interrupt):
    """The signal that the master has had, which this process sees on the board."""

    def __init__(self, header: Header) -> None:
        super().__init__()
        self._header = header

    def check(self) -> None:
        """Raise `Interrupted` if the master has had a signal."""
        if self._header.stop:
            raise Interrupted(self._header.stop)


class Pipe:
    """The pipe to the master, and its answers."""

    def __init__(self, commands: int, answers: int) -> None:
        self._commands, self._answers = commands, answers

    def take(self) -> tuple[bytes, bytes]:
        """Letter and payload of the next command."""
        letter, size = COMMAND.unpack(read_exactly(self._commands, COMMAND.size))
        return letter, read_exactly(self._commands, size)

    def tell(self, letter: bytes, told: Any, values: bytes = b"") -> None:
        """Send an answer."""
        write_all(self._answers, answer(letter, told, values))


class DistantSegments:
    """Segments that the master writes, of the rows that both processes see."""

    def __init__(self, pipe: Pipe) -> None:
        self._pipe = pipe

    def write(self, times: object, rows: object) -> None:
        """Have all rows in memory written and discarded; `OutputError` where they are not."""
        self._pipe.tell(FULL, None)
        letter, text = self._pipe.take()
        if letter != WRITTEN:
            raise OutputError(text.decode())


class DistantTexts(Texts):
    """Texts that the master keeps: it hears of each change."""

    def __init__(self, names: list[str], pipe: Pipe) -> None:
        super().__init__(names)
        self._pipe = pipe

    def note(self, name: str, time: float, text: str) -> bool:
        changed = super().note(name, time, text)
        if changed:
            self._pipe.tell(TEXT, [name, time, text])
        return changed


def serve(pipe: Pipe) -> None:
    """Carry out jobs until the pipe ends, within the memory of the first."""
    job: Job = pickle.loads(pipe.take()[1])
    _prepare(job)
    while True:
        with chdir(Path.cwd()):
            _carry_out(job, pipe)
        pipe.tell(DONE, None)
        job = pickle.loads(pipe.take()[1])


def _prepare(job: Job) -> None:
    """Import what the instances of a job need, then limit the memory.

    A recording is of no version of FMI, and needs nothing.
    """
    for version in {interface.version for interface in job.plan.interfaces.values()} - {0}:
        importlib.import_module(f"fmpy.fmi{version}")
    limit_memory(shared_memory(job.plan))


def _carry_out(job: Job, pipe: Pipe) -> None:
    """Step a plan; the report goes out before its instances are closed."""
    board = Board(job.files.board, len(job.plan.order))
    folder = home(job.plan)
    try:
        with System(job.plan, _opened_here(job, folder, board, pipe)) as system:
            os.chdir(folder)
            if job.probe:
                board.header.probing = 1
                check_rollback(system, job.points)
                board.header.probing = 0
            board.header.begun = perf_counter()
            outcome = stepped(
                system,
                job.points,
                interrupt=StopFlag(board.header),
                segments=DistantSegments(pipe) if job.segmented else None,
                memory=SharedRows(job.files),
                texts=DistantTexts(job.plan.text_names, pipe),
            )
            on_grid = job.points is not None or job.plan.scenario.time.tolerance is None
            pipe.tell(REPORT, *report(outcome, on_grid))
    except (InputError, SimulationError) as error:
        pipe.tell(REFUSED, noted(error))
    except Spent:
        sys.exit()  # the master sees where it was, and takes another process


def _opened_here(job: Job, working: Path, board: Board, pipe: Pipe) -> Callable[..., Instance]:
    """What opens the instances of a system in this process, each at its place on the board.

    They work in the folder `working`; until all are open names of files are those of the master.
    """

    def opened(name: str, interface: Interface, folder: Path) -> Instance:
        number = job.plan.order.index(name)

        def pass_on(status: int, text: str) -> None:
            pipe.tell(MESSAGE, [number, status, text])

        with chdir(working):
            return placed_instance(name, interface, folder, board.places[number], pass_on)

    return opened


def main() -> None:
    """Take the pipes off the standard streams and serve."""
    serve_pipes(lambda commands, answers: serve(Pipe(commands, answers)))


if __name__ == "__main__":
    main()
