"""A measured relation between variables."""
