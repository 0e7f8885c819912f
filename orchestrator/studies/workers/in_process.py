"""Points run one after the other in this process: where starting workers would take longer."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator
from typing import Generic, Self, TypeVar

from ...errors import InputError
from ...simulation.guarded.kept import kept_between_runs
from .pool import Answer, Failed

Item = TypeVar("Item")


class InProcess(Generic[Item]):
    """In the place of a :class:`~.pool.WorkerPool`, for points that are short and cannot crash."""

    def __init__(self, task: Callable[[Item], Answer]) -> None:
        self._task = task
        self._stack = contextlib.ExitStack()

    def __enter__(self) -> Self:
        self._stack.enter_context(kept_between_runs())
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def answers(
        self, points: Iterable[Item], check: Callable[[], None]
    ) -> Iterator[tuple[Item, Answer | Failed]]:
        """The answer of each point in turn; `check` may raise before each.

        `InputError` where the files of a point have changed since it was planned.
        """
        for point in points:
            check()
            answer = self._task(point)
            if "unfit" in answer:
                raise InputError(f"{answer['unfit']}; it has changed while the sweep ran")
            yield point, answer
