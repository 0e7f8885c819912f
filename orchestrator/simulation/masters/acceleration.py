"""From one guess of the interface to the next: ways to make passes converge sooner, or at all."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ...scenario.schema import MasterSettings
from ..coupled_instance import Values

DEPTH = 5


class Acceleration(Protocol):
    """Makes the next guess from a guess z and the result of a pass, G(z)."""

    def next(self, guess: Values, answer: Values) -> Values: ...


class Plain:
    """z <- G(z): converges where the gain of a pass is below one."""

    def next(self, guess: Values, answer: Values) -> Values:
        return answer


class Relaxed:
    """z <- z + r (G(z) - z) with a fixed r: converges for gains between 1 - 2/r and 1."""

    def __init__(self, relaxation: float) -> None:
        self.relaxation = relaxation

    def next(self, guess: Values, answer: Values) -> Values:
        return guess + self.relaxation * (answer - guess)


class Aitken:
    """Relaxation found from the last two residuals: r <- -r r_old.(d r)/|d r|^2 (Irons, Tuck)."""

    def __init__(self, relaxation: float) -> None:
        self._relaxation = relaxation
        self._residual: Values | None = None

    def next(self, guess: Values, answer: Values) -> Values:
        residual = answer - guess
        if self._residual is not None:
            change = residual - self._residual
            square = float(change @ change)
            if square > 0.0:
                self._relaxation *= -float(self._residual @ change) / square
                self._relaxation = float(np.clip(self._relaxation, -2.0, 2.0)) or 0.5
        self._residual = residual
        return guess + self._relaxation * residual


class Anderson:
    """Least-squares combination of the last few passes (Anderson 1965), depth `DEPTH`."""

    def __init__(self) -> None:
        self._guesses: list[Values] = []
        self._residuals: list[Values] = []

    def next(self, guess: Values, answer: Values) -> Values:
        self._guesses = [*self._guesses, guess][-DEPTH:]
        self._residuals = [*self._residuals, answer - guess][-DEPTH:]
        if len(self._guesses) == 1:
            return answer
        steps = np.diff(np.array(self._guesses), axis=0).T
        changes = np.diff(np.array(self._residuals), axis=0).T
        share = np.linalg.lstsq(changes, self._residuals[-1], rcond=1e-10)[0]
        following: Values = answer - (steps + changes) @ share
        return following


def acceleration(settings: MasterSettings) -> Acceleration:
    """The acceleration that a scenario asks for."""
    if settings.acceleration == "relaxed":
        return Relaxed(settings.relaxation)
    if settings.acceleration == "aitken":
        return Aitken(settings.relaxation)
    if settings.acceleration == "anderson":
        return Anderson()
    return Plain()
