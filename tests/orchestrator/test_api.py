"""The names that the package offers."""

from __future__ import annotations

import subprocess
from importlib import resources

import pytest

import orchestrator
import resilin
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


def test_resilin_is_the_same_names() -> None:
    """`Result` is the outcome of a run; the rest is called as in the package behind it."""
    assert list(resilin.__all__) == sorted(resilin.__all__)
    assert resilin.Result is orchestrator.Outcome
    behind = {"Result", "ResilinError"}
    for name in set(resilin.__all__) - behind:
        assert getattr(resilin, name) is getattr(orchestrator, name)
    assert set(orchestrator.__all__) - {"Outcome"} == set(resilin.__all__) - behind
    assert resilin.__version__ != "unknown"


@pytest.mark.parametrize("package", ["orchestrator", "resilin"])
def test_types_are_there_for_users(package: str) -> None:
    assert (resources.files(package) / "py.typed").is_file()
