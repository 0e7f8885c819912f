"""A good scenario, what is done to it to make it bad, and the command line that runs it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from typer.testing import CliRunner

from orchestrator import cli

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
