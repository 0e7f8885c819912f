"""Worker processes that carry out the runs of a study."""
