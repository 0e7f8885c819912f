"""The benchmark folders on the path; a good scenario; refusals of bad input."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import pytest

from tests.orchestrator.good_scenario import SCENARIO, Refuse, invoke

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a scenario in it and an own folder for temporary files."""
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    folder = tmp_path / "desk ä b"
    folder.mkdir()
    (folder / "good.toml").write_text(SCENARIO)
    monkeypatch.chdir(folder)
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    return folder


@pytest.fixture
def refuse(desk: Path, library: Path) -> Refuse:
    """Run arguments that must be refused as wrong input, and give the lines of complaint."""

    def run(*arguments: str) -> list[str]:
        code, lines, error = invoke(library, *arguments)
        assert isinstance(error, SystemExit), f"raw exception {error!r}"
        assert code == 2
        assert lines
        for line in lines:
            assert line.startswith("resilin: ")
            assert line.isprintable()
            assert len(line) < 1000
        assert not list(desk.rglob("*.nc*"))
        assert list(Path(tempfile.gettempdir()).iterdir()) == []
        return lines

    return run
