"""The one command: every tool over its ladder, one table, one file, one picture.

    python benchmarks/peers --scene flapping-full-wings --tools ecos,fmpy.ssp --budget 30

What each tool does with our FMUs, and figures of a whole run: docs/peers.md.
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
from .picture import draw
from .reference import Reference
from .rung import Rung, Setting, run
from .table import cost_table, rung_table, write
from .tools import TOOLS
from .tools.base import Method, Tool
from .wiring import POINTS, case_of

STEPS = "20,60,100,400,1600"
TOLERANCES = "1,1e-1,1e-2,1e-3,1e-4,1e-6,1e-8"


class Bench:
    """One run of the benchmark: a scene, its reference, and what bounds the tools."""

    def __init__(
        self, scene: str, library: Path, cycles: float, budget: float, repeats: int
    ) -> None:
        self.scene, self.library, self.cycles = scene, library, cycles
        self.budget, self.repeats = budget, repeats
        self.reference = Reference(scene, library, cycles)
        self.console = Console(width=160)

    def case(self, setting: Setting) -> Case:
        """The case of a setting; a tool with a tolerance is compared at the coarsest points."""
        steps = setting.ladder == "steps"
        wiring = setting.wiring if setting.wiring != "one ODE" else "values"
        made = case_of(
            self.scene, self.library, wiring, int(setting.place) if steps else POINTS, self.cycles
        )
        return replace(made, rtol=0.0 if steps else setting.place)

    def climb(
        self, tool: Tool, method: Method, wiring: str, ladder: list[float], python: str
    ) -> list[Rung]:
        """A curve from coarse to fine, as far as the budget goes."""
        found: list[Rung] = []
        before: Rung | None = None
        for place in ladder:
            setting = Setting(tool.name, method.name, wiring, method.ladder, place)
            if before is not None and method.ladder == "steps":
                foreseen = before.wall * place / before.setting.place
                if foreseen > self.budget:
                    reason = f"not run: {foreseen:.0f} s foreseen, the budget is {self.budget:g} s"
                    found.append(Rung(setting, "over budget", reason, before.version))
                    break
            case = self.case(setting)
            rung = run(case, setting, self.budget, self.repeats, python)
            if rung.status == "done":
                judge(rung, case, self.reference, before)
            found.append(rung)
            self.tell(rung)
            if rung.status == "done":
                before = rung
            if absent(rung) or rung.status == "over budget":
                break
            if rung.status == "done" and rung.wall > self.budget:
                break
        return found

    def tell(self, rung: Rung) -> None:
        """A line while the benchmark runs."""
        said = f"{rung.wall:.4f} s, error {rung.error:.2e}"
        if rung.status != "done":
            said = f"{rung.status}: {rung.reason}"
        self.console.print(f"{rung.setting}: {said}", highlight=False, markup=False)


def absent(rung: Rung) -> bool:
    return rung.status == "not installed"


def starts(method: Method, place: float) -> bool:
    """Whether a method has any use for a place of its ladder."""
    return method.ladder == "steps" or place <= method.loosest


def main(
    scene: Annotated[str, typer.Option(help="oscillator-1, flapping-full-wings, ...")] = (
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
    output: Annotated[Path, typer.Option(help="Folder for the file and the picture.")] = (
        Path("results") / "peers"
    ),
) -> None:
    """Other tools step the same FMUs: error against run time."""
    pythons = dict(text.split("=", 1) for text in python or [])
    names = [name for name in tools.split(",") if name] or list(TOOLS)
    for name in [*names, *pythons]:
        if name not in TOOLS:
            raise typer.BadParameter(f"no tool {name!r}; there are {', '.join(TOOLS)}")
    ladders = {
        "steps": [float(text) for text in steps.split(",")],
        "tolerance": [float(text) for text in tolerances.split(",")],
    }
    bench = Bench(scene, library, cycles, budget, repeats)
    rungs: list[Rung] = []
    for tool in (TOOLS[name] for name in names):
        for method in tool.methods:
            for wiring in method.wirings:
                if rungs and rungs[-1].setting.tool == tool.name and absent(rungs[-1]):
                    break
                ladder = [p for p in ladders[method.ladder] if starts(method, p)]
                rungs += bench.climb(tool, method, wiring, ladder, pythons.get(tool.name, ""))
    output.mkdir(parents=True, exist_ok=True)
    bench.console.print(rung_table(f"{scene}, {cycles:g} cycles", rungs))
    bench.console.print(cost_table(rungs))
    write(scene, rungs, output / f"{scene}.csv")
    draw(scene, rungs, output / f"{scene}.svg")
    bench.console.print(f"{output / scene}.csv and .svg")
