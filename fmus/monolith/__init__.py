"""The same parts composed as one ordinary differential equation: the reference."""
