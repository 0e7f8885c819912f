"""Pieces of work handed to workers one by one, so that a sick one costs itself and no other."""

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
from . import dask_cluster
from .dask_cluster import Client

Answer = dict[str, Any]
Item = TypeVar("Item")
"""A piece of work: the point of a sweep, a case of a stability study."""

TICK = 0.1
"""Seconds after which interrupts, hung points and lost workers are looked for again."""

LOOK = 1.0
"""Seconds after which it is looked again for workers that are being started."""

DESERTED = 60
"""Looks without any worker, or a nanny that starts one, after which a sweep gives up."""

STARTS = 5
"""Processes of one nanny that may end one after the other before they report for work."""

RECYCLED = 2000
"""Points after which a worker is replaced: each instance leaves some kilobytes behind."""


@dataclass(frozen=True)
class Failed:
    """A point without an answer; `again` where its worker died, which may be another's fault."""

    reason: str
    again: bool


@dataclass(frozen=True)
class _InFlight(Generic[Item]):
    point: Item
    future: Any
    begun: float
    last: bool


class WorkerPool(Generic[Item]):
    """Workers that take one point at a time each; started when the first point is asked for.

    A worker that dies has its point tried once more while nothing else runs; a point over
    `patience` seconds has its worker killed.
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
        self._flights: dict[str, _InFlight[Item]] = {}
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
        for address in list(self._flights):
            self._drop(address)
        self._stack.close()

    def answers(
        self, points: Iterable[Item], check: Callable[[], None]
    ) -> Iterator[tuple[Item, Answer | Failed]]:
        """What became of each point, as it becomes known; `check` may raise at any tick.

        `InputError` where a worker cannot take up points at all, `SimulationError` where there
        is nobody left to give them to.
        """
        waiting = deque(points)
        alone: deque[Item] = deque()
        client = self._opened(len(waiting)) if waiting else None
        while client is not None and (waiting or alone or self._flights):
            check()
            here = self._here(client)
            landed = []
            for flight, answer in list(self._landed(here, client)):
                if isinstance(answer, Failed) and answer.again and not flight.last:
                    alone.append(flight.point)
                else:
                    landed.append((flight.point, answer))
            self._send(client, here, waiting, alone)
            yield from landed
            self._wake.wait(TICK)
            self._wake.clear()

    def _opened(self, points: int) -> Client:
        if self._client is None:
            if self._scheduler is not None:
                opening = dask_cluster.remote(self._scheduler)
            else:
                from dask.system import CPU_COUNT

                opening = dask_cluster.local(min(self._workers or CPU_COUNT, max(2, points)))
            self._client = self._stack.enter_context(opening)
        return self._client

    def _here(self, client: Client) -> list[str]:
        """Addresses of the workers that are there; `SimulationError` where nobody knows."""
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

        A nanny tells which process it starts: one that lives is waited for, those that end
        before they report are counted.
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
                " take up points: out of memory, or a package that cannot be loaded"
            )
        if self._looks > DESERTED:
            raise SimulationError(
                f"no worker has been there for {DESERTED * LOOK:g} s, and none is being started;"
                " start some"
            )

    def _send(
        self, client: Client, here: list[str], waiting: deque[Item], alone: deque[Item]
    ) -> None:
        """Give points to free workers; those that are to run alone when all else is done."""
        for address in here:
            if address in self._flights or address in self._leaving:
                continue
            if self._done[address] >= RECYCLED:
                self._dismiss(client, address)
            elif waiting:
                self._launch(client, address, waiting.popleft(), last=False)
            elif alone and not self._flights:
                self._launch(client, address, alone.popleft(), last=True)

    def _launch(self, client: Client, address: str, point: Item, *, last: bool) -> None:
        future = client.submit(
            self._task, point, workers=[address], pure=False, retries=0, allow_other_workers=False
        )
        future.add_done_callback(lambda _: self._wake.set())
        self._flights[address] = _InFlight(point, future, monotonic(), last)

    def _landed(
        self, here: list[str], client: Client
    ) -> Iterator[tuple[_InFlight[Item], Answer | Failed]]:
        """Flights that are over, whichever way."""
        for address, flight in list(self._flights.items()):
            spent = monotonic() - flight.begun
            if flight.future.done():
                answer = self._read(client, flight.future, address)
            elif address not in here:
                answer = _died()
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
            yield flight, answer

    def _read(self, client: Client, future: Any, address: str) -> Answer | Failed:
        """A finished task's answer; `InputError` where the worker was not fit for it."""
        from distributed import KilledWorker

        try:
            answer: Answer = future.result(timeout=dask_cluster.CONNECTING)
        except (KilledWorker, TimeoutError):
            return _died()
        except Exception as error:
            if future.status == "cancelled":
                self._here(client)
                return _died()
            raise InputError(
                f"worker {address} cannot take up points ({type(error).__name__}: {error});"
                " install the same version of resilin there"
            ) from None
        if "unfit" in answer:
            raise InputError(
                f"worker {address}: {answer['unfit']}; workers need the same resilin, and the"
                " sweep's scenario and FMU files at the same place"
            )
        return answer

    def _drop(self, address: str) -> None:
        flight = self._flights.pop(address)
        with contextlib.suppress(Exception):
            flight.future.cancel()

    def _dismiss(self, client: Client, address: str) -> None:
        """Have a worker replaced; nothing is given to it any more."""
        self._leaving.add(address)
        self._done.pop(address, None)
        dask_cluster.end(client, address)


def _died() -> Failed:
    return Failed("its worker process died twice: a crash, or out of memory", again=True)
