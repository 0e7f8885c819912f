"""System structures of the SSP standard, 1.0 and 2.0, read as scenarios."""

from .read import read_ssp

__all__ = ["read_ssp"]
