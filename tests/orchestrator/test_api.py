"""The example of the README, as it is printed there."""

from __future__ import annotations

import contextlib
import io
import re
import subprocess
from pathlib import Path

import pytest

import orchestrator
from tests.processes import python

README = Path(__file__).parents[2] / "README.md"


def example() -> str:
    """The indented block that starts with the import."""
    found = re.search(
        r"^    from orchestrator import load, run\n(?:    .*\n)+", README.read_text(), re.MULTILINE
    )
    assert found is not None
    return "\n".join(line[4:] for line in found[0].splitlines())


def test_the_readme_runs(library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "fmus").symlink_to(library)
    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(example(), "README.md", "exec"), {})
    stroke, error = (float(word) for word in printed.getvalue().split())
    assert 0.8 < stroke < 1.3
    assert 0.0 < error < 1e-2


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
