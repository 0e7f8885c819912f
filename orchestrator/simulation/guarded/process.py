"""The process of a guarded run as its master holds it: started, given jobs, ended for certain."""

from __future__ import annotations

import os
import pickle
import select
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from ...errors import InitialisationError
from ...fmi.instance.process import Tail, dispose, ended, how_it_ended, kill, started
from ...fmi.instance.protocol import Frames, Gone, command, write_all
from ...scenario.plan import Plan
from ...scenario.processes import shared_memory
from ..scratch import Scratch
from .job import Job
from .shared import Files

MODULE = "orchestrator.simulation.guarded.child"
MOST_READ = 1 << 20


class GuardedProcess:
    """A process that carries out one job after the other; `close` leaves nothing behind.

    `used` counts its jobs, `idle` is true between two of them.
    """

    def __init__(self, plan: Plan) -> None:
        self.files = Files.made()
        self.used = 0
        self.idle = False
        self._memory = shared_memory(plan)
        self._frames = Frames()
        self._stack = ExitStack()
        self._stack.callback(self.files.close)
        with ExitStack() as made:
            made.push(self._stack.__exit__)
            scratch = self._stack.enter_context(Scratch(plan.path))
            self._process = self._started(plan, scratch)
            made.pop_all()
        self._tail = Tail(self._process.stderr)
        self._to, self._from = self._process.stdin.fileno(), self._process.stdout.fileno()

    def _started(self, plan: Plan, scratch: Path) -> Any:
        descriptors = (self.files.board, self.files.times, self.files.rows)
        try:
            return started(MODULE, Path.cwd(), pass_fds=descriptors, scratch=scratch)
        except OSError as error:
            raise InitialisationError(
                f"{plan.path}: the process of its FMUs cannot be started ({error.strerror})"
            ) from None

    def carry_out(self, job: Job) -> None:
        """Give it a job, which shares its files."""
        self.files.clear(len(job.plan.order))
        self.used += 1
        self.idle = False
        self.reply(b"j", pickle.dumps(job))

    def reply(self, letter: bytes, payload: bytes = b"") -> None:
        """Send a command; nothing where the process is gone, which its answers will tell."""
        with suppress(Gone):
            write_all(self._to, command(letter, payload))

    def answers(self, seconds: float) -> list[tuple[bytes, Any, bytes]] | None:
        """Answers that come within some seconds; None once there will be no more.

        Raises `Garbled` for what is no answer.
        """
        if select.select([self._from], [], [], seconds)[0]:
            data = os.read(self._from, MOST_READ)
            return self._frames.feed(data) if data else None
        return None if self._is_over() else []

    def _is_over(self) -> bool:
        """Whether the process has ended: what it has started may hold its pipe open."""
        if self._process.returncode is not None:
            return True
        over = os.waitid(os.P_PID, self._process.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG)
        return over is not None

    def kill(self) -> None:
        """End the process, and what it has started, by force."""
        kill(self._process)

    def end(self) -> str:
        """Wait for its end, and say how it came."""
        return self._tail.behind(how_it_ended(ended(self._process), self._memory))

    def close(self) -> None:
        """Kill the process with all that it has started, and remove its files."""
        dispose(self._process, self._tail)
        self._stack.close()
