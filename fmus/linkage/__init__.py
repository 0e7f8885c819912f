"""Slider-crank, double rocker and wing inertia."""
