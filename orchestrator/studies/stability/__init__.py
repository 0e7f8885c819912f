"""Stiff and extreme cases by every master at a series of steps: the class of each run."""

from .cases import Case, load_cases
from .classification import CLASSES, Trial
from .study import PATIENCE, Study, stability

__all__ = ["CLASSES", "PATIENCE", "Case", "Study", "Trial", "load_cases", "stability"]
