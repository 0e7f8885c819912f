"""Reference solutions, with which other runs are compared."""
