"""Stiff and extreme cases by every master over a ladder of steps: what becomes of each run."""

from .cases import Case, load_cases
from .study import Study, stability
from .verdict import CLASSES, Trial

__all__ = ["CLASSES", "Case", "Study", "Trial", "load_cases", "stability"]
