"""A run in a process beside the master's, with all its instances: foreign code at full speed."""
