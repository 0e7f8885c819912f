"""Other co-simulation tools beside ours, on the same FMUs: error against run time."""
