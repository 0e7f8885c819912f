"""Bad scenarios: one line for each problem, which names the file, the key and the way out."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.orchestrator.good_scenario import (
    HOLD,
    MASS,
    PART,
    SCENARIO,
    STEP,
    TIME,
    Refuse,
    changed,
    invoke,
    label,
)


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


def test_all_problems_come_at_once(refuse: Refuse, desk: Path) -> None:
    text = changed(MASS, "mas = 1").replace("1e-3 s", "0 s").replace("force.value", "force.val")
    (desk / "bad.toml").write_text(text)
    keys = [line.split(": ")[2] for line in refuse("bad.toml")]
    assert {"components.payload.start.mas", "hold.payload.force.val", "time.step"} <= set(keys)


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
