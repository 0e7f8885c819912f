"""Studies: many runs of a scenario, and what follows from them together."""
