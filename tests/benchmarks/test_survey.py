"""The survey of a folder of FMUs: a line for each, whatever becomes of it."""

from __future__ import annotations

from pathlib import Path

import pytest
import survey

from tests.foreign.rewritten import rewritten
from tests.foreign.scenarios import Shelf


def test_each_fmu_has_its_verdict(
    shelf: Shelf, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "fmus"
    (folder / "inner").mkdir(parents=True)
    rewritten(shelf("GAIN", 3), folder / "clean.fmu")
    rewritten(shelf("TYPES", 2), folder / "inner" / "types.fmu", ('name="Pace"', 'name="Pace|"'),
              ('declaredType="Pace"', 'declaredType="Pace|"'))  # fmt: skip
    rewritten(shelf("GAIN", 2), folder / "lax.fmu", ('<Unit name="1"', '<Unit name="other"'))
    rewritten(shelf("GAIN", 2), folder / "twice.fmu", ('name="u"', 'name="y"'))
    (folder / "text.fmu").write_text("text")
    assert survey.main([str(folder), "--run"]) == 0
    printed = capsys.readouterr().out
    rows = {line.split(" | ")[0][2:]: line for line in printed.splitlines() if ".fmu |" in line}
    assert "| read, runs |" in rows["clean.fmu"]
    assert "| read, runs |" in rows["inner/types.fmu"]
    assert "| read with warnings, runs | line " in rows["lax.fmu"]
    assert "| refused | line " in rows["twice.fmu"]
    assert "| refused | not a zip archive" in rows["text.fmu"]
    assert "5 FMUs: 2 read, runs, 2 refused, 1 read with warnings, runs" in printed


def test_a_folder_is_needed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("RESILIN_FMUS", raising=False)
    assert survey.main([]) == 2
    monkeypatch.setenv("RESILIN_FMUS", str(tmp_path))
    assert survey.main([]) == 0
