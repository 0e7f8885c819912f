"""scipy's solvers on the equations of `fmus.monolith`: no co-simulation, one ODE."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..case import Case
from .base import March, Method, Tool, Track, importable

SOLVERS = ("RK45", "DOP853", "LSODA", "Radau", "BDF")


class Monolith(Tool):
    """Restarted at every edge of the drive; the count of calls is that of right-hand sides."""

    name = "scipy"
    distribution = "scipy"
    install = "pip install -e ."
    methods = tuple(Method(name, ("one ODE",), "tolerance") for name in SOLVERS)

    def missing(self) -> str:
        return importable("scipy.integrate", "fmus.monolith")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        import numpy as np
        from scipy.integrate import solve_ivp

        from fmus.amplifier import physics as amplifier
        from fmus.monolith import equations, physics

        p, watch = _parameters(case)
        x = physics.initial(p, physics.Input(**_still(physics.Input)), 0.0)
        composition = physics._composition(p, x)
        seen = watch(composition)
        points = [(k + 1) * case.every * case.step for k in range(case.count // case.every)]
        atol = [case.rtol * scale for scale in equations.SCALES]
        still = amplifier.Input(command_top=0.0, command_bottom=0.0)

        def march() -> Track:
            track = Track()
            y = np.array([getattr(x, name) for name in equations.FIELDS])
            begin, stop = 0.0, points[-1]
            while begin < stop:
                end = min(stop, amplifier.next_event(composition.amplifier, begin))
                inside = [t for t in points if begin < t <= end]
                solved = solve_ivp(
                    physics.right_hand_side(composition, still, 0.5 * (begin + end)),
                    (begin, end), y, method=method, rtol=case.rtol, atol=atol,
                    t_eval=sorted({*inside, end}),
                )  # fmt: skip
                if not solved.success:
                    raise RuntimeError(solved.message)
                track.calls += solved.nfev
                for k in range(len(inside)):
                    track.times.append(inside[k])
                    track.rows.append([see(solved.y[:, k]) for see in seen])
                y, begin = solved.y[:, -1], end
            return track

        yield march


def _still(record: type[Any]) -> dict[str, float]:
    import dataclasses

    return {field.name: 0.0 for field in dataclasses.fields(record)}


def _parameters(case: Case) -> tuple[Any, Callable[[Any], list[Callable[[Any], float]]]]:
    """The monolith's parameters for a scenario, and how its state shows what is watched."""
    from fmus.linkage import physics as linkage
    from fmus.linkage.kinematics import flap
    from fmus.monolith import physics
    from fmus.quantity import quantities
    from orchestrator.studies.reference.monolith import monolithic

    from ..wiring import plan_of

    library = Path(case.library)
    plan = plan_of(case.scenario, library, "values", case.per_cycle, case.cycles)
    starts = monolithic(plan, library).starts["monolith"]
    named = {q.fmi_name(field): field for field, q in quantities(physics.Params).items()}
    p = physics.Params(**{named[name]: float(value) for name, value in starts.items()})

    def watch(composition: Any) -> list[Callable[[Any], float]]:
        def displacement(y: Any) -> float:
            return float(y[4])

        def angle(y: Any) -> float:
            geometry = linkage.geometry(composition.linkage)
            return float(flap(geometry, composition.travel, float(y[4]))[0])

        return [angle if w.name == "flap_angle" else displacement for w in case.watched]

    return p, watch
