"""What a part offers."""

from __future__ import annotations

import json
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console
from rich.table import Table
from typer.testing import CliRunner, Result

from orchestrator.cli import app
from orchestrator.fmi.description import read_interface
from orchestrator.report.whole_names import keep_whole
from orchestrator.scenario.part_inspection import part_facts, part_tables, parts
from tests.foreign.scenarios import Shelf, each_version


def resilin(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "80"})


def test_facts_of_a_part(library: Path) -> None:
    facts = part_facts(parts(library)["amplifier"])
    frequency, waveform = (facts["parameters"][name] for name in ("frequency", "waveform"))
    assert frequency["unit"] == "Hz" and frequency["least"] == 0.0
    assert frequency["meaning"] == "Frequency" and facts["description"]
    assert frequency["provenance"].startswith("printed: ")
    assert "square" in waveform["choices"] and waveform["start"] in waveform["choices"]
    (top,) = (p for p in facts["ports"] if (p["port"], p["direction"]) == ("top", "out"))
    assert top["members"]["top.voltage"]["unit"] == "V"


def test_every_part_is_listed(library: Path) -> None:
    listed = json.loads(resilin("parts", "--fmus", library, "--json").stdout)
    names = sorted(path.stem for path in library.glob("*.fmu"))
    assert [entry["part"] for entry in listed] == names
    assert all(entry["description"] for entry in listed)
    shown = resilin("parts", "--fmus", library).output
    assert [line.split()[0] for line in shown.splitlines()] == names


@pytest.mark.parametrize("command", ["parts", "inspect"])
def test_a_part_is_shown_by_name_and_by_file(command: str, library: Path) -> None:
    done = resilin(command, "amplifier", "--fmus", library)
    assert done.exit_code == 0, done.output
    for word in ("frequency", "square", "Hz", "top", "voltage"):
        assert word in done.output
    file = resilin(command, library / "amplifier.fmu", "--fmus", library)
    assert file.output == done.output


def test_a_long_table_is_cut_and_says_so(library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orchestrator.scenario.part_inspection.MOST_ROWS", 3)
    part = parts(library)["amplifier"]
    tables = part_tables(part)
    assert [table.row_count for table in tables] == [3, 3]
    count = len(part_facts(part)["parameters"])
    assert str(tables[0].caption) == f"and {count - 3} more: --json gives all"


@pytest.mark.parametrize("name", ["aero", "amplifier", "linkage", "membrane"])
def test_every_name_is_shown_whole_in_a_narrow_terminal(library: Path, name: str) -> None:
    part = parts(library)[name]
    shown = resilin("parts", name, "--fmus", library).output.replace("│", " ").splitlines()
    for variable in part.of("parameter", "input", "output"):
        assert any(line.split()[:1] == [variable.name] for line in shown), variable.name
    assert "…" not in "".join(shown)


def test_members_of_a_port_have_direction_order_and_unit(library: Path) -> None:
    shown = resilin("parts", "linkage", "--fmus", library).output.replace("│", " ")
    rows = {line.split()[0]: line.split()[1:4] for line in shown.splitlines() if line.split()}
    assert rows["load.torque"] == ["in", "value", "N.m"]
    assert rows["load.added_inertia_slope"] == ["in", "curvature", "kg.m2.s"]
    assert rows["motion.reference_time"] == ["out", "affine", "s"]


def test_names_too_long_for_the_terminal_are_folded_not_cut() -> None:
    table = Table("from", "to")
    ends = ("first_" * 12, "second_" * 12)
    table.add_row(*ends)
    console = Console(width=80, record=True, file=StringIO())
    console.print(keep_whole(table, 0, 1))
    rows = [line.split("│")[1:3] for line in console.export_text().splitlines()[3:-1]]
    assert tuple("".join(row[k].strip() for row in rows) for k in range(2)) == ends


@each_version
def test_foreign_fmus_are_shown_too(version: int, shelf: Shelf) -> None:
    path = shelf("TYPES", version)
    facts = part_facts(read_interface(path))
    assert json.loads(resilin("parts", path, "--json").stdout) == facts
    assert resilin("parts", path).exit_code == 0


def test_what_is_not_there_is_refused(library: Path, tmp_path: Path) -> None:
    wrong = resilin("parts", "amplifer", "--fmus", library)
    assert wrong.exit_code == 2 and "did you mean 'amplifier'" in wrong.stderr
    empty = resilin("parts", "--fmus", tmp_path)
    assert empty.exit_code == 2 and "run: resilin build" in empty.stderr
