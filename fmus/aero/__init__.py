"""Quasi-steady aerodynamic load of the wing pair."""
