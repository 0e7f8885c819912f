"""First-order lag with a limited rate, y' = clamp((g(t) - y)/T, -limit, limit), solved exactly.

The target g is a parabola over the span. Both the amplifier (T from its bandwidth, limit its
slew rate) and an electrode (T = R C, limit the current) are this equation, so neither can
blow up, whatever the ratio of span to T.
"""

from __future__ import annotations

import math

BISECTIONS = 60
EDGE = 1.0e-9


def weights(z: float) -> tuple[float, float, float, float]:
    """exp(-z) and the weights of a constant, linear and quadratic target over a span z T.

    w0 = 1 - e^-z, w1 = 1 - w0/z, w2 = 1 - 2 w1/z; series below z = 0.01, where the
    differences would cancel.
    """
    fade = math.exp(-z)
    w0 = -math.expm1(-z)
    if z < 0.01:
        w1 = z * (0.5 - z * (1.0 / 6.0 - z * (1.0 / 24.0 - z * (1.0 / 120.0 - z / 720.0))))
        w2 = z * (1.0 / 3.0 - z * (1.0 / 12.0 - z * (1.0 / 60.0 - z * (1.0 / 360.0 - z / 2520.0))))
        return fade, w0, w1, w2
    w1 = 1.0 - w0 / z
    return fade, w0, w1, 1.0 - 2.0 * w1 / z


def relaxed(y: float, g0: float, g1: float, g2: float, lag: float, s: float) -> float:
    """y(s) of y' = (g0 + g1 t + g2 t^2 - y)/lag without a rate limit."""
    fade, w0, w1, w2 = weights(s / lag)
    return y * fade + g0 * w0 + (g1 * w1 + g2 * w2 * s) * s


def pull(y: float, g0: float, g1: float, g2: float, lag: float, s: float) -> float:
    """Rate (g(s) - y(s))/lag after an unlimited relaxation over `s`."""
    return (g0 + (g1 + g2 * s) * s - relaxed(y, g0, g1, g2, lag, s)) / lag


def segment(
    y: float, g0: float, g1: float, g2: float, lag: float, limit: float, span: float
) -> tuple[float, float]:
    """Duration and mode of the first stretch without a change of mode.

    Mode 0 relaxes freely, +1 and -1 move at the limit. The change is found by bisection
    where the mode at the end of the span differs from that at its start. On the edge
    between modes, within a relative 1e-9, the direction of the rate decides.
    """
    start = (g0 - y) / lag
    leaving = start * (g1 - start) > 0.0
    margin = limit * EDGE
    if math.fabs(start) < limit - margin or (math.fabs(start) <= limit + margin and not leaving):
        if math.fabs(pull(y, g0, g1, g2, lag, span)) <= limit + 2.0 * margin:
            return span, 0.0
        low = 0.0
        high = span
        for i in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if math.fabs(pull(y, g0, g1, g2, lag, middle)) <= limit + 2.0 * margin:
                low = middle
            else:
                high = middle
        return high, 0.0
    mode = math.copysign(1.0, start)
    rate = mode * limit
    if mode * (g0 + (g1 + g2 * span) * span - y - rate * span) >= limit * lag:
        return span, mode
    low = 0.0
    high = span
    for i in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if mode * (g0 + (g1 + g2 * middle) * middle - y - rate * middle) >= limit * lag:
            low = middle
        else:
            high = middle
    return high, mode


def limited(
    y: float, g0: float, g1: float, g2: float, lag: float, limit: float, span: float
) -> float:
    """y after `span` with the rate limit in force."""
    left = span
    while left > 0.0:
        duration, mode = segment(y, g0, g1, g2, lag, limit, left)
        if mode == 0.0:
            y = relaxed(y, g0, g1, g2, lag, duration)
        else:
            y = y + mode * limit * duration
        g0 = g0 + (g1 + g2 * duration) * duration
        g1 = g1 + 2.0 * g2 * duration
        left = left - max(duration, 1.0e-6 * span)
    return y
