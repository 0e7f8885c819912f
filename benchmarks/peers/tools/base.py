"""What a tool is: it loads a case, runs it on the clock, and says what it has seen."""

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
    """Watched values at their times, and how often units were stepped.

    `aside` is what of the time on the clock was not stepping, where the tool itself says so.
    """

    times: list[float] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)
    calls: int = 0
    aside: float = 0.0


March = Callable[[], Track]
"""A loaded case, ready: calling it is what the clock measures."""


@dataclass(frozen=True)
class Method:
    """A way a tool can step, for the wirings that make sense with it; by steps or by tolerance.

    `loosest` is the first tolerance that makes sense.
    """

    name: str
    wirings: tuple[str, ...] = ("values", "ports")
    ladder: str = "steps"
    loosest: float = 1e-2


class Tool(ABC):
    """A tool behind its distribution's name; `install` is what gets it."""

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
