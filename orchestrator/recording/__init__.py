"""Recordings: measured or computed values over time that take the place of a part."""
