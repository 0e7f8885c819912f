"""The worker pool: points are given to workers one by one, so that one that fails fails alone."""

from __future__ import annotations

import contextlib
import math
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from time import monotonic
from typing import Any, Generic, Self, TypeVar

from ...errors import InputError, SimulationError
from ...extras import require
from . import dask_cluster
from .dask_cluster import Client

Answer = dict[str, Any]
Item = TypeVar("Item")
"""A point: of a sweep, or a case of a stability study."""

TICK = 0.1
"""Seconds after which interrupts, hung points and ended workers are looked for again."""

LOOK = 1.0
"""Seconds after which workers that are being started are looked for again."""

DESERTED = 60
"""Looks without any worker, or a nanny that starts one, after which the pool gives up."""

STARTS = 5
"""Processes of one nanny that may end one after the other before they register."""

RECYCLED = 2000
"""Points after which a worker is replaced: each instance leaks some kilobytes."""


@dataclass(frozen=True)
class Failed:
    """A point without an answer; `again` where its worker process ended.

    Such a point is tried once more: another point in the same process may have been the cause.
    """

    reason: str
    again: bool


@dataclass(frozen=True)
class _Running(Generic[Item]):
    point: Item
    future: Any
    begun: float
    last: bool


class WorkerPool(Generic[Item]):
    """Workers that run one point at a time each; they are started with the first point.

    Where a worker process ends, its point is tried once more while nothing else runs; the worker
    of a point that takes longer than `patience` seconds is killed.
    """

    def __init__(
        self,
        task: Callable[[Item], Answer],
        workers: int | None,
        scheduler: str | None = None,
        patience: float | None = None,
    ) -> None:
        self._task = task
        self._workers = workers
        self._scheduler = scheduler
        self._patience = math.inf if patience is None else patience
        self._stack = contextlib.ExitStack()
        self._client: Client | None = None
        self._running: dict[str, _Running[Item]] = {}
        self._leaving: set[str] = set()
        self._done: Counter[str] = Counter()
        self._wake = threading.Event()
        self._nannies: set[str] = set()
        self._known: set[str] = set()
        self._begun: set[tuple[str, int]] = set()
        self._looks = 0
        self._look = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for address in list(self._running):
            self._drop(address)
        self._stack.close()

    def answers(
        self, points: Iterable[Item], check: Callable[[], None]
    ) -> Iterator[tuple[Item, Answer | Failed]]:
        """The answer of each point, as soon as it is known; `check` may raise at any tick.

        `InputError` where a worker cannot run points at all, `SimulationError` where no worker
        is left.
        """
        waiting = deque(points)
        alone: deque[Item] = deque()
        client = self._opened(len(waiting)) if waiting else None
        while client is not None and (waiting or alone or self._running):
            check()
            here = self._here(client)
            finished = []
            for running, answer in list(self._finished(here, client)):
                if isinstance(answer, Failed) and answer.again and not running.last:
                    alone.append(running.point)
                else:
                    finished.append((running.point, answer))
            self._send(client, here, waiting, alone)
            yield from finished
            self._wake.wait(TICK)
            self._wake.clear()

    def _opened(self, points: int) -> Client:
        if self._client is None:
            require("work in other processes", *dask_cluster.PACKAGES)
            if self._scheduler is not None:
                opening = dask_cluster.remote(self._scheduler)
            else:
                from dask.system import CPU_COUNT

                opening = dask_cluster.local(min(self._workers or CPU_COUNT, max(2, points)))
            self._client = self._stack.enter_context(opening)
        return self._client

    def _here(self, client: Client) -> list[str]:
        """Addresses of the registered workers; `SimulationError` where the scheduler is gone."""
        try:
            if client.status != "running":
                raise OSError("connection lost")
            here = list(client.nthreads())
            if not self._known.issuperset(here):
                self._nannies |= dask_cluster.nannies(client)
        except (OSError, TimeoutError, AttributeError) as error:
            where = self._scheduler or "of this machine"
            raise SimulationError(f"the scheduler {where} is gone ({error})") from None
        self._leaving &= set(here)
        self._known = set(here)
        if self._known - self._leaving:
            self._looks = 0
            self._begun.clear()
        else:
            self._await_start(client)
        return here

    def _await_start(self, client: Client) -> None:
        """Wait on while a worker is being started, however slowly; `SimulationError` otherwise.

        Nannies report which process they start: one that runs is waited for, those that end
        before they register are counted.
        """
        if monotonic() < self._look:
            return
        found = dask_cluster.starting(client, self._nannies)
        self._look = monotonic() + LOOK
        self._looks = 0 if found else self._looks + 1
        self._begun |= {(nanny, pid) for nanny, pid in found.items() if pid is not None}
        if len(self._begun) > STARTS * len(self._nannies):
            raise SimulationError(
                f"{len(self._begun)} worker processes ended one after the other before they could"
                " run points: out of memory, or a package that cannot be loaded"
            )
        if self._looks > DESERTED:
            raise SimulationError(
                f"no worker has been there for {DESERTED * LOOK:g} s, and none is being started;"
                " start workers for this scheduler"
            )

    def _send(
        self, client: Client, here: list[str], waiting: deque[Item], alone: deque[Item]
    ) -> None:
        """Give points to free workers; those that are to run alone when all else is done."""
        for address in here:
            if address in self._running or address in self._leaving:
                continue
            if self._done[address] >= RECYCLED:
                self._dismiss(client, address)
            elif waiting:
                self._launch(client, address, waiting.popleft(), last=False)
            elif alone and not self._running:
                self._launch(client, address, alone.popleft(), last=True)

    def _launch(self, client: Client, address: str, point: Item, *, last: bool) -> None:
        future = client.submit(
            self._task, point, workers=[address], pure=False, retries=0, allow_other_workers=False
        )
        future.add_done_callback(lambda _: self._wake.set())
        self._running[address] = _Running(point, future, monotonic(), last)

    def _finished(
        self, here: list[str], client: Client
    ) -> Iterator[tuple[_Running[Item], Answer | Failed]]:
        """Points that no longer run, with their answer or why there is none."""
        for address, running in list(self._running.items()):
            spent = monotonic() - running.begun
            if running.future.done():
                read = self._read(client, running.future, address)
                if read is None and address in here:
                    continue
                answer = read if read is not None else _ended()
            elif address not in here:
                answer = _ended()
            elif spent > self._patience:
                answer = Failed(
                    f"no answer within {self._patience:g} s; its worker was ended", False
                )
            else:
                continue
            self._drop(address)
            self._done[address] += 1
            if isinstance(answer, Failed) and not answer.again:
                self._dismiss(client, address)
            yield running, answer

    def _read(self, client: Client, future: Any, address: str) -> Answer | Failed | None:
        """A finished task's answer, `None` where it has not arrived yet.

        `InputError` where the worker could not run it.
        """
        from distributed import KilledWorker

        try:
            answer: Answer = future.result(timeout=dask_cluster.CONNECTING)
        except KilledWorker:
            return _ended()
        except TimeoutError:
            return None
        except Exception as error:
            if future.status == "cancelled":
                self._here(client)
                return _ended()
            raise InputError(
                f"worker {address} cannot run points ({type(error).__name__}: {error});"
                " install the same version of resilin there"
            ) from None
        if "unfit" in answer:
            raise InputError(
                f"worker {address}: {answer['unfit']}; workers need the same resilin, and the"
                " sweep's scenario and FMU files at the same place"
            )
        return answer

    def _drop(self, address: str) -> None:
        running = self._running.pop(address)
        with contextlib.suppress(Exception):
            running.future.cancel()

    def _dismiss(self, client: Client, address: str) -> None:
        """Replace a worker; it is given no more points."""
        self._leaving.add(address)
        self._done.pop(address, None)
        dask_cluster.end(client, address)


def _ended() -> Failed:
    return Failed("its worker process ended twice: a crash, or out of memory", again=True)
