"""The value of a port's law at a point, by the conventions of docs/reference/coupling.md.

Each function takes the members of a port by name, as a receiver has them on its inputs, and
the receiver's own motion or voltage; members that are not wired count as zero, and a law without
a reference time as sampled at the present time.
"""

from __future__ import annotations

from collections.abc import Mapping

NO_REFERENCE = -1e30

Members = Mapping[str, float]


def _since(members: Members, key: str, time: float) -> float:
    reference = members.get(key, NO_REFERENCE)
    none = reference <= 0.5 * NO_REFERENCE or reference == 0.0
    return 0.0 if none else time - reference


def force(m: Members, back: Members, time: float) -> float:
    """F = value - stiffness (x - x0) - damping (v - v0) + rate s + curvature s^2 [N]."""
    s = _since(m, "reference_time", time)
    x = back.get("displacement", 0.0) - m.get("reference_displacement", 0.0)
    v = back.get("velocity", 0.0) - m.get("reference_velocity", 0.0)
    passive = m.get("stiffness", 0.0) * x + m.get("damping", 0.0) * v
    return m["value"] - passive + (m.get("rate", 0.0) + m.get("curvature", 0.0) * s) * s


def torque(m: Members, back: Members, time: float) -> float:
    """T = torque - damping (w - w0) + D(w) - D(w0), D = -(c + c' (w - w0)) w |w| [N m].

    The added inertia of the port comes on top, in the receiver.
    """
    del time
    w, w0 = back.get("flap_rate", 0.0), m.get("reference_rate", 0.0)
    c = m.get("quadratic_drag", 0.0)
    now = max(0.0, c + m.get("quadratic_drag_slope", 0.0) * (w - w0))
    passive = m.get("damping", 0.0) * (w - w0)
    return m["torque"] - passive - now * w * abs(w) + c * w0 * abs(w0)
