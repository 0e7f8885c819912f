"""One grammar of options over all commands, and a list of commands that reads at one glance."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import pytest
import typer
from typer.main import get_command
from typer.testing import CliRunner

import build_fmus
from orchestrator.cli import app, command_list

LINES = 30
OF_ITS_OWN = {"--output", "--set", "--native", "--into", "--step", "--tolerance", "--part"}
"""Options of one meaning whose default or example is the command's own."""
SEVERAL = {"--tolerance", "--part"}
"""Options of which some commands take several."""


def commands(group: Any, before: str = "") -> Iterator[tuple[str, Any]]:
    """Every command with its words; `build` with the builder's options, which it hands on."""
    for name, command in group.commands.items():
        if name == "build":
            builder = typer.Typer(add_completion=False)
            builder.command()(build_fmus.build_command)
            yield name, get_command(builder)
        elif hasattr(command, "commands"):
            yield from commands(command, f"{name} ")
        else:
            yield before + name, command


def options() -> dict[str, dict[str, Any]]:
    """Every option that is shown, by its first name and by command."""
    found: dict[str, dict[str, Any]] = defaultdict(dict)
    for name, command in commands(get_command(app)):
        for option in command.params:
            if option.param_type_name == "option" and not option.hidden:
                found[option.opts[0]][name] = option
    found.pop("--help", None)
    return found


def kind(option: Any) -> tuple[str, bool]:
    """What one value of an option is, and whether it may be given several times."""
    described = getattr(option, "type_descriptor", None)
    given = option.type.name if described is None else described.annotation
    inner = getattr(given, "__args__", (given,))[0]
    return getattr(inner, "__name__", str(inner)), option.multiple


def test_an_option_is_the_same_in_every_command() -> None:
    for name, by_command in options().items():
        kinds = {kind(option) for option in by_command.values()}
        if name in SEVERAL:
            kinds = {(given, False) for given, _ in kinds}
        assert len(kinds) == 1, f"{name}: {by_command.keys()} take {kinds}"
        if name not in OF_ITS_OWN:
            helps = {option.help for option in by_command.values()}
            assert len(helps) == 1, f"{name}: {by_command.keys()} say {helps}"


def test_exceptions_are_of_options_that_need_one() -> None:
    for name in OF_ITS_OWN:
        assert len({option.help for option in options()[name].values()}) > 1, name
    for name in SEVERAL:
        assert len({kind(option) for option in options()[name].values()}) > 1, name


def test_output_is_a_file_and_variables_are_chosen_by_their_name() -> None:
    found = options()
    assert {kind(option) for option in found["--output"].values()} == {("Path", False)}
    assert {"plot", "compare", "precision", "linearise", "fit"} == set(found["--variable"])
    assert set(found["--fmus"]) | {"build"} == set(found["--native"])


def test_an_option_that_is_given_several_times_is_called_in_the_singular() -> None:
    for name, by_command in options().items():
        assert not (name.endswith("s") and any(option.multiple for option in by_command.values()))


def test_the_list_of_commands_fits_half_a_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    done = CliRunner().invoke(app, ["--help"])
    assert done.exit_code == 0
    lines = done.stdout.rstrip("\n").split("\n")
    assert len(lines) <= LINES
    assert max(map(len, lines)) <= 80
    shown = get_command(app)
    for name, command in shown.commands.items():  # type: ignore[attr-defined]
        about = " ".join((command.help or "").partition("\n\n")[0].split())
        whole = [line for line in lines if f" {name} " in line and line.rstrip().endswith(about)]
        assert len(whole) == (not command.hidden), f"{name}: {about}"


def test_every_command_is_in_a_group() -> None:
    panels = {command_list.RUNS, command_list.RESULTS, command_list.PARTS}
    panels |= {command_list.SCENARIOS, command_list.PAPER}
    for name, command in get_command(app).commands.items():  # type: ignore[attr-defined]
        assert command.hidden or command.rich_help_panel in panels, name


def test_words_of_ours_are_explained_where_they_stand() -> None:
    explained = {"law", "held", "curvature"}
    help_of_laws = options()["--laws"]["run"].help
    assert all(word in help_of_laws for word in ("held", "affine", "curvature"))
    assert all(word in str(app.info.epilog) for word in explained)
