"""Observe a run while it goes on: print a line each cycle, and stream every point to a file.

You learn: an observer is called at the start with the plan and the variables, then at each
communication point with a view of the values. It reads and cannot change the run; where it raises,
the run ends with an error that names it.
"""

from pathlib import Path
from typing import TextIO

from resilin import Observer, View, load, run


class EachCycle(Observer):
    """Prints the largest displacement of each cycle."""

    def start(self, plan, variables) -> None:
        self.cycle = 1.0 / plan.frequency
        self.end, self.largest = self.cycle, 0.0
        self.unit = variables["payload.displacement"].unit

    def sample(self, view: View) -> None:
        self.largest = max(self.largest, abs(view["payload.displacement"]))
        if view.time >= self.end - 1e-9:
            print(f"t = {view.time:.3f} s: up to {self.largest:.3g} {self.unit}")
            self.end, self.largest = self.end + self.cycle, 0.0


class Stream(Observer):
    """Writes all values as lines of CSV, at once on disk."""

    def __init__(self, file: TextIO) -> None:
        self.file = file

    def start(self, plan, variables) -> None:
        names = [f"{name} [{variable.unit}]" for name, variable in variables.items()]
        print("time [s]", *names, sep=",", file=self.file)

    def sample(self, view: View) -> None:
        print(view.time, *view.values(), sep=",", file=self.file, flush=True)


def main() -> None:
    Path("results").mkdir(exist_ok=True)
    plan = load("oscillator-1", time={"stop": "8 cycles"})
    with Path("results/stream_values.csv").open("w") as file:
        outcome = run(plan, observers=[EachCycle(), Stream(file)]).checked()
    print(f"{outcome.steps + 1} rows in results/stream_values.csv")


if __name__ == "__main__":
    main()
