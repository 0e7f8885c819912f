"""Bad settings of steps, isolation, actions, masters, records and holds: one line each."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.foreign.build import foreign
from tests.orchestrator.good_scenario import (
    ACTING,
    AT,
    HOLD,
    PART,
    SCENARIO,
    SET,
    STEP,
    TWO,
    TYPED,
    Refuse,
    acting,
    changed,
    invoke,
    label,
    mastered,
)


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
        ('"slow"', "1", ["types.in_enumeration: 1.0 is not a choice; there are fast, slow"]),
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
