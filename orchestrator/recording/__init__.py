"""Recordings: measured or computed values over time that stand where a part stands."""
