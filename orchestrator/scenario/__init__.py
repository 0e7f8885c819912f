"""A scenario: the TOML text, checked against its FMUs, nothing loaded."""
