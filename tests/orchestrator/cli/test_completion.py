"""What the shell offers on Tab, asked as bash asks."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from orchestrator.cli import app


def offered(*words: str | Path) -> list[str]:
    """Completions of the last word."""
    environment = {
        "_RESILIN_COMPLETE": "complete_bash",
        "COMP_WORDS": " ".join(["resilin", *map(str, words)]),
        "COMP_CWORD": str(len(words)),
    }
    done = CliRunner().invoke(app, [], env=environment, prog_name="resilin")
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.stdout.split()


def test_scenarios_and_files_are_offered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "flapping-mine.toml").touch()
    found = offered("run", "flapping-")
    assert {"flapping-full-wings", "flapping-mine.toml"} <= set(found)
    assert all(each.startswith("flapping-") for each in found)


@pytest.mark.parametrize(
    ("option", "begun", "word"),
    [
        ("--master", "inter", "interface-newton"),
        ("--laws", "h", "held"),
        ("--set", "payload.ma", "payload.mass="),
    ],
)
def test_values_of_options_are_offered(option: str, begun: str, word: str, library: Path) -> None:
    assert offered("run", "oscillator-1", "--fmus", library, option, begun) == [word]


def test_parts_are_offered(library: Path) -> None:
    assert offered("parts", "--fmus", library, "ampl") == ["amplifier"]


def test_a_wrong_line_offers_nothing(tmp_path: Path) -> None:
    assert offered("run", "oscilator-1", "--fmus", tmp_path, "--set", "payload.") == []
    assert offered("parts", "--fmus", tmp_path / "none", "ampl") == []


def test_start_values_are_offered_without_loading_an_fmu(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A step that is left open would be found by running the FMUs."""
    path = tmp_path / "open.toml"
    path.write_text('extends = "oscillator-1"\n[time]\nstep = "auto"\n')
    monkeypatch.setattr("orchestrator.simulation.auto_step.automatic_step", None)
    assert offered("run", path, "--fmus", library, "--set", "payload.ma") == ["payload.mass="]
