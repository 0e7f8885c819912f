"""Recordings: measured or computed values over time that stand where a part stands."""

from .recording import Recording, open_recording

__all__ = ["Recording", "open_recording"]
