"""Options by the names of earlier releases: understood for one more, not shown."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand

from ..errors import renamed


def known_as(**names: str) -> type[TyperCommand]:
    """A command that takes options by old names too, as `known_as(bode="output")`.

    The old name, with `_` for `-`, comes first.
    """
    new = {_option(old): _option(name) for old, name in names.items()}

    class Renaming(TyperCommand):
        def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
            return super().parse_args(ctx, [_renamed(arg, new) for arg in args])

    return Renaming


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _renamed(argument: str, new: dict[str, str]) -> str:
    option, equals, value = argument.partition("=")
    if option not in new:
        return argument
    renamed(f"the option {option}", new[option])
    return f"{new[option]}{equals}{value}"
