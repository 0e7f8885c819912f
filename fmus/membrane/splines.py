"""The six uniform quintic B-splines that live in a cell, and their derivatives, in plain floats."""

from __future__ import annotations


def values(t: float) -> tuple[float, float, float, float, float, float]:
    """The six uniform quintic B-splines at t in a cell, 0 to 1."""
    u = 1.0 - t
    tt = t * t
    uu = u * u
    return (
        uu * uu * u / 120.0,
        (26.0 + t * (-50.0 + t * (20.0 + t * (20.0 + t * (-20.0 + 5.0 * t))))) / 120.0,
        (66.0 + tt * (-60.0 + tt * (30.0 - 10.0 * t))) / 120.0,
        (66.0 + uu * (-60.0 + uu * (30.0 - 10.0 * u))) / 120.0,
        (26.0 + u * (-50.0 + u * (20.0 + u * (20.0 + u * (-20.0 + 5.0 * u))))) / 120.0,
        tt * tt * t / 120.0,
    )


def slopes(t: float) -> tuple[float, float, float, float, float, float]:
    """Their first derivatives."""
    u = 1.0 - t
    tt = t * t
    uu = u * u
    return (
        -uu * uu / 24.0,
        (-10.0 + t * (8.0 + t * (12.0 + t * (-16.0 + 5.0 * t)))) / 24.0,
        t * (-24.0 + tt * (24.0 - 10.0 * t)) / 24.0,
        -u * (-24.0 + uu * (24.0 - 10.0 * u)) / 24.0,
        -(-10.0 + u * (8.0 + u * (12.0 + u * (-16.0 + 5.0 * u)))) / 24.0,
        tt * tt / 24.0,
    )


def bends(t: float) -> tuple[float, float, float, float, float, float]:
    """Their second derivatives."""
    u = 1.0 - t
    return (
        u * u * u / 6.0,
        (2.0 + t * (6.0 + t * (-12.0 + 5.0 * t))) / 6.0,
        (-6.0 + t * t * (18.0 - 10.0 * t)) / 6.0,
        (-6.0 + u * u * (18.0 - 10.0 * u)) / 6.0,
        (2.0 + u * (6.0 + u * (-12.0 + 5.0 * u))) / 6.0,
        t * t * t / 6.0,
    )
