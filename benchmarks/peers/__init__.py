"""Other co-simulation tools beside Resilin, on the same FMUs: error against run time."""
