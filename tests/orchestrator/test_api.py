"""The names that the package offers."""

from __future__ import annotations

import subprocess

import pytest

import orchestrator
from tests.processes import python


def test_the_names_stay_functions() -> None:
    """Whatever has been imported before."""
    code = (
        "import orchestrator, orchestrator.simulation.run, orchestrator.results.netcdf\n"
        "assert orchestrator.__all__ == sorted(orchestrator.HOMES)\n"
        "assert all(callable(getattr(orchestrator, name)) for name in orchestrator.__all__)\n"
    )
    subprocess.run(python("-c", code), check=True)
    with pytest.raises(AttributeError, match="no attribute 'walk_away'"):
        _ = orchestrator.walk_away
