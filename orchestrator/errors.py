"""What can go wrong, as a tree. Every message names the thing, the place and the way out.

ResilinError                     exit code
+-- InputError                   2   the user's files and options
|   +-- ScenarioError                   a scenario: file, key, remedy; may list several
|   +-- FmuError                     an FMU file: archive, description, platform
|   +-- RecordingError               a recording: file, line, column
|   +-- OutputError                  a result that cannot be written
+-- SimulationError              1   a run that could not go on
    +-- InstanceFailure                  a unit returned anything but OK
    +-- Divergence                   NaN, infinity, bounds left, runaway growth
    +-- InitialisationError          no consistent start
    +-- ObserverError                an observer of the user's that raised
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class ResilinError(Exception):
    """Base of all errors with a message for the user; `exit_code` is the process's."""

    exit_code = 1


class InputError(ResilinError):
    """Something the user gave is wrong."""

    exit_code = 2


class ScenarioError(InputError):
    """One or more problems of a scenario, each with its place."""

    def __init__(self, problems: Iterable[str] | str) -> None:
        listed = [problems] if isinstance(problems, str) else list(problems)
        self.problems = [problem.replace("\n", "\\x0a") for problem in listed]
        super().__init__("\n".join(self.problems))


class FmuError(InputError):
    """A file that is no usable FMU."""


class RecordingError(InputError):
    """A file that is no usable recording."""


class OutputError(InputError):
    """A result that cannot be written where it should be."""


class SimulationError(ResilinError):
    """A run that stopped; what was recorded up to then is kept."""


class InstanceFailure(SimulationError):
    """A unit returned a status other than OK, or refused to start."""


class Divergence(SimulationError):
    """A value that is no longer meaningful."""


class InitialisationError(SimulationError):
    """The units refuse their start values, or these do not settle."""

    exit_code = 2


class ObserverError(SimulationError):
    """An observer given to `run` raised; the cause is its own exception."""


def nearest(word: str, words: Iterable[str], *, show: int = 8) -> str:
    """`did you mean 'x'?`, or what there is, cut to `show` names."""
    choices = sorted(words)
    close = difflib.get_close_matches(word, choices, n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]!r}?"
    if not choices:
        return "there is none"
    listed = ", ".join(choices[:show])
    return f"there is {listed}" + (", ..." if len(choices) > show else "")


def printable(text: str, *, most: int = 200) -> str:
    """Text from a stranger, safe for a terminal: controls and bidi marks escaped, cut."""
    cut = text if len(text) <= most else text[:most] + "..."
    if cut.isascii() and cut.isprintable():
        return cut
    return "".join(c if c.isprintable() and not _bidi(c) else _escaped(c) for c in cut)


def _bidi(character: str) -> bool:
    code = ord(character)
    return code in {0x200E, 0x200F, 0x061C} or 0x202A <= code <= 0x202E or 0x2066 <= code <= 0x2069


def _escaped(character: str) -> str:
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
