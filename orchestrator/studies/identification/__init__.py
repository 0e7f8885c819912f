"""Parameters of parts estimated from a recording of their inputs and outputs."""

from .case import Asked, Case, case_of
from .parameter import Unknown, unknowns_of
from .study import Identified, Settings, identify

__all__ = [
    "Asked",
    "Case",
    "Identified",
    "Settings",
    "Unknown",
    "case_of",
    "identify",
    "unknowns_of",
]
