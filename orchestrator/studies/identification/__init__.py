"""Parameters of parts estimated from a recording of what went in and what came out."""

from .case import Asked, Case, case_of
from .study import Identified, Settings, identify
from .unknown import Unknown, unknowns_of

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
