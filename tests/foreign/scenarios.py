"""Scenarios of foreign FMUs: files written piece by piece, run, and read at their end."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run

VERSIONS = (2, 3)
HANGS = (2, 14, 16)
"""Faults of FAULTY that never come back."""
each_version = pytest.mark.parametrize("version", VERSIONS)
Value = float | str | bool
Shelf = Callable[..., Path]


def toml(value: Value | Path | Mapping[str, Value]) -> str:
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{json.dumps(k)} = {toml(v)}' for k, v in value.items())} }}"
    if isinstance(value, str | Path):
        return json.dumps(str(value), ensure_ascii=False)
    return str(value).lower() if isinstance(value, bool) else repr(value)


def part(name: str, fmu: Path | str, **keys: Value | Mapping[str, Value] | None) -> str:
    """A component of a scenario; keys with None are left out."""
    given = {key: value for key, value in {"fmu": fmu, **keys}.items() if value is not None}
    lines = [f"{key} = {toml(value)}" for key, value in given.items()]
    return "\n".join([f"[components.{name}]", *lines])


def wires(*texts: str) -> str:
    """Wires of a scenario, each written as `a.y -> b.u`, or as `a.y -> b.u * 2.0`."""
    lines = []
    for text in texts:
        ends, _, gain = text.partition(" * ")
        source, _, target = ends.partition(" -> ")
        lines += ["[[wires]]", f"from = {toml(source)}", f"to = {toml(target)}"]
        lines += [f"gain = {gain}"] if gain else []
    return "\n".join(lines)


def hold(values: Mapping[str, Value]) -> str:
    """Holds of a scenario."""
    return "\n".join(["[hold]", *(f"{toml(k)} = {toml(v)}" for k, v in values.items())])


def scenario(
    folder: Path, *texts: str, stop: float = 0.1, step: float = 0.01, more: str = ""
) -> Path:
    """A scenario file of components, wires and holds."""
    times = f"[time]\nstop = {stop!r}\nstep = {step!r}\n{more}"
    path = folder / "scenario.toml"
    path.write_text("\n".join([times, *texts]))
    return path


def ran(path: Path, **options: object) -> Outcome:
    outcome = run(load(path, **options), estimate=False)  # type: ignore[arg-type]
    if outcome.failure is not None:
        raise outcome.failure
    return outcome


def last(outcome: Outcome) -> dict[str, float]:
    """Values at the end of a run, by name."""
    return dict(zip(outcome.names, outcome.rows[-1].tolist(), strict=True))


def ring(folder: Path, fmu: Path, gains: tuple[float, float], **keys: Value) -> Path:
    """Two GAINs, y1 = g1 y2 + 1 and y2 = g2 y1 + 0.5."""
    first = part("a", fmu, start={"gain": gains[0], "offset": 1.0}, **keys)
    second = part("b", fmu, start={"gain": gains[1], "offset": 0.5}, **keys)
    return scenario(folder, first, second, wires("a.y -> b.u", "b.y -> a.u"))


def faulty(
    folder: Path,
    fmu: Path,
    fault: int,
    *beside: str,
    stop: float = 0.1,
    held: Mapping[str, Value] | None = None,
    **keys: Value | None,
) -> Path:
    """A component `faulty` that fails in the step to 0.05 s, beside other components.

    A fault that hangs is ended by a short patience; all other calls have plenty of time.
    """
    patience = "2 s" if fault in HANGS else "600 s"
    start: dict[str, Value] = {"fault": fault, "fault_time": 0.05, "gain": 3.0}
    failing = part("faulty", fmu, start=start, **{"patience": patience, **keys})
    return scenario(folder, failing, *beside, hold({"faulty.u": 1.0, **(held or {})}), stop=stop)


def between(first: str, second: str, pair: str) -> str:
    """Wires of two MASSes and the PAIR between them: motions to it, forces back."""
    return wires(
        *(
            wire
            for mass, port in ((first, "first"), (second, "second"))
            for wire in (
                f"{mass}.displacement -> {pair}.{port}.displacement",
                f"{mass}.velocity -> {pair}.{port}.velocity",
                f"{pair}.{port}.value -> {mass}.force",
            )
        )
    )


def masses(
    folder: Path,
    shelf: Shelf,
    versions: tuple[int, int] = (2, 2),
    *,
    master: str = "interface-newton",
    more: str = "",
    isolate: bool | None = None,
    rollback: bool = True,
    stop: float = 1.5,
) -> Path:
    """Two unit masses on springs of 3 N/m to the ground, and one of 2 N/m between them."""
    mass = shelf("MASS", versions[0], rollback=rollback)
    pair = shelf("PAIR", versions[1], rollback=rollback)
    return scenario(
        folder,
        f'[master]\nkind = "{master}"',
        part("a", mass, start={"start_displacement": 1.0}, isolate=isolate),
        part("b", mass, isolate=isolate),
        part("pair", pair, start={"stiffness": 2.0, "ground_stiffness": 3.0}, isolate=isolate),
        between("a", "b", "pair"),
        stop=stop,
        more=more,
    )


def populations(
    folder: Path,
    shelf: Shelf,
    *texts: str,
    version: int = 2,
    step: float = 0.1,
    more: str = "",
    **keys: Value,
) -> Path:
    """Prey and predators (Lotka and Volterra), x' = (1.5 - y) x and y' = (x - 3) y from (10, 5)."""
    fmu = shelf("POPULATION", version)
    prey = {"growth": 1.5, "effect": -1.0, "start_size": 10.0}
    predators = {"growth": -3.0, "effect": 1.0, "start_size": 5.0}
    return scenario(
        folder,
        *texts,
        part("prey", fmu, start=prey, **keys),
        part("predators", fmu, start=predators, **keys),
        wires("prey.size -> predators.other", "predators.size -> prey.other"),
        stop=15.0,
        step=step,
        more=more,
    )


def quarter_car(
    folder: Path,
    shelf: Shelf,
    *texts: str,
    version: int = 2,
    step: float = 0.002,
    more: str = "",
    **keys: Value,
) -> Path:
    """A body of 300 kg let go 5 cm high above a wheel of 40 kg on its tyre; bare numbers both ways.

    20 kN/m and 1.5 kN.s/m between them, 180 kN/m below the wheel.
    """
    mass = shelf("MASS", version)
    suspension = {"stiffness": 2e4, "damping": 1.5e3, "ground_stiffness": 0.0}
    return scenario(
        folder,
        *texts,
        part("body", mass, start={"mass": 300.0, "start_displacement": 0.05}, **keys),
        part("wheel", mass, start={"mass": 40.0, "stiffness": 1.8e5}, **keys),
        part("suspension", shelf("PAIR", version), start=suspension, **keys),
        between("body", "wheel", "suspension"),
        stop=1.0,
        step=step,
        more=more,
    )


def level_control(
    folder: Path,
    shelf: Shelf,
    *texts: str,
    version: int = 2,
    step: float = 0.01,
    more: str = "",
    **keys: Value,
) -> Path:
    """A tank whose valve a relay opens below 0.4 and closes above 0.6: a Boolean in the loop."""
    return scenario(
        folder,
        *texts,
        part("tank", shelf("TANK", version), **keys),
        part("relay", shelf("RELAY", version), **keys),
        wires("tank.level -> relay.level", "relay.open -> tank.open"),
        stop=4.0,
        step=step,
        more=more,
    )
