"""Help texts: paragraphs that fill their lines, examples that can be pasted, what may repeat."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest
from typer.main import get_command
from typer.testing import CliRunner

import build_fmus
from orchestrator.cli import app

WIDTH = 78


def every(group: Any, before: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from every(command, (*before, name))
        elif not command.hidden:
            yield (*before, name)


COMMANDS = list(every(get_command(app)))


def command(words: tuple[str, ...]) -> Any:
    found: Any = get_command(build_fmus.builder() if words == ("build",) else app)
    for word in words if words != ("build",) else ():
        found = found.commands[word]
    return found


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_help_is_whole_in_a_narrow_terminal(words: tuple[str, ...]) -> None:
    shown = CliRunner().invoke(app, [*words, "--help"], env={"COLUMNS": "80"}).output
    about = shown.partition("\nArguments:")[0].partition("\nOptions:")[0]
    *paragraphs, example = about.strip().split("\n\n")[1:]
    for paragraph in paragraphs:
        lines = [line.strip() for line in paragraph.splitlines()]
        for line, after in pairwise(lines):
            assert len(f"  {line} {after.split()[0]}") > WIDTH, paragraph
    pasted = shlex.split(example.strip().removeprefix("Example: ").replace("\\\n", " "))
    assert "\n" not in example.replace("\\\n", "")
    assert pasted[: len(words) + 1] == ["resilin", *words]
    options = {name for p in command(words).params for name in [*p.opts, *p.secondary_opts]}
    assert {word for word in pasted if word.startswith("--")} <= options


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_options_that_may_repeat_say_so(words: tuple[str, ...]) -> None:
    for parameter in command(words).params:
        if parameter.param_type_name == "option":
            assert parameter.multiple == ("may repeat" in (parameter.help or "")), parameter.opts
