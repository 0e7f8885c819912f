"""The compiled right-hand side of the monolith is that of the monolith."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmus.amplifier import physics as amplifier
from fmus.monolith import equations, physics
from fmus.native.reference import right_hand_side

COMPOSITIONS = [
    {"elasticity": 1.0, "mechanism": 1.0},
    {"elasticity": 1.0, "mechanism": 2.0, "wings": 1.0, "linkage_wing_inertia": 8e-8},
    {"elasticity": 2.0, "mechanism": 2.0, "wings": 2.0, "linkage_wing_inertia": 8e-8},
    {"elasticity": 1.0, "mechanism": 1.0, "amplifier_bandwidth": 5e3, "amplifier_waveform": 3.0},
]


@pytest.mark.parametrize("changes", COMPOSITIONS)
def test_the_same_bits(changes: dict[str, float]) -> None:
    p = physics.Params(**changes)
    state = physics.initial(p, physics.Input(), 0.0)
    composition = physics._composition(p, state)
    u = amplifier.Input()
    ours = right_hand_side(composition, u, 1e-3)
    plain = physics.right_hand_side(composition, u, 1e-3)
    rng = np.random.default_rng(2)
    centre = np.array([getattr(state, name) for name in equations.FIELDS])
    unlike = 0
    for _ in range(300):
        y = centre + np.array(equations.SCALES) * rng.normal(size=len(centre))
        expected = np.array(plain(2e-3, y))
        assert np.array_equal(ours(2e-3, y), expected, equal_nan=True)
        unlike += bool(np.isfinite(expected).all())
    assert unlike > 30


def test_a_solver_takes_it() -> None:
    """A millisecond of the vehicle, solved to the same numbers by both."""
    p = physics.Params(linkage_wing_inertia=8e-8)
    state = physics.initial(p, physics.Input(), 0.0)
    composition = physics._composition(p, state)
    y = [getattr(state, name) for name in equations.FIELDS]
    ends = [
        solve_ivp(made(composition, amplifier.Input(), 1e-3), (0.0, 1e-3), y, rtol=1e-6).y[:, -1]
        for made in (right_hand_side, physics.right_hand_side)
    ]
    assert np.array_equal(ends[0], ends[1])
    assert math.fabs(ends[0][4]) > 1e-7
