"""Parameters fitted to data of the paper: which to which, how well, and how surely."""

from .fits import Datum, Fit, Parameter, Profile, load_fits, shipped
from .profile import Point, profile
from .study import Calibration, calibrate

__all__ = [
    "Calibration", "Datum", "Fit", "Parameter", "Point", "Profile", "calibrate", "load_fits",
    "profile", "shipped",
]  # fmt: skip
