"""Error against run time: one scene by every method over a ladder of communication steps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, ResilinError, SceneError, nearest
from ..interrupt import Interrupt, Interrupted
from ..masters import MASTERS
from ..plan import LIBRARY, Plan
from ..reference import as_recorded, monolithic
from ..results import Outcome
from ..simulation import load, replay, run

LADDER = (8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125)
TARGETS = (1e-2, 1e-3, 1e-4)
LAWS = ("held", "affine", "curvature")
Reference = Literal["monolith", "self"]


@dataclass(frozen=True)
class Method:
    """A master with as much of the ports as it is given."""

    kind: str
    laws: str

    def __str__(self) -> str:
        return f"{self.kind}, {self.laws}"


@dataclass(frozen=True)
class Rung:
    """One run: its setting, what it cost, how wrong each variable was, or what became of it.

    `largest` and `rms` are errors relative to the reference's largest magnitude; `wall_time`
    is the least of the repeats, loading apart. `order` is that of the largest error of the
    leading variable between this rung and the coarser one before it.
    """

    method: Method
    step: float
    status: str
    wall_time: float = float("nan")
    steps: int = 0
    calls: int = 0
    rollbacks: int = 0
    largest: dict[str, float] = field(default_factory=dict)
    rms: dict[str, float] = field(default_factory=dict)
    order: float = float("nan")


@dataclass(frozen=True)
class Study:
    """A ladder for each method, against one reference whose own error is bounded."""

    title: str
    reference: str
    bound: dict[str, float]
    variables: list[str]
    frequency: float | None
    simulated: float
    rungs: list[Rung]

    def error(self, rung: Rung) -> float:
        """Largest relative error of a rung over the leading variables."""
        return max((rung.largest.get(name, np.nan) for name in self.variables), default=np.nan)

    def cheapest(self, target: float) -> Rung | None:
        """The rung with the least wall time that is within a target."""
        good = [r for r in self.rungs if r.status == "done" and self.error(r) <= target]
        return min(good, key=lambda rung: rung.wall_time, default=None)


def parse_method(text: str) -> Method:
    """`gauss-seidel`, `jacobi/held`: a master, and how much of the ports it uses."""
    kind, _, laws = text.partition("/")
    if kind not in MASTERS:
        raise InputError(f"--method {text!r}: no master {kind!r}; {nearest(kind, MASTERS)}")
    if laws and laws not in LAWS:
        raise InputError(f"--method {text!r}: no such use of laws; {nearest(laws, LAWS)}")
    return Method(kind, laws or "curvature")


def methods_for(plan: Plan) -> list[Method]:
    """Every master that the units allow; with laws where the scene has any, and without."""
    able = all(known.rollback for known in plan.interfaces.values())
    lawful = any(c.input.order for c in plan.connections)
    kinds = [name for name, master in MASTERS.items() if able or not master.needs_rollback]
    used = [("curvature" if lawful else "held"), *(["held"] if lawful else [])]
    return [Method(kind, laws) for laws in used for kind in kinds]


def precision(
    scene: str | Path,
    library: Path = LIBRARY,
    *,
    methods: Sequence[Method] | None = None,
    ladder: Sequence[float] = LADDER,
    reference: Reference | None = None,
    variables: Sequence[str] | None = None,
    repeats: int = 3,
    changes: dict[str, str] | None = None,
    options: dict[str, Any] | None = None,
    interrupt: Interrupt | None = None,
    tell: Callable[[Rung], None] | None = None,
) -> Study:
    """Run a scene by each method with its step times each factor of the ladder.

    The reference is the monolith's where the scene has one, else the scene itself, iterated
    at a quarter of the finest step and bounded by its distance from half that fineness.
    `variables` lead: their errors make orders and advice; all wired ones otherwise. Runs that
    fail stay in the study with their reason. Raises `InputError` on unknown variables and
    `SceneError` where the monolith is asked for and cannot be had.
    """
    plan = load(scene, changes, library, **(options or {}))
    chosen = list(methods or methods_for(plan))
    exact, name, bound = _reference(plan, library, reference, min(ladder), interrupt)
    leading = _leading(plan, exact, variables)
    rungs: list[Rung] = []
    for method in chosen:
        before: Rung | None = None
        for factor in sorted(ladder, reverse=True):
            rung = _rung(plan, method, factor, exact, repeats, interrupt, before, leading)
            rungs.append(rung)
            before = rung
            if tell is not None:
                tell(rung)
    simulated = plan.grid.stop - plan.grid.start
    return Study(plan.scenario.title, name, bound, leading, plan.frequency, simulated, rungs)


def with_step(plan: Plan, method: Method, step: float) -> Plan:
    """The same scene by another method and with another step, recorded whole."""
    scenario = plan.scenario
    time = {"start": plan.grid.start, "stop": plan.grid.stop, "step": step, "tolerance": None}
    time["frequency"] = plan.frequency
    changed = {
        "time": time,
        "master": {"kind": method.kind, "laws": method.laws, "order": plan.order},
        "record": {**scenario.record.model_dump(), "every": 1},
    }
    merged = {**scenario.model_dump(by_alias=True), **changed}
    return load_tree(merged, plan)


def load_tree(tree: dict[str, Any], plan: Plan) -> Plan:
    """A changed scene checked against the same FMUs."""
    from ..plan import check
    from ..scenario import Scenario

    paths = {name: str(known.path.resolve()) for name, known in plan.interfaces.items()}
    for name, component in tree["components"].items():
        component["fmu"] = paths[name]
    return check(Scenario.model_validate(tree), plan.path)


def _rung(
    plan: Plan, method: Method, factor: float, exact: Outcome, repeats: int,
    interrupt: Interrupt | None, before: Rung | None, leading: list[str],
) -> Rung:  # fmt: skip
    """One setting, repeated; the reason in its status where it does not run."""
    step = factor * plan.grid.step
    try:
        setting = with_step(plan, method, step)
        done = run(setting, interrupt=interrupt)
        if isinstance(done.failure, Interrupted):
            raise done.failure
        if done.failure is not None:
            return Rung(method, step, f"stopped: {done.failure}", steps=done.steps)
        wall = [run(setting, interrupt=interrupt).wall_time for _ in range(repeats)]
    except ResilinError as error:
        return Rung(method, step, f"stopped: {error}")
    largest, rms = _errors(done, exact)
    order = float("nan")
    if before is not None and before.largest and leading:
        first = max(before.largest[name] for name in leading)
        last = max(largest[name] for name in leading)
        if first > 0.0 and last > 0.0:
            order = float(np.log(first / last) / np.log(before.step / step))
    return Rung(
        *(method, step, "done", min(wall), done.steps, sum(done.calls.values())),
        *(sum(done.rollbacks.values()), largest, rms, order),
    )


def _errors(done: Outcome, exact: Outcome) -> tuple[dict[str, float], dict[str, float]]:
    """Largest and root-mean-square error of each variable over the common times, relative."""
    mine, theirs = common(done.times, exact.times)
    largest, rms = {}, {}
    for name in exact.names:
        wanted = exact.series(name)
        off = done.series(name)[mine] - wanted[theirs]
        size = float(np.abs(wanted).max(initial=0.0)) or 1.0
        largest[name] = float(np.abs(off).max(initial=0.0)) / size
        rms[name] = float(np.sqrt(np.mean(off * off))) / size
    return largest, rms


def common(
    one: NDArray[np.float64], other: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Places of the times that two runs share, up to rounding."""
    grain = 1e-9 * max(float(one[-1] - one[0]), 1e-300)
    near = np.searchsorted(other, one - grain)
    near = np.minimum(near, len(other) - 1)
    same = np.abs(other[near] - one) <= grain
    return np.flatnonzero(same), near[same]


def _reference(
    plan: Plan, library: Path, wanted: Reference | None, finest: float, interrupt: Interrupt | None
) -> tuple[Outcome, str, dict[str, float]]:
    """A solution to measure by, what it is, and a bound of its own error."""
    points = [plan.grid.point(k) for k in range(plan.grid.count + 1)]
    if wanted != "self":
        try:
            single = monolithic(plan, library)
            exact = as_recorded(_whole(replay(single, points, interrupt)), plan)
            return exact, "the monolith, DOP853 at 1e-10", {}
        except SceneError:
            if wanted == "monolith":
                raise
    able = all(known.rollback for known in plan.interfaces.values())
    method = Method("iterative" if able else "gauss-seidel", plan.scenario.master.laws)
    fine, finer = (
        _whole(run(with_step(plan, method, share * finest * plan.grid.step), interrupt=interrupt))
        for share in (0.5, 0.25)
    )
    bound, _ = _errors(fine, finer)
    mine, _ = common(finer.times, np.asarray(points))
    kept = replace(finer, times=finer.times[mine], rows=finer.rows[mine])
    return kept, f"itself by {method} at a quarter of the finest step", bound


def _whole(outcome: Outcome) -> Outcome:
    if outcome.failure is not None:
        raise outcome.failure
    return outcome


def _leading(plan: Plan, exact: Outcome, variables: Iterable[str] | None) -> list[str]:
    """Variables whose errors count: those named, else the motion, else all wired ones."""
    if variables:
        for name in variables:
            if name not in exact.names:
                hint = nearest(name, exact.names)
                raise InputError(f"--variable {name!r}: is not recorded; {hint}")
        return list(variables)
    moving = [n for n in exact.names if n.rpartition(".")[2] in {"displacement", "flap_angle"}]
    wired = {f"{c.source}.{c.output.name}" for c in plan.connections if not c.output.order}
    return moving or [n for n in exact.names if n in wired] or list(exact.names)
