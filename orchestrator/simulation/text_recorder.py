"""What records the texts of a run."""

from __future__ import annotations

from ..results.texts import Texts
from .system import System


class TextRecorder:
    """Notes recorded texts at the communication points whose rows are kept."""

    def __init__(self, system: System, every: int, texts: Texts) -> None:
        self._every = every
        self._begin = system.plan.keep_from
        self._texts = texts
        self._read = [
            (coupled.instance, wanted)
            for coupled in system.instances
            if (wanted := [v for c, v in system.plan.texts if c == coupled.instance.name])
        ]

    def sample(self, system: System, step: int, time: float) -> None:
        if step % self._every or time < self._begin:
            return
        for instance, wanted in self._read:
            for variable, text in zip(wanted, instance.texts(wanted), strict=True):
                self._texts.note(f"{instance.name}.{variable.name}", time, text)
