"""How a user says which variable a column is, where its heading is another name."""

from __future__ import annotations

import difflib
import json
import re
import shlex
from collections.abc import Iterable

from ..errors import LONGEST_WORD, MOST_WORDS, printable

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def in_scenario(headings: Iterable[str], variable: str) -> str:
    """The key of a recorded component: `columns = { Voltage = "top.voltage" }`."""
    heading = _likest(variable, headings)
    key = heading if _BARE.fullmatch(heading) else json.dumps(heading, ensure_ascii=False)
    return f'columns = {{ {printable(key)} = "{printable(variable)}" }}'


def on_command_line(headings: Iterable[str], variable: str) -> str:
    """The option of `build` and `fit`: `--with columns.Voltage=top.voltage`."""
    heading = _likest(variable, headings)
    return f"--with {shlex.quote(printable(f'columns.{heading}={variable}'))}"


def _likest(variable: str, headings: Iterable[str]) -> str:
    """The heading that is most like a variable's name, or the first."""
    short = [each for each in headings if len(each) <= LONGEST_WORD][:MOST_WORDS]
    if len(variable) > LONGEST_WORD or not short:
        return next(iter(short), "HEADING")
    return next(iter(difflib.get_close_matches(variable, short, n=1, cutoff=0.0)), short[0])
