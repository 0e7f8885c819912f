"""What can be known at once is said before anything is loaded, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.simulation.system import System

STILL = "--set amplifier.waveform=external"


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("linearise oscillator-1", "off by --set amplifier.amplitude=0"),
        (f"linearise oscillator-1 {STILL} --input payload.force", "is not held"),
        (f"linearise oscillator-1 {STILL} --variable payload.displacment", "did you mean"),
        (f"linearise oscillator-1 {STILL} --output b.docx", "name it *.png"),
        (f"linearise oscillator-1 {STILL} --output file/b.svg", "cannot be made"),
        (f"linearise oscillator-1 {STILL} --output b.svg --beside none.nc", "none.nc: cannot be"),
        (f"linearise oscillator-1 {STILL} --beside none.nc", "goes into the plot of --output"),
        ("run oscillator-1 --output file/a.nc", "cannot be made"),
        ("run oscillator-1 --html file/a.html", "cannot be made"),
        ("run oscillator-1 --html a.txt", "name it *.html"),
        ("sweep oscillator-1 --over payload.mass=1,2g --output file/a.nc", "cannot be made"),
        ("record oscillator-1 --part paylod", "no such component"),
        ("record oscillator-1 --part payload --output file/a.csv", "cannot be made"),
        ("precision oscillator-1 --variable payload.displacment", "did you mean"),
        ("precision oscillator-1 --use 1e-3", "oscillator-1-0.001.toml: is there already"),
        ("precision oscillator-1 --output file/a.csv", "cannot be made"),
        ("stability oscillator-1 --output file/a.csv", "cannot be made"),
        ("export oscillator-1 --output file/a.ssp", "cannot be made"),
        ("inspect oscillator-1 --stability --output a.pdf", "name it *.svg"),
    ],
)
def test_it_is_refused_before_an_fmu_is_loaded(
    line: str, reason: str, library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def loaded(*arguments: object) -> None:
        raise AssertionError("an FMU is loaded")

    monkeypatch.setattr(System, "__init__", loaded)
    monkeypatch.chdir(tmp_path)
    for name in ("file", "oscillator-1-0.001.toml"):
        Path(name).touch()
    done = CliRunner().invoke(app, [*line.split(), "--fmus", str(library)])
    assert done.exit_code == 2, done.output
    assert reason in done.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "oscillator-1-0.001.toml"]
