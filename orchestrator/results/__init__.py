"""Results of a run: rows, files, metrics, plots."""
