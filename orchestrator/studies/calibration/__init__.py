"""Parameters fitted to data of the paper: which to which, how well, and how surely."""

from .fits import Datum, Fit, Parameter, load_fits, shipped
from .study import Calibration, calibrate

__all__ = ["Calibration", "Datum", "Fit", "Parameter", "calibrate", "load_fits", "shipped"]
