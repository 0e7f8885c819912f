"""The one command: every tool at its steps or tolerances, one table, one file, one plot.

    python benchmarks/peers --scenario flapping-full-wings --tools ecos,fmpy.ssp --budget 30

What each tool does with Resilin's FMUs, and figures of a whole run: docs/peers.md.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from orchestrator.scenario.plan import LIBRARY

from .case import Case
from .figures import judge
from .measured_run import MeasuredRun, Setting, run
from .plot import draw
from .reference import Reference
from .table import cost_table, run_table, write
from .tools import TOOLS
from .tools.base import Method, Tool
from .wiring import POINTS, case_of

STEPS = "20,60,100,400,1600"
TOLERANCES = "1,1e-1,1e-2,1e-3,1e-4,1e-6,1e-8"


class Bench:
    """One run of the benchmark: a scenario, its reference, and the budget of each run."""

    def __init__(
        self, scenario: str, library: Path, cycles: float, budget: float, repeats: int
    ) -> None:
        self.scenario, self.library, self.cycles = scenario, library, cycles
        self.budget, self.repeats = budget, repeats
        self.reference = Reference(scenario, library, cycles)
        self.console = Console(width=160)

    def case(self, setting: Setting) -> Case:
        """The case of a setting; a tool with a tolerance is compared at the coarsest points."""
        steps = setting.varied == "steps"
        wiring = setting.wiring if setting.wiring != "one ODE" else "values"
        made = case_of(
            self.scenario,
            self.library,
            wiring,
            int(setting.place) if steps else POINTS,
            self.cycles,
        )
        return replace(made, rtol=0.0 if steps else setting.place)

    def curve(
        self, tool: Tool, method: Method, wiring: str, places: list[float], python: str
    ) -> list[MeasuredRun]:
        """Runs from coarse to fine, as far as the budget goes."""
        found: list[MeasuredRun] = []
        before: MeasuredRun | None = None
        for place in places:
            setting = Setting(tool.name, method.name, wiring, method.varied, place)
            if before is not None and method.varied == "steps":
                foreseen = before.wall * place / before.setting.place
                if foreseen > self.budget:
                    reason = f"not run: {foreseen:.0f} s foreseen, the budget is {self.budget:g} s"
                    found.append(MeasuredRun(setting, "over budget", reason, before.version))
                    break
            case = self.case(setting)
            measured = run(case, setting, self.budget, self.repeats, python)
            if measured.status == "done":
                judge(measured, case, self.reference, before)
            found.append(measured)
            self.tell(measured)
            if measured.status == "done":
                before = measured
            if absent(measured) or measured.status == "over budget":
                break
            if measured.status == "done" and measured.wall > self.budget:
                break
        return found

    def tell(self, measured: MeasuredRun) -> None:
        """A line while the benchmark runs."""
        result = f"{measured.wall:.4f} s, error {measured.error:.2e}"
        if measured.status != "done":
            result = f"{measured.status}: {measured.reason}"
        self.console.print(f"{measured.setting}: {result}", highlight=False, markup=False)


def absent(measured: MeasuredRun) -> bool:
    return measured.status == "not installed"


def starts(method: Method, place: float) -> bool:
    """Whether a method makes sense at a number of steps or at a tolerance."""
    return method.varied == "steps" or place <= method.loosest


def main(
    scenario: Annotated[str, typer.Option(help="oscillator-1, flapping-full-wings, ...")] = (
        "flapping-full-wings"
    ),
    tools: Annotated[str, typer.Option(help="Names, separated by commas; all if none.")] = "",
    budget: Annotated[float, typer.Option(help="Seconds that one run may take.")] = 30.0,
    cycles: Annotated[float, typer.Option(help="Drive cycles to simulate.")] = 10.0,
    steps: Annotated[str, typer.Option(help=f"Per cycle; multiples of {POINTS}.")] = STEPS,
    tolerances: Annotated[str, typer.Option(help="Where a tool has one.")] = TOLERANCES,
    repeats: Annotated[int, typer.Option(help="Of which the least counts.")] = 3,
    python: Annotated[
        list[str] | None, typer.Option(help="TOOL=PATH: a Python of its own for a tool.")
    ] = None,
    library: Annotated[Path, typer.Option(help="Folder of the built FMUs.")] = LIBRARY,
    output: Annotated[Path, typer.Option(help="Folder for the file and the plot.")] = (
        Path("results") / "peers"
    ),
) -> None:
    """Other tools step the same FMUs: error against run time."""
    pythons = dict(text.split("=", 1) for text in python or [])
    names = [name for name in tools.split(",") if name] or list(TOOLS)
    for name in [*names, *pythons]:
        if name not in TOOLS:
            raise typer.BadParameter(f"no tool {name!r}; there are {', '.join(TOOLS)}")
    values = {
        "steps": [float(text) for text in steps.split(",")],
        "tolerance": [float(text) for text in tolerances.split(",")],
    }
    bench = Bench(scenario, library, cycles, budget, repeats)
    runs: list[MeasuredRun] = []
    for tool in (TOOLS[name] for name in names):
        for method in tool.methods:
            for wiring in method.wirings:
                if runs and runs[-1].setting.tool == tool.name and absent(runs[-1]):
                    break
                places = [p for p in values[method.varied] if starts(method, p)]
                runs += bench.curve(tool, method, wiring, places, pythons.get(tool.name, ""))
    output.mkdir(parents=True, exist_ok=True)
    bench.console.print(run_table(f"{scenario}, {cycles:g} cycles", runs))
    bench.console.print(cost_table(runs))
    write(scenario, runs, output / f"{scenario}.csv")
    draw(scenario, runs, output / f"{scenario}.svg")
    bench.console.print(f"{output / scenario}.csv and .svg")
