"""Members of a recorded port beyond its columns: rates, curvatures, and when it holds.

The conventions are those of docs/reference/coupling.md. Over the step of size h that ends at t,
with s counted from t,

    y(t + s)   = y + y' s + k s^2,    k = 3 (mean(y) - y + y' h / 2) / h^2,
    y^2(t + s) = y^2 + 2 y y' s + k s^2,    k = 3 (mean(y^2) - y^2 + y y' h) / h^2,

means over that step, so that a receiver takes the right impulse. Before the first step k = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

SI = {
    "value": "N",
    "rate": "N/s",
    "voltage": "V",
    "voltage_rate": "V/s",
    "displacement": "m",
    "velocity": "m/s",
    "flap_angle": "rad",
    "flap_rate": "rad/s",
    "torque": "N.m",
    "charge": "C",
}
"""Members whose unit is known: a column is converted to it, or is in it if it has no unit."""

LOOSE = {"value", "rate"}
"""Members that are forces in our parts and may be anything elsewhere."""

ORDERS = {
    **dict.fromkeys(("stiffness", "damping", "rate", "reference_displacement"), 1),
    **dict.fromkeys(("reference_velocity", "reference_time", "voltage_rate", "voltage_time"), 1),
    **dict.fromkeys(("motional_current", "charge_time", "quadratic_drag", "reference_rate"), 1),
    **dict.fromkeys(("curvature", "square_curvature", "capacitance_rate"), 2),
    **dict.fromkeys(("capacitance_by_square", "charge_curvature"), 2),
    **dict.fromkeys(("coenergy", "coenergy_rate"), 1),
    "coenergy_curvature": 2,
    **dict.fromkeys(("quadratic_drag_slope", "added_inertia_slope"), 2),
}
"""How much of a law a member carries: 1 affine, 2 curvature; 0 where it is not named here."""

CLOCKS = {"reference_time", "voltage_time", "charge_time"}
"""Members that give the time at which a law holds: always now, whatever the file holds."""


@dataclass(frozen=True)
class Derived:
    """A member that follows from the interpolant of another.

    `how` is "slope", "curvature", "square" (the curvature of the square) or "time".
    """

    name: str
    how: str
    per: str
    meaning: str


LAWS: dict[str, tuple[Derived, ...]] = {
    "value": (
        Derived("rate", "slope", "/s", "Rate of the recorded value"),
        Derived("curvature", "curvature", "/s2", "Coefficient of s^2 in the recorded value"),
        Derived("reference_time", "time", "s", "Time at which the value holds"),
    ),
    "voltage": (
        Derived("voltage_rate", "slope", "/s", "Rate of the recorded voltage"),
        Derived("square_curvature", "square", "2/s2", "Coefficient of s^2 in the square"),
        Derived("voltage_time", "time", "s", "Time at which the voltage holds"),
    ),
    "displacement": (
        Derived("velocity", "slope", "/s", "Rate of the recorded displacement"),
        Derived("reference_time", "time", "s", "Time at which the motion holds"),
    ),
    "flap_angle": (
        Derived("flap_rate", "slope", "/s", "Rate of the recorded angle"),
        Derived("reference_time", "time", "s", "Time at which the motion holds"),
    ),
    "charge": (Derived("charge_time", "time", "s", "Time at which the charge law holds"),),
}
"""First member of a law -> members that are derived from it where the file lacks them."""

PASSIVE = {"stiffness", "damping"}
"""With these a law has its own rate, which is that at rest and not the slope of the value."""


def members(names: set[str]) -> list[tuple[str, Derived]]:
    """Derived members of a port that has these: each with the member that it comes from."""
    found: dict[str, tuple[str, Derived]] = {}
    for name, derived in LAWS.items():
        if name not in names:
            continue
        for one in derived:
            passive = one.how != "time" and name == "value" and names & PASSIVE
            if not passive and (one.how == "time" or one.name not in names):
                found.setdefault(one.name, (name, one))
    return list(found.values())
