"""Sections beyond the paper: questions that it raises and a run can answer."""
