"""Bad options of the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.orchestrator.good_scenario import MASS, Refuse, changed, invoke, label


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
