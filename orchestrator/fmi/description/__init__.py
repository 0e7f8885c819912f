"""The model description of an FMU, read with care and checked."""

from .findings import Findings
from .read import examined, read_interface
from .variable import EVENT, EXACT, Interface, Variable

__all__ = [
    "EVENT",
    "EXACT",
    "Findings",
    "Interface",
    "Variable",
    "examined",
    "read_interface",
]
