"""The help of the command itself: what there is to do, a line for each command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from typer.core import TyperGroup

if TYPE_CHECKING:
    from rich.table import Table

RUNS = "Runs"
RESULTS = "Results"
PARTS = "Parts"
SCENARIOS = "Scenarios"
PAPER = "Paper"


class CommandList(TyperGroup):
    """A group whose help has no panels: they would take as many lines again.

    The panel of a command (`rich_help_panel`) is the word in front of its first line.
    """

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Print the help."""
        from rich.console import Console

        console = Console(markup=False, emoji=False, highlight=False)
        options = ", ".join(str(option.opts[0]) for option in self.get_params(ctx))
        console.print(f"Usage: {ctx.command_path} COMMAND ...; COMMAND --help shows an example")
        console.print(self.help, end="\n\n")
        console.print(self._commands(ctx))
        console.print(f"\nOptions: {options}")
        console.print(self.epilog)

    def _commands(self, ctx: Any) -> Table:
        from rich.table import Table

        table = Table.grid(padding=(0, 2, 0, 0))
        table.add_column(style="bold", no_wrap=True)
        table.add_column(style="cyan", no_wrap=True)
        table.add_column()
        panels: dict[str, list[tuple[str, str]]] = {}
        for name in self.list_commands(ctx):
            command = self.get_command(ctx, name)
            if command is not None and not command.hidden:
                panel = str(getattr(command, "rich_help_panel", None) or "")
                first = (command.help or "").partition("\n\n")[0]
                panels.setdefault(panel, []).append((name, " ".join(first.split())))
        for panel, commands in panels.items():
            for place, row in enumerate(commands):
                table.add_row("" if place else panel, *row)
        return table
