"""Processes that carry the runs of a study."""
