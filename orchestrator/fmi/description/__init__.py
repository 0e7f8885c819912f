"""The model description of an FMU, read with care and checked."""

from .read import read_interface
from .variable import EVENT, EXACT, Interface, Variable

__all__ = ["EVENT", "EXACT", "Interface", "Variable", "read_interface"]
