"""What is seen of a guarded run from outside: its answers, the places of its instances, its end."""

from __future__ import annotations

from time import perf_counter
from typing import Any

from ...errors import InitialisationError, InstanceFailure, OutputError
from ...fmi.instance.message_log import MessageLog
from ...fmi.instance.process import CLOSING_TIME, no_answer
from ...fmi.instance.protocol import Garbled
from ...results.outcome import Outcome, Report
from ...results.segments import Segments
from ...results.texts import Texts
from ..interrupt import Interrupt, Interrupted
from ..observers import Progress
from ..stepping import GridPoints
from .job import (
    DONE,
    FULL,
    MESSAGE,
    NOT_WRITTEN,
    REFUSED,
    REPORT,
    TEXT,
    WRITTEN,
    Job,
    raised,
    reported,
)
from .process import GuardedProcess
from .shared import Board, discard, written

TICK = 0.05
"""Seconds between two looks at the places, at most."""
UNREADABLE = "its process sent an answer that cannot be read"


class Spoiled(Exception):
    """A process that had carried out other jobs before has died: one of these may be the cause."""


class EndedInProbe(Exception):
    """A process has died while its FMUs were tried: the run itself has not begun."""


class Watch:
    """Watches a process until its job is done or it has ended, and makes an outcome of that."""

    def __init__(
        self,
        job: Job,
        process: GuardedProcess,
        *,
        segments: Segments | None = None,
        interrupt: Interrupt | None = None,
        bar: Progress | None = None,
    ) -> None:
        self._job, self._plan = job, job.plan
        self._process = process
        self._segments = segments
        self._texts = segments.texts if segments is not None else Texts(self._plan.text_names)
        self._texts.clear()
        self._interrupt = interrupt
        self._bar = bar
        self._board = Board(job.files.board, len(self._plan.order))
        self._logs = {name: MessageLog(name) for name in self._plan.order}
        self._report: dict[str, Any] | None = None
        self._refusal: Exception | None = None
        self._cause = ""
        self._turns: list[int] = []
        self._waited = 0.0
        self._looked = perf_counter()

    def outcome(self) -> Outcome:
        """Wait for the end; the run's outcome, or the error that kept it from its first step.

        Raises `Spoiled` or `EndedInProbe` where another process has to tell.
        """
        try:
            self._until_the_end()
        except Interrupted as error:
            self._process.kill()
            return self._from_outside(error)
        end = "" if self._process.idle else self._process.end()
        if self._refusal is not None:
            raise self._refusal
        if self._report is not None:
            if not self._process.idle:
                self._note_a_bad_end(self._cause or end)
            return self._reported(self._report)
        if self._process.used > 1 and not self._segments:
            raise Spoiled
        if self._board.header.probing:
            raise EndedInProbe
        culprit = self._culprit()
        text = self._cause or end
        if culprit is None:
            what = f"the process of its FMUs: {text}"
        else:
            what = f"{culprit}: {self._place(culprit)}: {text}{self._logs[culprit].ending()}"
        if not self._board.header.begun:
            raise InitialisationError(f"{self._plan.path}: {what}")
        return self._from_outside(InstanceFailure(what))

    def _until_the_end(self) -> None:
        """Take answers and look at the places until the process has ended, or is to be ended."""
        tick = min(TICK, 0.2 * min(limits.patience for limits in self._plan.limits.values()))
        while True:
            try:
                answers = self._process.answers(tick)
                if answers is None:
                    return
                for answer in answers:
                    self._take(*answer)
                if self._process.idle:
                    return
            except (Garbled, KeyError, IndexError, TypeError, ValueError):
                self._cause = UNREADABLE
            if not self._cause:
                self._look()
            if self._cause:
                self._process.kill()
                return

    def _take(self, letter: bytes, told: Any, values: bytes) -> None:
        if letter == MESSAGE:
            number, status, text = told
            self._logs[self._plan.order[int(number)]].add(int(status), str(text))
        elif letter == TEXT:
            name, time, text = told
            self._texts.note(str(name), float(time), str(text))
        elif letter == FULL:
            self._write_segment()
        elif letter == REPORT:
            self._report = reported(told, values)
        elif letter == REFUSED:
            self._refusal = raised(told)
        elif letter == DONE and (self._report or self._refusal):
            self._process.idle = True
        else:
            raise Garbled

    def _write_segment(self) -> None:
        """Move the rows from memory to disk; the process waits for the reply."""
        assert self._segments is not None
        try:
            self._segments.write(*self._rows())
        except OutputError as error:
            self._process.reply(NOT_WRITTEN, str(error).encode())
            return
        discard(self._job.files)
        self._process.reply(WRITTEN)

    def _look(self) -> None:
        """Signals and progress; and whether an instance is in one call for too long.

        Only time in which this process runs counts: a master that is stopped and continued keeps
        its instances.
        """
        now = perf_counter()
        passed, self._looked = min(now - self._looked, 2.0 * TICK), now
        if self._interrupt is not None:
            if self._interrupt.number:
                self._board.header.stop = self._interrupt.number
            else:
                self._interrupt.check()
        if self._bar is not None:
            time = max(place.time for place in self._board.places)
            self._bar.move(round((time - self._plan.grid.start) / self._plan.grid.step))
        turns = [place.turns for place in self._board.places]
        culprit = self._culprit()
        self._waited = self._waited + passed if culprit and turns == self._turns else 0.0
        self._turns = turns
        if culprit is not None:
            patience = self._plan.limits[culprit].patience
            if self._report is not None:
                patience = min(patience, CLOSING_TIME)
            if self._waited > patience:
                self._cause = no_answer(patience)

    def _culprit(self) -> str | None:
        """The instance that is amid a call."""
        for name, place in zip(self._plan.order, self._board.places, strict=True):
            if place.busy:
                return name
        return None

    def _place(self, name: str) -> str:
        """The call that an instance is in, in words."""
        return str(self._board.places[self._plan.order.index(name)])

    def _note_a_bad_end(self, how: str) -> None:
        """A crash or a hang once the run was over costs no row, and is said."""
        assert self._report is not None
        culprit = self._culprit() or self._plan.order[-1]
        known = self._report["reports"][culprit]
        text = f"{self._place(culprit)}: {how}"
        self._report["reports"][culprit] = Report(
            [*known.messages, text], known.warned + 1, known.warning or text
        )

    def _reported(self, report: dict[str, Any]) -> Outcome:
        """The outcome as the process has reported it, with the rows that it has left."""
        times, rows = self._rows()
        if isinstance(report["failure"], Interrupted) and self._interrupt is not None:
            try:
                self._interrupt.check()
            except Interrupted as error:
                report["failure"] = error
        if self._job.points is not None:
            report["points"] = self._job.points
        elif self._plan.scenario.time.tolerance is None:
            report["points"] = GridPoints(self._plan) if report["failure"] is None else []
        return Outcome(
            plan=self._plan,
            names=self._plan.record_names,
            times=times,
            rows=rows,
            texts=self._texts.changes,
            segments=self._segments,
            **report,
        )

    def _from_outside(self, failure: Exception) -> Outcome:
        """The outcome of a run that could not report: what stands in the shared memory."""
        times, rows = self._rows()
        named = dict(zip(self._plan.order, self._board.places, strict=True))
        begun = self._board.header.begun
        return Outcome(
            plan=self._plan,
            names=self._plan.record_names,
            times=times,
            rows=rows,
            texts=self._texts.changes,
            wall_time=perf_counter() - begun if begun else 0.0,
            steps=max(place.steps for place in named.values()),
            calls={name: place.steps for name, place in named.items()},
            failure=failure,
            rollbacks={name: place.rollbacks for name, place in named.items()},
            segments=self._segments,
            python_loop="unknown: its process ended without a report",
            reports={
                name: Report(log.texts, int(log.warning != ""), log.warning)
                for name, log in self._logs.items()
            },
        )

    def _rows(self) -> Any:
        """Times and rows that are whole by now."""
        return written(self._job.files, len(self._plan.records))
