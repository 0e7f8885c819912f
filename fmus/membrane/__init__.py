"""Antagonistic double cone of dielectric elastomer membranes."""
