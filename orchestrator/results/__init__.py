"""What a run leaves behind: rows, files, figures, plots."""
