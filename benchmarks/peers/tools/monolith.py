"""scipy's solvers on the equations of `fmus.monolith`: no co-simulation, one ODE."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..case import Case
from .base import March, Method, Tool, Track, importable

SOLVERS = ("RK45", "DOP853", "LSODA", "Radau", "BDF")
IN_C = ("RK45", "DOP853", "LSODA")
CVODE = "CVODE"
Array = NDArray[np.float64]
Rates = Callable[[float, Array], Any]


class Monolith(Tool):
    """Restarted at every edge of the drive; the count of calls is that of right-hand sides.

    Those `in C` are the same equations compiled: what co-simulation could reach at most. CVODE is
    the one that fmpy ships.
    """

    name = "scipy"
    distribution = "scipy"
    install = "pip install -e ."
    methods = (
        *(Method(name, ("one ODE",), "tolerance") for name in SOLVERS),
        *(Method(f"{name} in C", ("one ODE",), "tolerance") for name in (*IN_C, CVODE)),
    )

    def missing(self) -> str:
        return importable("scipy.integrate", "fmus.monolith")

    @contextmanager
    def load(self, case: Case, method: str) -> Iterator[March]:
        from fmus.amplifier import physics as amplifier
        from fmus.monolith import equations, physics
        from fmus.native import reference

        p, watch = _parameters(case)
        x = physics.initial(p, physics.Input(**_still(physics.Input)), 0.0)
        composition = physics._composition(p, x)
        seen = watch(composition)
        points = [(k + 1) * case.every * case.step for k in range(case.count // case.every)]
        atol = [case.rtol * scale for scale in equations.SCALES]
        still = amplifier.Input(command_top=0.0, command_bottom=0.0)
        name, compiled = method.removesuffix(" in C"), method.endswith(" in C")
        right_hand_side = reference.right_hand_side if compiled else physics.right_hand_side
        solve = _by_cvode if name == CVODE else _by_scipy
        right_hand_side(composition, still, 0.0)

        def march() -> Track:
            track = Track()
            y = np.array([getattr(x, name) for name in equations.FIELDS])
            begin, stop = 0.0, points[-1]
            while begin < stop:
                end = min(stop, amplifier.next_event(composition.amplifier, begin))
                inside = [t for t in points if begin < t <= end]
                rates = right_hand_side(composition, still, 0.5 * (begin + end))
                ends = sorted({*inside, end})
                states, calls = solve(rates, begin, y, ends, name, case.rtol, atol)
                track.calls += calls
                for k in range(len(inside)):
                    track.times.append(inside[k])
                    track.rows.append([see(states[k]) for see in seen])
                y, begin = states[-1], end
            return track

        yield march


def _by_scipy(
    rates: Rates, begin: float, y: Array, ends: list[float], method: str, rtol: float, atol: Any
) -> tuple[list[Array], int]:
    """States at some times, and the evaluations that they took."""
    from scipy.integrate import solve_ivp

    solved = solve_ivp(
        rates, (begin, ends[-1]), y, method=method, rtol=rtol, atol=atol, t_eval=ends
    )
    if not solved.success:
        raise RuntimeError(solved.message)
    return list(solved.y.T), solved.nfev


def _by_cvode(
    rates: Rates, begin: float, y: Array, ends: list[float], method: str, rtol: float, atol: Any
) -> tuple[list[Array], int]:
    """The same by the multistep method of SUNDIALS as fmpy calls it."""
    from fmpy.sundials import CVodeSolver

    count = len(y)
    moment = [begin, 0.0]
    state = y.copy()

    def array(pointer: Any) -> Array:
        return np.asarray(np.ctypeslib.as_array(pointer, (count,)))

    def get_rates(pointer: Any, size: int) -> None:
        moment[1] += 1
        array(pointer)[:] = rates(moment[0], state)

    def set_time(time: float) -> None:
        moment[0] = time

    def nominals(pointer: Any, size: int) -> None:
        array(pointer)[:] = np.asarray(atol) / rtol

    solver = CVodeSolver(
        nx=count,
        nz=0,
        get_x=lambda pointer, size: array(pointer).__setitem__(slice(None), state),
        set_x=lambda pointer, size: state.__setitem__(slice(None), array(pointer)),
        get_dx=get_rates,
        get_z=lambda pointer, size: None,
        get_nominals=nominals,
        set_time=set_time,
        input=_NoInput(),
        startTime=begin,
        relativeTolerance=rtol,
        maxNumSteps=100_000,
    )
    states, time = [], begin
    for end in ends:
        _, _, time = solver.step(time, end)
        states.append(array(solver.px).copy())
    return states, int(moment[1])


class _NoInput:
    """Inputs of the solver: there are none."""

    def apply(self, *given: object, **named: object) -> None:
        """Set nothing."""


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
