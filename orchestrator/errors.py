"""What can go wrong, as a tree. Every message names the thing, the place and the way out.

ResilinError                     exit code
+-- InputError                   2   the user's files and options
|   +-- ScenarioError            a scenario: file, key, remedy; may list several
|   +-- FmuError                 an FMU file: archive, description, platform
|   +-- RecordingError           a recording: file, line, column
|   +-- OutputError              a result that cannot be written
+-- SimulationError              1   a run that could not go on
    +-- InstanceFailure          an instance returned anything but OK
    +-- Divergence               NaN, infinity, bounds left, runaway growth
    +-- InitialisationError      2   no consistent start
    +-- ObserverError            an observer of the user's that raised
"""

from __future__ import annotations

import difflib
import warnings
from collections.abc import Iterable


class ResilinError(Exception):
    """Base of all errors with a message for the user; `exit_code` is the process's."""

    exit_code = 1


class InputError(ResilinError):
    """What the user gave is wrong: one problem, or several at once, each with its place."""

    exit_code = 2

    def __init__(self, problems: Iterable[str] | str) -> None:
        self.problems = problems.split("\n") if isinstance(problems, str) else list(problems)
        super().__init__("\n".join(self.problems))


class ScenarioError(InputError):
    """One or more problems of a scenario, each with its place; line ends in them are escaped."""

    def __init__(self, problems: Iterable[str] | str) -> None:
        listed = [problems] if isinstance(problems, str) else problems
        super().__init__([problem.replace("\n", "\\x0a") for problem in listed])


class FmuError(InputError):
    """A file that cannot be used as an FMU."""


class RecordingError(InputError):
    """A file that cannot be used as a recording."""


class OutputError(InputError):
    """A result that cannot be written where it should be."""


class Problems:
    """Collects the problems of one file of the user, so that all of them are raised at once."""

    def __init__(self, file: object, kind: type[InputError] = ScenarioError) -> None:
        self._file = file
        self._kind = kind
        self._found: list[tuple[str, str]] = []

    def __len__(self) -> int:
        return len(self._found)

    def add(self, key: str, message: object) -> None:
        """Add what is wrong at a key, such as `time.step`, and the way out."""
        self._found.append((key, str(message)))

    def at(self, *tables: str) -> bool:
        """Whether any problem concerns one of these keys, or something inside them."""
        return any(
            key == table or key.startswith((f"{table}.", f"{table}[", f"{table} "))
            for key, _ in self._found
            for table in tables
        )

    def check(self) -> None:
        """Raise every problem, each once, as `file: key: message`; without problems, return."""
        if self._found:
            lines = (f"{self._file}: {key}: {message}" for key, message in self._found)
            raise self._kind(dict.fromkeys(lines))


class SimulationError(ResilinError):
    """A run that stopped; what was recorded up to then is kept."""


class InstanceFailure(SimulationError):
    """An instance returned a status other than OK, or refused to start."""


class Divergence(SimulationError):
    """A value that is not finite, leaves its bounds or grows without end."""


class InitialisationError(SimulationError):
    """The instances refuse their start values, or no consistent ones are found."""

    exit_code = 2


class ObserverError(SimulationError):
    """An observer given to `run` raised; the cause is its own exception."""


class RenamedWarning(FutureWarning):
    """An old name was used; it is accepted for one more release."""


class KeptWarning(UserWarning):
    """A file that would have been overwritten is kept under another name."""


def renamed(old: str, new: str) -> None:
    """Warn that an old name was used, with the new one."""
    warnings.warn(
        f"{old} is now called {new}; the next release drops the old name",
        RenamedWarning,
        stacklevel=3,
    )


LONGEST_WORD = 200
SHORTEST_PART = 3
"""Letters from which on names that contain the word are like it."""
MOST_WORDS = 5000
"""Beyond these no nearest word is looked for: the time goes with the square of their length."""


def nearest(word: str, words: Iterable[str], *, later: Iterable[str] = (), show: int = 8) -> str:
    """`did you mean 'x'?`, or a list of the words, cut to `show` of them.

    Those that are somewhat like the word come first; all of `later` comes after the words.
    """
    groups = [sorted(words), sorted(later)]
    if len(word) <= LONGEST_WORD and sum(map(len, groups)) <= MOST_WORDS:
        short = [choice for group in groups for choice in group if len(choice) <= LONGEST_WORD]
        if close := difflib.get_close_matches(word, short, n=1, cutoff=0.6):
            return f"did you mean {close[0]!r}?"
        groups = [_likest_first(word, group) for group in groups]
    choices = [choice for group in groups for choice in group]
    if not choices:
        return "there is none"
    listed = ", ".join(map(printable, choices[:show])) + (", ..." if len(choices) > show else "")
    return f"there {'is' if len(choices) == 1 else 'are'} {listed}"


def _likest_first(word: str, words: list[str]) -> list[str]:
    short = [each for each in words if len(each) <= LONGEST_WORD]
    near = difflib.get_close_matches(word, short, cutoff=0.5)
    near += [each for each in words if len(word) >= SHORTEST_PART and word in each]
    return list(dict.fromkeys([*near, *words]))


def printable(text: str, *, most: int = 200) -> str:
    """Foreign text, safe for a terminal: controls and bidi marks escaped, cut to `most`."""
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
