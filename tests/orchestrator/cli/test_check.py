"""`resilin check`: what it says of FMUs, and its exit code."""

from __future__ import annotations

from pathlib import Path

from typer.testing import CliRunner

from orchestrator import cli
from tests.foreign.rewritten import rewritten
from tests.foreign.scenarios import Shelf, each_version, hold, part, scenario

OTHER = ('<Unit name="1"', '<Unit name="other"')


def checked(*arguments: str | Path) -> tuple[int, list[str]]:
    result = CliRunner().invoke(cli.app, ["check", *map(str, arguments)])
    return result.exit_code, result.stdout.splitlines()


@each_version
def test_a_clean_fmu(version: int, shelf: Shelf) -> None:
    path = shelf("GAIN", version)
    assert checked("--strict", path) == (0, [f"{path}: usable; 0 errors, 0 warnings"])


@each_version
def test_findings_of_ours_and_of_fmpy(version: int, shelf: Shelf, tmp_path: Path) -> None:
    path = rewritten(shelf("GAIN", version), tmp_path / "lax.fmu", OTHER)
    code, lines = checked(path)
    assert code == 0
    assert any("warning: modelDescription.xml: line " in line for line in lines)
    assert any("warning: fmpy: " in line for line in lines)
    assert checked("--strict", path)[0] == 1


def test_errors_are_all_listed(shelf: Shelf, tmp_path: Path) -> None:
    changes = [(f'name="{name}"', 'name=""') for name in ("u", "gain")]
    code, lines = checked(rewritten(shelf("GAIN", 2), tmp_path / "bad.fmu", *changes))
    assert code == 1
    assert sum("error: modelDescription.xml: line " in line for line in lines) == 3
    assert "refused; 3 errors" in lines[-1]


def test_an_fmu_for_another_platform_is_an_error(shelf: Shelf, tmp_path: Path) -> None:
    path = rewritten(shelf("GAIN", 2), tmp_path / "far.fmu", platform="elsewhere")
    code, lines = checked(path, shelf("GAIN", 2))
    assert code == 1
    assert "error: no binary for " in lines[0]
    assert "(available: elsewhere)" in lines[0]


def test_what_is_no_fmu(tmp_path: Path) -> None:
    (tmp_path / "text.fmu").write_text("text")
    code, lines = checked(tmp_path / "text.fmu", tmp_path / "missing.fmu")
    assert code == 1
    assert "not a zip archive" in lines[0]
    assert "missing.fmu: error: no such file" in lines[2]


def test_a_scenario_has_all_its_fmus_checked(shelf: Shelf, tmp_path: Path) -> None:
    """Each file once, also where several components use it."""
    lax = rewritten(shelf("GAIN", 2), tmp_path / "lax.fmu", OTHER)
    decay = shelf("DECAY", 2)
    parts = (part("a", lax), part("b", lax), part("source", decay))
    path = scenario(tmp_path, *parts, hold({"a.u": 0.0, "b.u": 0.0}))
    code, lines = checked(path)
    assert code == 0
    verdicts = [line for line in lines if ": usable; " in line]
    assert [line.partition(":")[0] for line in verdicts] == [str(lax), str(decay)]
    assert any(line.startswith(f"{lax}: warning: ") for line in lines)
    assert checked("--strict", path)[0] == 1


def test_what_inspect_refuses_is_refused(tmp_path: Path, shelf: Shelf) -> None:
    path = scenario(tmp_path, part("a", shelf("GAIN", 2), start={"gian": 2.0}))
    refused = [CliRunner().invoke(cli.app, [name, str(path)]) for name in ("check", "inspect")]
    assert [done.exit_code for done in refused] == [2, 2]
    assert refused[0].stderr == refused[1].stderr
    assert "did you mean 'gain'" in refused[0].stderr


def test_names_are_those_of_parts_and_shipped_scenarios(library: Path) -> None:
    code, lines = checked("spring", "oscillator-1", "--fmus", library)
    assert (code, len(lines)) == (0, 3)
    assert lines[0] == f"{library / 'spring.fmu'}: usable; 0 errors, 0 warnings"
    assert checked("oscilator-1", "--fmus", library)[0] == 2
