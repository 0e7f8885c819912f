"""What an FMU says of itself: its modelDescription, read with care and checked."""

from .reading import read_interface
from .variable import EXACT, Interface, Variable

__all__ = ["EXACT", "Interface", "Variable", "read_interface"]
