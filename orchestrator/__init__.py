"""Co-simulation of FMUs: scene to checked system to result."""
