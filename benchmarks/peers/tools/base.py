"""The interface of a tool: it loads a case, runs it, and returns the watched values."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from importlib import metadata
from typing import ClassVar

from ..case import Case


@dataclass
class Track:
    """Watched values at their times, and the number of step calls.

    `aside` is the part of the measured time [s] that was not stepping, where that is known.
    """

    times: list[float] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)
    calls: int = 0
    aside: float = 0.0


March = Callable[[], Track]
"""A loaded case, ready: the time of a call is measured."""


@dataclass(frozen=True)
class Method:
    """A method by which a tool can step, for the wirings that make sense with it.

    `varied` is what makes a curve, `steps` or `tolerance`; `loosest` the largest tolerance that
    makes sense.
    """

    name: str
    wirings: tuple[str, ...] = ("values", "ports")
    varied: str = "steps"
    loosest: float = 1e-2


class Tool(ABC):
    """A tool by its distribution's name; `install` is the command that installs it."""

    name: ClassVar[str]
    distribution: ClassVar[str]
    install: ClassVar[str]
    methods: ClassVar[tuple[Method, ...]]

    def version(self) -> str:
        return metadata.version(self.distribution)

    @abstractmethod
    def missing(self) -> str:
        """Why the tool cannot run in this Python; empty where it can."""

    @abstractmethod
    def load(self, case: Case, method: str) -> AbstractContextManager[March]:
        """A case loaded and initialised; freed at the end."""


def importable(*names: str) -> str:
    """Why modules cannot be imported; empty where they can."""
    from importlib import import_module

    for name in names:
        try:
            import_module(name)
        except ModuleNotFoundError as error:
            return f"no module {error.name}"
        except Exception as error:
            return f"{name} does not load: {error}"
    return ""
