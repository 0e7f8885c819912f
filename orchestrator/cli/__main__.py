"""`python -m orchestrator.cli`: the command without its script."""

from . import entry

entry()
