"""The command line against bad scenarios, options, files and signals: an exit code, one line per
problem that names file, key and remedy, and nothing left behind.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray
from fmpy import platform
from typer.testing import CliRunner

from orchestrator import cli
from orchestrator.results import netcdf
from orchestrator.simulation.interrupt import Interrupt
from tests.foreign.build import foreign

SCENARIO = """\
[time]
stop = "0.01 s"
step = "1e-3 s"

[components.payload]
fmu = "payload"
start = { mass = "1 g" }

[hold]
"payload.force.value" = "0.1 N"
"""
STEP = 'step = "1e-3 s"'
MASS = 'mass = "1 g"'
HOLD = '"payload.force.value" = "0.1 N"'
PART = 'fmu = "payload"'
TIME = 'stop = "0.01 s"\nstep = "1e-3 s"'
TWO = """
[components.spring]
fmu = "spring"

[[wires]]
from = "spring.force"
to = "payload.force"

[[wires]]
from = "payload.motion"
to = "spring.motion"
"""
ACTING = f"""{SCENARIO}
[[actions]]
at = "5 ms"
set = {{ "payload.force.value" = "0.2 N" }}
"""
AT = 'at = "5 ms"'
SET = '"payload.force.value" = "0.2 N"'
TYPED = """\
[time]
stop = "0.01 s"
step = "1e-3 s"

[components.types]
fmu = "./types.fmu"

[hold]
"types.in_real" = 1
"types.in_integer" = 1
"types.in_boolean" = true
"types.in_enumeration" = "slow"
"""
COMMAND = [sys.executable, "-m", "orchestrator.cli", "run"]
Refuse = Callable[..., list[str]]


def changed(old: str, new: str) -> str:
    """The good scenario with one replacement, which must be there to be made."""
    assert old in SCENARIO
    return SCENARIO.replace(old, new, 1)


def acting(old: str, new: str) -> str:
    """The good scenario with an action, and one replacement in that."""
    assert old in ACTING
    return ACTING.replace(old, new, 1)


def mastered(kind: str, setting: str) -> str:
    """The good scenario with a setting of a master."""
    return f'{SCENARIO}\n[master]\nkind = "{kind}"\n{setting}\n'


def label(value: object) -> str | None:
    """Test name from the first thing that a message must hold."""
    return str(value[0])[:40] if isinstance(value, list) and value else ""


def invoke(library: Path, *arguments: str) -> tuple[int, list[str], BaseException | None]:
    """Exit code, lines on stderr and exception of `resilin run`."""
    options = ["--fmus", str(library), "--no-picture", "--quiet", "--output", "out.nc"]
    result = CliRunner().invoke(cli.app, ["run", *options, *arguments], color=True)
    return result.exit_code, result.stderr.split("\n")[:-1], result.exception


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


def test_good_scenario_runs_and_leaves_nothing(desk: Path, library: Path) -> None:
    code, lines, error = invoke(library, "good.toml")
    assert (code, lines, error) == (0, [], None)
    assert [p.name for p in desk.iterdir() if p.name != "good.toml"] == ["out.nc"]
    assert list(Path(tempfile.gettempdir()).iterdir()) == []


@pytest.mark.parametrize("text", ["\ufeff" + SCENARIO, SCENARIO.replace("\n", "\r\n")])
def test_mark_and_line_ends_of_windows_are_accepted(text: str, desk: Path, library: Path) -> None:
    (desk / "windows.toml").write_bytes(text.encode())
    assert invoke(library, "windows.toml")[0] == 0


@pytest.mark.parametrize(
    ("scenario", "reasons"),
    [
        ("missing.toml", ["missing.toml: no such scenario file"]),
        ("flaping-full-wings", ["did you mean 'flapping-full-wings'?"]),
        ("nosuch", ["no scenario 'nosuch'", "flapping-full-wings"]),
        ("./", ["is a folder"]),
        ("..", [".."]),
        ("", ["scenario"]),
        ("/dev/zero", ["/dev/zero"]),
        ("n" * 300, ["nnn"]),
        ("n" * 300 + ".toml", ["nnn"]),
        ("esc\x1b[31m.toml", ["\\x1b"]),
    ],
    ids=label,
)
def test_scenario_that_is_not_there(scenario: str, reasons: list[str], refuse: Refuse) -> None:
    (line,) = refuse(scenario)
    assert all(reason in line for reason in reasons), line


@pytest.mark.parametrize(
    ("text", "reasons"),
    [
        # TOML itself
        ("[time\nstop = 1", ["not TOML", "line 1"]),
        ("[time]\nstop == 1", ["not TOML", "line 2"]),
        (changed(HOLD, f"{HOLD}\n{HOLD}"), ["not TOML", "line 11"]),
        (SCENARIO + "[time]\n", ["not TOML", "line 11"]),
        ("a = " + "[" * 5000 + "]" * 5000, ["not TOML"]),
        ("a = " + "{a=" * 5000 + "1" + "}" * 5000, ["not TOML"]),
        ("a." * 5000 + "x = 1", ["a: "]),
        (SCENARIO + "\n[components.payload.start.mass." + "a." * 3000 + "a]", ["not TOML"]),
        (changed(MASS, "mass." + "a." * 3000 + "a = 1"), ["start.mass"]),
        (changed(STEP, "step = 1" + "0" * 5000), ["not TOML"]),
        (changed(STEP, "step = 1" + "0" * 400), ["time.step: "]),
        # unknown keys, at each level
        (SCENARIO + "[tim]\n", ["tim: unknown key", "did you mean 'time'?"]),
        ("tittle = 1\n" + SCENARIO, ["tittle: unknown key", "did you mean 'title'?"]),
        (changed("step =", "stepp ="), ["time.stepp: unknown key", "did you mean 'step'?"]),
        (changed(STEP, "step = { per_cyle = 9 }"), ["time.step", "did you mean 'per_cycle'?"]),
        (changed("start = {", "strat = {"), ["components.payload.strat", "'start'?"]),
        (SCENARIO + "[master]\nlaw = 1", ["master.law: unknown key", "did you mean 'laws'?"]),
        (SCENARIO + "[record]\nevry = 1", ["record.evry: unknown key", "did you mean 'every'?"]),
        (SCENARIO + "[metrics]\ncycle = 1", ["metrics.cycle: unknown key", "'cycles'?"]),
        (
            SCENARIO + '[[wires]]\nfrom="a"\nto="b"\ngian=1',
            ["wires.0.gian", "did you mean 'gain'?"],
        ),
        (SCENARIO + '[[wires]]\nfrom = "payload.motion"', ["wires", "to"]),
        (SCENARIO + "[components.other]", ["components.other.fmu: is missing"]),
        ('"esc\\u001b[31m" = 1\n' + SCENARIO, ["esc\\x1b[31m: unknown key"]),
        ('"a\\nb" = 1\n' + SCENARIO, ["a\\x0ab: unknown key"]),
        # tables and types
        ("components = 3", ["components: "]),
        ("components = { payload = 3 }", ["components.payload: "]),
        ("wires = 3\n" + SCENARIO, ["wires: "]),
        ("wires = [3]\n" + SCENARIO, ["wires", "expected a table"]),
        ("", ["components: a scenario needs at least one"]),
        (changed(STEP, "step = true"), ["time.step: ", "True"]),
        (changed(STEP, "step = [1]"), ["time.step: ", "[1]"]),
        (changed(STEP, 'step = ""'), ["time.step: "]),
        (changed(STEP, "step = nan"), ["time.step: ", "nan"]),
        (changed(STEP, "step = -inf"), ["time.step: ", "inf"]),
        (changed(STEP, "step = 1e999"), ["time.step: ", "inf"]),
        (changed(STEP, 'step = "nan"'), ["time.step: ", "finite"]),
        (changed(STEP, 'step = "1e999 s"'), ["time.step: ", "finite"]),
        (changed(STEP, "step = 2026-01-01"), ["time.step: ", "2026"]),
        (changed(STEP, "step = { per_cycle = 0 }"), ["time.step.per_cycle: ", "1"]),
        (changed(STEP, "step = { per_cycle = 1.5 }"), ["time.step.per_cycle: ", "1.5"]),
        (changed(HOLD, '"payload.force.value" = true'), ["hold.payload.force.value: "]),
        (changed(MASS, "mass = true"), ["components.payload.start.mass: "]),
        (changed(MASS, "mass = nan"), ["components.payload.start.mass: ", "nan"]),
        (changed(MASS, "mass = 1e999"), ["components.payload.start.mass: ", "inf"]),
        (changed(MASS, "mass = [2026-01-01]"), ["components.payload.start.mass: ", "2026"]),
        (changed(MASS, 'mass = ""'), ["components.payload.start.mass: "]),
        (SCENARIO + "[record]\nvariables = [2026-01-01]", ["record.variables"]),
        (SCENARIO + '[record]\nvariables = "*"', ["record.variables: ", "list"]),
        (SCENARIO + "[record]\nevery = 0", ["record.every: "]),
        (SCENARIO + '[master]\nlaws = "hold"', ["master.laws: ", "held"]),
        (SCENARIO + '[master]\nkind = "gaus-seidel"', ["master.kind: ", "'gauss-seidel'?"]),
        # parts and variables
        (changed(PART, 'fmu = "paylod"'), ["components.payload.fmu: ", "did you mean 'payload'?"]),
        (changed(PART, 'fmu = "p/payload.fmu"'), ["components.payload.fmu: ", "no such file"]),
        (changed(PART, 'fmu = "./"'), ["components.payload.fmu: ", "folder"]),
        (changed(PART, 'fmu = "a\\u0000.fmu"'), ["components.payload.fmu: "]),
        (changed(PART, 'fmu = "a\\u001b[31m.fmu"'), ["components.payload.fmu: ", "\\x1b"]),
        (changed(PART, f'fmu = "{"n" * 300}"'), ["components.payload.fmu: "]),
        (changed(PART, f'fmu = "{"n" * 300}.fmu"'), ["components.payload.fmu: "]),
        (changed(PART, 'fmu = ""'), ["components.payload.fmu: "]),
        (changed(MASS, "mas = 1"), ["components.payload.start.mas: ", "did you mean 'mass'?"]),
        (changed(MASS, "velocity = 1"), ["components.payload.start.velocity: ", "an output"]),
        (
            SCENARIO + '[record]\nvariables = ["payload.velocty"]',
            ["record.variables[0]", "velocity'"],
        ),
        (SCENARIO + '[master]\norder = ["payload", "payload"]', ["master.order: ", "twice"]),
        # units and bounds
        (changed(STEP, 'step = "50 kg"'), ["time.step: ", "expected a quantity in s", "'50 kg'"]),
        (changed(STEP, 'step = "1 fortnite"'), ["time.step: ", "expected a quantity in s"]),
        (changed(STEP, 'step = "1 cycles"'), ["time.step: ", "give time.frequency"]),
        (changed(STEP, "step = { per_cycle = 9 }"), ["time.step: ", "give time.frequency"]),
        (changed(STEP, 'step = "s"'), ["time.step: ", "not a number with a unit"]),
        (changed(MASS, 'mass = "1 m"'), ["components.payload.start.mass: ", "in kg", "'1 m'"]),
        (changed(MASS, 'mass = "20 degC"'), ["components.payload.start.mass: ", "degC"]),
        (changed(MASS, 'mass = "-1 g"'), ["components.payload.start.mass: ", "'-1 g' is outside"]),
        (changed(MASS, "mass = -1"), ["components.payload.start.mass: ", "-1.0 is outside"]),
        (changed(MASS, 'mass = "1e308 Gg"'), ["components.payload.start.mass: ", "1e308 Gg"]),
        # time
        (changed(STEP, 'step = "0 s"'), ["time.step: must be above zero"]),
        (changed(STEP, "step = -1"), ["time.step: must be above zero"]),
        (changed(STEP, 'step = "1 s"'), ["time.step: ", "longer than the run"]),
        (changed(STEP, "step = 1e-300"), ["time.step: ", "steps"]),
        (changed('stop = "0.01 s"', "stop = 0"), ["time.stop: ", "not after"]),
        (changed('stop = "0.01 s"', 'stop = "1e308 day"'), ["time.s"]),
        (changed(TIME, 'frequency = "1e-320 Hz"'), ["time."]),
    ],
    ids=label,
)
def test_bad_scenario_is_one_line(
    text: str, reasons: list[str], refuse: Refuse, desk: Path
) -> None:
    (desk / "bad.toml").write_text(text)
    (line,) = refuse("bad.toml")
    assert "bad.toml: " in line
    assert all(reason in line for reason in reasons), line


@pytest.mark.parametrize(
    ("text", "reasons"),
    [
        # time.tolerance
        (changed(STEP, f"{STEP}\ntolerance = 0"), ["time.tolerance: ", "greater than 0, got 0"]),
        (changed(STEP, f"{STEP}\ntolerance = 1"), ["time.tolerance: ", "less than 1, got 1"]),
        (changed(STEP, f"{STEP}\ntolerance = -1e-3"), ["time.tolerance: ", "got -0.001"]),
        (changed(STEP, f'{STEP}\ntolerance = "1e-3"'), ["time.tolerance: ", "got '1e-3'"]),
        (changed(STEP, f"{STEP}\ntolerance = true"), ["time.tolerance: ", "got True"]),
        (changed(STEP, f"{STEP}\ntolerance = nan"), ["time.tolerance: ", "got nan"]),
        (changed(STEP, f"{STEP}\ntolerance = []"), ["time.tolerance: ", "got []"]),
        # isolation
        (changed(PART, f'{PART}\nisolate = "yes"'), ["components.payload.isolate: ", "'yes'"]),
        (changed(PART, f"{PART}\nisolate = 1"), ["components.payload.isolate: ", "got 1"]),
        (changed(PART, f'{PART}\npatience = "1 kg"'), ["payload.patience: ", "in s", "'1 kg'"]),
        (changed(PART, f'{PART}\npatience = "2 cycles"'), ["payload.patience: ", "in s"]),
        (changed(PART, f'{PART}\npatience = "long"'), ["payload.patience: ", "not a number"]),
        (changed(PART, f'{PART}\npatience = "0 s"'), ["payload.patience: must be above zero"]),
        (changed(PART, f"{PART}\npatience = -1"), ["payload.patience: must be above zero"]),
        (changed(PART, f"{PART}\npatience = true"), ["payload.patience: ", "got True"]),
        (changed(PART, f"{PART}\npatience = inf"), ["payload.patience: ", "not a finite"]),
        (changed(PART, f'{PART}\nmemory = "1 s"'), ["payload.memory: ", "in byte", "'1 s'"]),
        (changed(PART, f'{PART}\nmemory = "1 GB/s"'), ["payload.memory: ", "in byte"]),
        (changed(PART, f'{PART}\nmemory = "-1 MB"'), ["payload.memory: must be above zero"]),
        (changed(PART, f"{PART}\nmemory = 0"), ["payload.memory: must be above zero"]),
        (changed(PART, f"{PART}\nmemory = {{}}"), ["payload.memory: ", "got {}"]),
        (changed(PART, f"{PART}\npatiense = 1"), ["payload.patiense: ", "'patience'?"]),
        # actions
        ("actions = 3\n" + SCENARIO, ["actions: expected a list of tables, written [[actions]]"]),
        ("actions = {}\n" + SCENARIO, ["actions: expected a list of tables, written [[actions]]"]),
        ("actions = [3]\n" + SCENARIO, ["actions.0: expected a table with at and a table set"]),
        (acting(AT, ""), ["actions.0.at: is missing"]),
        (acting(AT, "at = true"), ["actions.0.at: ", "got True"]),
        (acting(AT, "at = nan"), ["actions.0.at: nan is not a finite number"]),
        (acting(AT, 'at = "5 kg"'), ["actions[0].at: ", "a quantity in s", "'5 kg'"]),
        (acting(AT, 'at = "2 cycles"'), ["actions[0].at: ", "give time.frequency"]),
        (acting(AT, f"{AT}\nuntil = 1"), ["actions.0.until: unknown key; there is at, set"]),
        (acting(f"set = {{ {SET} }}", ""), ["actions.0: expected a table with at and a table set"]),
        (acting(f"set = {{ {SET} }}", "set = 3"), ["actions.0: expected a table with at and"]),
        (acting(SET, '"paylod.force.value" = 1'), ["set.paylod.force.value: ", "'payload'?"]),
        (acting(SET, '"payload.force.valeu" = 1'), ["set.payload.force.valeu: ", "force.value'?"]),
        (acting(SET, '"payload.mass" = 1'), ["set.payload.mass: is a fixed parameter"]),
        (acting(SET, '"payload.velocity" = 1'), ["set.payload.velocity: is a", "output"]),
        (acting(SET, '"payload.force.value" = "1 V"'), ["payload.force.value: ", "in N", "'1 V'"]),
        (acting(SET, '"payload.force.value" = true'), ["payload.force.value: true and false"]),
        (acting(SET, '"payload.force.value" = [1]'), ["payload.force.value: ", "got [1]"]),
        (acting(SET, "payload.force.value = 1"), ["actions.0.set.payload: ", "'force'"]),
        (acting(SET, f'{SET}, "payload.mass" = 1'), ["actions[0].set.payload.mass: "]),
        (acting(SET, '"esc\\u001b[31m.x" = 1'), ["actions[0].set.esc\\x1b[31m.x: no component"]),
        # settings of masters
        (mastered("extrapolated", "degree = 0"), ["master.degree: ", "equal to 1, got 0"]),
        (mastered("extrapolated", "degree = 4"), ["master.degree: ", "equal to 3, got 4"]),
        (mastered("extrapolated", "degree = 1.5"), ["master.degree: ", "got 1.5"]),
        (mastered("extrapolated", "degree = true"), ["master.degree: ", "got True"]),
        (mastered("iterative", 'acceleration = "fast"'), ["master.acceleration: ", "'aitken'"]),
        (mastered("iterative", "acceleration = 1"), ["master.acceleration: ", "got 1"]),
        (mastered("iterative", "relaxation = 0"), ["master.relaxation: ", "greater than 0"]),
        (mastered("iterative", "relaxation = 1.1"), ["master.relaxation: ", "equal to 1, got 1.1"]),
        (mastered("iterative", "relaxation = nan"), ["master.relaxation: ", "got nan"]),
        (mastered("iterative", "settled = 0"), ["master.settled: ", "greater than 0"]),
        (mastered("iterative", "settled = 0.1"), ["master.settled: ", "less than 0.1"]),
        (mastered("iterative", 'settled = "1e-9"'), ["master.settled: ", "got '1e-9'"]),
        (mastered("interface-newton", "passes = 1"), ["master.passes: ", "equal to 2, got 1"]),
        (mastered("interface-newton", "passes = 1001"), ["master.passes: ", "equal to 1000"]),
        (mastered("interface-newton", 'passes = "30"'), ["master.passes: ", "got '30'"]),
        (mastered("gauss-seidel", "degree = 1"), ["master.degree: means nothing to gauss-seidel"]),
        (mastered("jacobi", 'acceleration = "none"'), ["master.acceleration: means nothing to"]),
        (mastered("jacobi", "passes = 30"), ["master.passes: means nothing to jacobi"]),
        (mastered("extrapolated", "settled = 1e-9"), ["extrapolated, which takes degree"]),
        (mastered("iterative", "degree = 2"), ["which takes acceleration, relaxation, settled"]),
        (mastered("interface-newton", "relaxation = 0.5"), ["which takes settled, passes"]),
        # record.last
        (SCENARIO + "[record]\nlast = 0", ["record.last: must be above zero"]),
        (SCENARIO + '[record]\nlast = "-1 ms"', ["record.last: must be above zero"]),
        (SCENARIO + "[record]\nlast = true", ["record.last: ", "got True"]),
        (SCENARIO + "[record]\nlast = nan", ["record.last: nan is not a finite number"]),
        (SCENARIO + '[record]\nlast = ""', ["record.last: ", "got ''"]),
    ],
    ids=label,
)
def test_bad_setting_is_one_line(text: str, reasons: list[str], refuse: Refuse, desk: Path) -> None:
    (desk / "bad.toml").write_text(text)
    (line,) = refuse("bad.toml")
    assert "bad.toml: " in line
    assert all(reason in line for reason in reasons), line


def test_action_on_a_wired_input_is_refused(refuse: Refuse, desk: Path) -> None:
    held = '"spring.top.voltage" = "0 V"\n"spring.bottom.voltage" = "0 V"'
    (desk / "bad.toml").write_text(acting(HOLD, held) + TWO)
    (line,) = refuse("bad.toml")
    assert "actions[0].set.payload.force.value: is wired; an action sets tunable" in line


def test_every_setting_that_a_master_does_not_take_is_named(refuse: Refuse, desk: Path) -> None:
    (desk / "bad.toml").write_text(mastered("gauss-seidel", "degree = 1\npasses = 3"))
    keys = [line.split(": ")[2] for line in refuse("bad.toml")]
    assert keys == ["master.degree", "master.passes"]


@pytest.mark.parametrize(
    ("old", "new", "reasons"),
    [
        ("= true", "= 1", ["hold.types.in_boolean: expected true or false, got 1.0"]),
        ("= true", '= "true"', ["hold.types.in_boolean: expected true or false, got 'true'"]),
        ("= true", "= [true]", ["hold.types.in_boolean: ", "got [True]"]),
        ('"slow"', '"slo"', ["types.in_enumeration: 'slo' is not a choice; did you mean 'slow'?"]),
        ('"slow"', "1", ["types.in_enumeration: 1.0 is not a choice; there is fast, slow"]),
        ('"slow"', "true", ["types.in_enumeration: True is not a choice"]),
        ('"slow"', '""', ["hold.types.in_enumeration: ", "got ''"]),
        ('integer" = 1', 'integer" = true', ["in_integer: true and false are not numbers"]),
        ('integer" = 1', 'integer" = 1.5', ["in_integer: expected a whole number, got 1.5"]),
        ('integer" = 1', 'integer" = 1e10', ["in_integer: ", "does not fit Integer"]),
        ('integer" = 1', 'integer" = "slow"', ["in_integer: 'slow' is not a number"]),
        ('real" = 1', 'real" = false', ["types.in_real: true and false are not numbers"]),
    ],
)
def test_hold_of_another_type_is_refused(
    old: str, new: str, reasons: list[str], refuse: Refuse, desk: Path
) -> None:
    foreign("TYPES", desk)
    assert TYPED.count(old) == 1
    (desk / "bad.toml").write_text(TYPED.replace(old, new))
    (line,) = refuse("bad.toml")
    assert all(reason in line for reason in reasons), line


def test_good_actions_and_holds_of_every_type_run(desk: Path, library: Path) -> None:
    foreign("TYPES", desk)
    action = '[[actions]]\nat = 0.005\nset = { "types.in_boolean" = false }\n'
    for text in (ACTING, TYPED + action):
        (desk / "good.toml").write_text(text)
        assert invoke(library, "good.toml") == (0, [], None)


@pytest.mark.parametrize(
    ("text", "reasons"),
    [
        (SCENARIO + '[record]\nlast = "1 kg"', ["record.last: ", "in s", "'1 kg'"]),
        (SCENARIO + '[record]\nlast = "2 cycles"', ["record.last: ", "give time.frequency"]),
        (changed("force.value", "force.valeu"), ["hold.payload.force.valeu: ", "force.value'?"]),
        (changed("payload.force.value", "paylod.force.value"), ["hold.paylod", "'payload'?"]),
        (SCENARIO + '[master]\norder = ["paylod"]', ["master.order: ", "did you mean 'payload'?"]),
        (changed("0.1 N", "0.1 V"), ["hold.payload.force.value: ", "in N", "'0.1 V'"]),
        (changed(TIME, 'frequency = "0 Hz"'), ["time.frequency: must be above zero"]),
    ],
    ids=label,
)
def test_bad_scenario_is_named_beside_what_follows_from_it(
    text: str, reasons: list[str], refuse: Refuse, desk: Path
) -> None:
    (desk / "bad.toml").write_text(text)
    lines = refuse("bad.toml")
    assert any(all(reason in line for reason in reasons) for line in lines), lines


@pytest.mark.parametrize(
    ("wire", "reasons"),
    [
        ('from="spring.force.value"\nto="payload.force.value"', ["fed twice", "wires[0]"]),
        ('from="spring.forse"\nto="payload.force"', ["wires[2]", "did you mean 'force'?"]),
        ('from="spring.force"\nto="payload.forse"', ["wires[2]", "did you mean 'force'?"]),
        ('from="sprig.force"\nto="payload.force"', ["wires[2]", "did you mean 'spring'?"]),
        ('from="spring.force.value"\nto="payload.mass"', ["wires[2]", "parameter", ".start"]),
        ('from="payload.mass"\nto="spring.top.voltage"', ["wires[2]", "parameter"]),
        ('from="payload.force.value"\nto="spring.top.voltage"', ["wires[2]", "expected an output"]),
        ('from="payload.velocity"\nto="spring.force.value"', ["wires[2]", "expected an input"]),
        ('from="payload.displacement"\nto="spring.top.voltage"', ["m is not convertible to V"]),
        ('from="payload.motion"\nto="spring.top"', ["wires[2]", "share no member"]),
        ('from="spring"\nto="payload"', ["wires[2]", "no input '' in payload"]),
        ('from=""\nto="payload.force"', ["wires[2]", "no component ''"]),
        ('from="a\\u001b[31m"\nto="payload.force"', ["wires[2]", "a\\x1b"]),
    ],
    ids=label,
)
def test_bad_wire_is_named(wire: str, reasons: list[str], refuse: Refuse, desk: Path) -> None:
    held = '"spring.top.voltage" = "0 V"\n"spring.bottom.voltage" = "0 V"'
    (desk / "bad.toml").write_text(changed(HOLD, held) + TWO + f"[[wires]]\n{wire}")
    lines = [line for line in refuse("bad.toml") if "neither wired nor held" not in line]
    assert any(all(reason in line for reason in reasons) for line in lines), lines


def test_input_held_and_wired_is_refused(refuse: Refuse, desk: Path) -> None:
    (desk / "bad.toml").write_text(SCENARIO + TWO)
    lines = refuse("bad.toml")
    assert any("hold.payload.force.value: is wired too, by wires[0]" in line for line in lines)


def test_input_neither_wired_nor_held_is_refused(refuse: Refuse, desk: Path) -> None:
    (desk / "bad.toml").write_text(changed(HOLD, ""))
    (line,) = refuse("bad.toml")
    assert 'payload.force.value: neither wired nor held; wire it, or hold: "payload.force' in line


def test_all_problems_come_at_once(refuse: Refuse, desk: Path) -> None:
    text = changed(MASS, "mas = 1").replace("1e-3 s", "0 s").replace("force.value", "force.val")
    (desk / "bad.toml").write_text(text)
    keys = [line.split(": ")[2] for line in refuse("bad.toml")]
    assert {"components.payload.start.mas", "hold.payload.force.val", "time.step"} <= set(keys)


@pytest.mark.parametrize(
    ("base", "top", "reason"),
    [
        (SCENARIO, 'extends = "bad.toml"', "extends itself: bad.toml -> bad.toml"),
        ('extends = "bad.toml"', 'extends = "base.toml"', "extends itself: bad.toml -> base.toml"),
        (SCENARIO, "extends = 3", "extends: "),
        (SCENARIO, 'extends = "bsae.toml"', "bsae.toml: no such scenario file"),
        (SCENARIO, 'extends = "oscilator-1"', "did you mean 'oscillator-1'?"),
        (SCENARIO, 'extends = "a\\u001b[31m.toml"', "a\\x1b"),
        (SCENARIO, 'extends = "a\\u0000.toml"', "no such scenario file"),
        (SCENARIO, f'extends = "{"n" * 300}.toml"', "nnn"),
        (SCENARIO, 'extends = "base.toml"\nwithout = ["paylod"]', "without: no component 'paylod'"),
        (SCENARIO, 'extends = "base.toml"\nwithout = "payload"', "without: expected a list"),
        (SCENARIO, 'extends = "base.toml"\nwithout = [["payload"]]', "without"),
        (SCENARIO, 'extends = "base.toml"\nwithout = [1]', "without"),
        (SCENARIO, SCENARIO.join(['without = ["payload"]\n', ""]), "without: "),
        (SCENARIO, 'extends = "base.toml"\nwires = 3', "wires: "),
        (SCENARIO, 'extends = "base.toml"\nwires = [3]', "wires"),
        ("hold = 3", 'extends = "base.toml"\nwires = []', "hold: "),
        ("components = 3", 'extends = "base.toml"\nwithout = ["payload"]', "components: "),
        ("wires = [3]\n" + SCENARIO, 'extends="base.toml"\nwithout=["payload"]', "wires"),
        ("wires = 3\n" + SCENARIO, 'extends="base.toml"\nwithout=["payload"]', "wires: "),
        ("record = 3\n" + SCENARIO, 'extends="base.toml"\nwithout=["payload"]', "record: "),
        (
            "record.variables = [3]\n" + SCENARIO,
            'extends="base.toml"\nwithout=["payload"]',
            "record.",
        ),
        ("a." * 3000 + "x = 1", 'extends = "base.toml"\n' + "a." * 3000 + "y = 1", ""),
    ],
    ids=label,
)
def test_bad_extension_is_refused(
    base: str, top: str, reason: str, refuse: Refuse, desk: Path
) -> None:
    (desk / "base.toml").write_text(base)
    (desk / "bad.toml").write_text(top)
    assert any(reason in line for line in refuse("bad.toml"))


@pytest.mark.timeout(10)
def test_unit_that_would_compute_for_ever_is_refused(refuse: Refuse, desk: Path) -> None:
    (desk / "bad.toml").write_text(changed(STEP, 'step = "1 s*9**9**9**9"'))
    (line,) = refuse("bad.toml")
    assert "time.step: " in line


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (SCENARIO.encode("utf-16"), "UTF-8"),
        (b"title = '\xff\xfe'\n", "UTF-8"),
        (b"title = 'a\x00b'\n", "not TOML"),
        (b"#" * (2 << 20), "larger than"),
    ],
    ids=label,
)
def test_scenario_of_bad_bytes(data: bytes, reason: str, refuse: Refuse, desk: Path) -> None:
    (desk / "bad.toml").write_bytes(data)
    (line,) = refuse("bad.toml")
    assert "bad.toml: " in line
    assert reason in line


@pytest.mark.parametrize(
    ("options", "reasons"),
    [
        (["--set", "payload.mass"], ["--set 'payload.mass'", "component.parameter=value"]),
        (["--set", "mass=1"], ["--set 'mass=1'", "component.parameter=value"]),
        (["--set", "="], ["component.parameter=value"]),
        (["--set", "payload.=1"], ["payload.", "parameter"]),
        (["--set", "paylod.mass=1"], ["did you mean 'payload'?"]),
        (["--set", "payload.mas=1"], ["start.mas: ", "did you mean 'mass'?"]),
        (["--set", "payload.mass=1 m"], ["start.mass: ", "in kg", "'1 m'"]),
        (["--set", "payload.mass="], ["start.mass: "]),
        (["--set", "payload.mass=nan"], ["start.mass: ", "finite"]),
        (["--set", "payload.mass=true"], ["start.mass: ", "'true'"]),
        (["--set", "payload.velocity=1"], ["start.velocity: ", "output"]),
        (["--set", "esc\x1b[31m.x=1"], ["\\x1b"]),
        (["--laws", "hold"], ["master.laws: ", "held"]),
        (["--fmus", "nowhere"], ["components.payload.fmu: ", "run: resilin build"]),
        (["--output", "out.txt"], ["out.txt: ", "name it *.nc"]),
        (["--output", "out"], ["out: ", "name it *.nc"]),
        (["--output", "n" * 300 + ".nc"], ["nnn"]),
        (["--output", "good.toml/out.nc"], ["good.toml: ", "cannot be made"]),
        (["--output", "/proc/out.nc"], ["/proc: ", "not writable"]),
        (["--output", "/proc/new/out.nc"], ["/proc/new: ", "cannot be made"]),
    ],
    ids=label,
)
def test_bad_option_is_refused(options: list[str], reasons: list[str], refuse: Refuse) -> None:
    (line,) = refuse("good.toml", *options)
    assert all(reason in line for reason in reasons), line


def test_folder_in_the_place_of_the_result_is_refused(desk: Path, library: Path) -> None:
    (desk / "out.nc").mkdir()
    code, lines, _ = invoke(library, "good.toml")
    assert (code, lines) == (2, ["resilin: out.nc: is a folder; name a file"])


@pytest.mark.parametrize("scenario", ["bad.toml", "nowhere"])
def test_earlier_result_outlives_a_refused_run(scenario: str, desk: Path, library: Path) -> None:
    (desk / "bad.toml").write_text(changed(MASS, "mas = 1"))
    (desk / "out.nc").write_bytes(b"earlier")
    assert invoke(library, scenario)[0] == 2
    assert (desk / "out.nc").read_bytes() == b"earlier"


@pytest.mark.parametrize(
    ("text", "option"),
    [
        ("components = 3", ["--set", "payload.mass=1"]),
        ("components.payload = 3", ["--set", "payload.mass=1"]),
        ("components.payload.start = 3", ["--set", "payload.mass=1"]),
        ("master = 3", ["--laws", "held"]),
    ],
    ids=label,
)
def test_option_on_a_bad_scenario_is_refused(
    text: str, option: list[str], refuse: Refuse, desk: Path
) -> None:
    (desk / "bad.toml").write_text(text)
    refuse("bad.toml", *option)


def copied(source: Path, target: Path, keep: Callable[[str], bool]) -> None:
    """Copy those entries of an archive that are to be kept."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in filter(keep, old.namelist()):
            new.writestr(name, old.read(name))


def test_file_that_is_no_zip_is_refused(refuse: Refuse, desk: Path) -> None:
    (desk / "own.fmu").write_bytes(b"MZ\x1b[31m not a zip")
    (desk / "bad.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    (line,) = refuse("bad.toml")
    assert "components.payload.fmu: " in line
    assert "own.fmu: not a zip archive, 17 bytes" in line


def test_zip_without_description_is_refused(refuse: Refuse, desk: Path, library: Path) -> None:
    copied(library / "payload.fmu", desk / "own.fmu", lambda name: not name.endswith(".xml"))
    (desk / "bad.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    (line,) = refuse("bad.toml")
    assert "own.fmu: not an FMU: no modelDescription.xml" in line


def test_fmu_for_another_platform_is_refused(refuse: Refuse, desk: Path, library: Path) -> None:
    copied(library / "payload.fmu", desk / "own.fmu", lambda name: platform not in name)
    (desk / "bad.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    (line,) = refuse("bad.toml")
    assert f"own.fmu: no binary for {platform} (there is: " in line
    assert "rebuild" in line


def test_binary_that_is_none_is_refused(refuse: Refuse, desk: Path, library: Path) -> None:
    copied(library / "payload.fmu", desk / "own.fmu", lambda name: not name.endswith(".so"))
    with zipfile.ZipFile(desk / "own.fmu", "a") as archive:
        archive.writestr(f"binaries/{platform}/payload.so", b"not a library")
    (desk / "bad.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    (line,) = refuse("bad.toml")
    assert "own.fmu: cannot be loaded" in line


def test_stop_beyond_the_singularity_is_refused(desk: Path, library: Path) -> None:
    """No single value is out of its bounds: only the unit itself can tell, when it starts."""
    text = f"""
    [time]
    {TIME}
    [components.linkage]
    fmu = "linkage"
    start = {{ stop_travel = "9 mm" }}
    [hold]
    "linkage.force.value" = 0
    "linkage.load.torque" = 0
    """
    (desk / "bad.toml").write_text(text)
    code, lines, error = invoke(library, "bad.toml")
    assert isinstance(error, SystemExit)
    assert code == 2
    (line,) = lines
    assert line.startswith("resilin: ")
    assert "linkage" in line
    assert "stop_travel reaches the linkage's singularity" in line
    assert not (desk / "out.nc").exists()
    assert list(Path(tempfile.gettempdir()).iterdir()) == []


def test_no_place_for_temporary_files_is_told(
    desk: Path, library: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", "/proc")
    code, lines, error = invoke(library, "good.toml")
    assert isinstance(error, SystemExit), f"raw exception {error!r}"
    assert code in {1, 2}
    assert len(lines) == 1
    assert "TMPDIR" in lines[0]


def test_picture_that_cannot_be_drawn_keeps_the_result(desk: Path, library: Path) -> None:
    (desk / "out.png").mkdir()
    code, lines, error = invoke(library, "good.toml", "--picture")
    assert isinstance(error, SystemExit), f"raw exception {error!r}"
    assert code in {1, 2}
    assert len(lines) == 1
    assert "out.png" in lines[0]
    assert (desk / "out.nc").exists()


@pytest.mark.parametrize("name", ["out[/red].nc", "[bold]out.nc", "out\nline.nc"])
def test_name_of_the_result_is_shown_as_it_is(name: str, desk: Path, library: Path) -> None:
    options = ["--fmus", str(library), "--no-picture", "--output", f"./{name}"]
    (desk / name).parent.mkdir(exist_ok=True)
    result = CliRunner().invoke(cli.app, ["run", "good.toml", *options])
    assert result.exception is None
    assert result.exit_code == 0
    assert name.replace("\n", "\\x0a") in result.stdout


@pytest.mark.parametrize("error", [RuntimeError("NetCDF: HDF error"), OSError(28, "No space left")])
def test_result_that_cannot_be_written_is_told(
    error: Exception, refuse: Refuse, monkeypatch: pytest.MonkeyPatch
) -> None:
    """netCDF4 reports a full disk as a RuntimeError."""

    def full(*arguments: object, **options: object) -> None:
        raise error

    monkeypatch.setattr(netcdf, "assemble", full)
    (line,) = refuse("good.toml")
    assert "out.nc: cannot be written" in line


@pytest.mark.parametrize(
    "name", ["lift/drag", "n" * 400, "翼" * 200, " lift ", "1 lift", "der(x)[1]", "'a.b'"]
)
def test_name_that_is_none_for_netcdf_is_kept(name: str, desk: Path, library: Path) -> None:
    def text(entry: str) -> bytes:
        data = old.read(entry)
        if entry == "modelDescription.xml":
            data = data.replace(b'"kinetic_energy"', f'"{name}"'.encode())
        return data

    with (
        zipfile.ZipFile(library / "payload.fmu") as old,
        zipfile.ZipFile(desk / "own.fmu", "w") as new,
    ):
        for entry in old.namelist():
            new.writestr(entry, text(entry))
    (desk / "own.toml").write_text(changed(PART, 'fmu = "own.fmu"'))
    code, lines, _ = invoke(library, "own.toml")
    assert (code, lines) == (0, [])
    with xarray.open_dataset("out.nc") as data:
        known = {*data.data_vars, *(str(a) for v in data.values() for a in v.attrs.values())}
    assert f"payload.{name}" in known


def test_output_that_cannot_be_printed_raises_nothing(desk: Path, library: Path) -> None:
    arguments = [*COMMAND, "good.toml", "--fmus", str(library), "--no-picture"]
    ascii_only = {**os.environ, "PYTHONIOENCODING": "ascii"}
    poor = subprocess.run(
        [*arguments, "--output", "ü翼.nc"], env=ascii_only, capture_output=True, timeout=30
    )
    assert (poor.returncode, poor.stderr) == (0, b"")
    with Path("/dev/full").open("w") as full:
        stuck = subprocess.run(arguments, stdout=full, stderr=subprocess.PIPE, timeout=30)
    assert stuck.returncode == 1
    assert stuck.stderr.startswith(b"resilin: ")
    assert b"Traceback" not in stuck.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_signal_that_is_ignored_stays_ignored(
    number: signal.Signals,
) -> None:
    """As under nohup, or in the background of a shell script."""
    before = signal.signal(number, signal.SIG_IGN)
    try:
        with Interrupt():
            assert signal.getsignal(number) is signal.SIG_IGN
        assert signal.getsignal(number) is signal.SIG_IGN
    finally:
        signal.signal(number, before)


def started(desk: Path, library: Path) -> subprocess.Popen[str]:
    """A long run as a process of its own, begun so far that its units are unpacked."""
    text = changed('"0.01 s"', '"100000 s"').replace("0.1 N", "1e-9 N")
    (desk / "long.toml").write_text(text)
    temporary = Path(tempfile.gettempdir())
    options = ["--fmus", str(library), "--output", "out.nc"]
    process = subprocess.Popen(
        [*COMMAND, "long.toml", *options],
        env={**os.environ, "TMPDIR": str(temporary)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not any(temporary.iterdir()) and process.poll() is None:
        try:
            process.wait(0.02)
        except subprocess.TimeoutExpired:
            continue
    return process


@pytest.mark.parametrize("name", ["a b", "jürgen", "o'neill", "50%", "a%20b", "a#b", "a?b", "翼"])
def test_any_folder_for_temporary_files_will_do_or_is_refused(
    name: str, desk: Path, library: Path
) -> None:
    """In a process of its own: an FMU that misreads its folder may take the process down."""
    temporary = desk.parent / name
    temporary.mkdir()
    process = subprocess.run(
        [*COMMAND, "good.toml", "--fmus", str(library), "--no-picture", "--output", "out.nc"],
        env={**os.environ, "TMPDIR": str(temporary)},
        capture_output=True,
        text=True,
        timeout=30,
    )
    refused = process.returncode == 2 and "TMPDIR" in process.stderr
    assert refused or process.returncode == 0, process.stderr
    assert list(temporary.iterdir()) == []


@pytest.mark.timeout(60)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signal_stops_a_run_and_keeps_its_rows(
    number: signal.Signals, desk: Path, library: Path
) -> None:
    process = started(desk, library)
    process.send_signal(number)
    _, stderr = process.communicate(timeout=30)
    assert list(Path(tempfile.gettempdir()).iterdir()) == []
    assert process.returncode == 128 + number
    (line,) = stderr.splitlines()
    assert line.startswith(f"resilin: stopped by {number.name}; ")
    assert line.endswith("rows are kept in out.partial.nc")
    assert sorted(p.name for p in desk.glob("*out*")) == ["out.partial.nc"]
    with xarray.open_dataset("out.partial.nc") as data:
        assert data.attrs["complete"] == 0
        assert number.name in data.attrs["reason"]
        assert data.sizes["time"] >= 1
        assert bool((data["payload.velocity"].diff("time") > 0.0).all())


def test_second_interrupt_has_the_same_exit_code(
    desk: Path, library: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The second Ctrl-C acts at once, wherever the run is."""

    def interrupted(*arguments: object, **options: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("orchestrator.simulation.run.run", interrupted)
    options = ["--fmus", str(library), "--output", "out.nc"]
    monkeypatch.setattr(sys, "argv", ["resilin", "run", "good.toml", *options])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    assert caught.value.code == 130
    assert "Traceback" not in capsys.readouterr().err
