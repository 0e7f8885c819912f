"""Recordings: measured or computed values over time that stand where a part stands."""

from .columns import EVERY
from .keys import component_of
from .recording import Recording, open_recording

__all__ = ["EVERY", "Recording", "component_of", "open_recording"]
