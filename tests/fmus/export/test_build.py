"""The builder: variants, refusals, nothing half made."""

from __future__ import annotations

from pathlib import Path

import pytest

import build_fmus
from orchestrator.fmi.description import read_interface


def test_a_variant_carries_its_start_values(tmp_path: Path) -> None:
    built = build_fmus.build(
        "linkage",
        alias="linkage_tight",
        changes={"stop_travel": "1.9 mm"},
        into=tmp_path,
    )
    interface = read_interface(built.path)
    assert interface.model == interface.identifier == "linkage_tight"
    assert interface.variables["stop_travel"].start == pytest.approx(1.9e-3)
    plain = build_fmus.build("linkage", into=tmp_path)
    assert plain.guid != built.guid


@pytest.mark.parametrize(
    ("part", "changes", "message"),
    [
        ("linkge", {}, "did you mean 'linkage'"),
        ("linkage", {"stop_travl": "1 mm"}, "did you mean 'stop_travel'"),
        ("linkage", {"stop_travel": "1 kg"}, "expected a quantity in m"),
        ("linkage", {"stop_travel": "-1 mm"}, "outside"),
        ("amplifier", {"waveform": "sqare"}, "did you mean 'square'"),
    ],
)
def test_wrong_names_and_values(
    tmp_path: Path, part: str, changes: dict[str, str], message: str
) -> None:
    with pytest.raises(build_fmus.BuildError, match=message):
        build_fmus.build(part, alias="variant", changes=changes, into=tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_name_that_is_no_identifier(tmp_path: Path) -> None:
    with pytest.raises(build_fmus.BuildError, match="cannot name an FMU"):
        build_fmus.build("payload", alias="../payload", into=tmp_path)


FILM = """
[thin]
inner_radius = 2e-3
outer_radius = 10e-3
thickness = 20e-6
prestretch = 1.0
moduli = [1e5]
exponents = [2.0]
permittivity = 3.0
voltage = 600.0
lowest = 0.4
highest = 1.0
"""


def test_a_film_of_ones_own(tmp_path: Path) -> None:
    """Another geometry and material: its table is made at build and shipped in the FMU."""
    films = tmp_path / "films.toml"
    films.write_text(FILM)
    built = build_fmus.build("membrane", alias="membrane_thin", data=films, into=tmp_path)
    assert read_interface(built.path).variables["film"].choices == ("thin",)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("moduli = [1e5]", "", "moduli is missing"),
        ("inner_radius = 2e-3", "inner_radius = 20e-3", "inner_radius < outer_radius"),
        ("lowest = 0.4", "lowest = 1.4", "lowest < highest"),
        ("voltage = 600.0", "voltage = 6000.0", "no taut equilibrium"),
        ("thickness = 20e-6", "thickness = 0.0", "above zero"),
        ("thickness = 20e-6", "thickness = 20e-6\npermittivity_fal = 0.2", "permittivity_fall"),
        ("thickness = 20e-6", "thickness = 20e-6\npermittivity_fall = 1.2", "below 1"),
        ("[thin]", "[thin", "Expected"),
    ],
)
def test_a_film_that_cannot_be(tmp_path: Path, old: str, new: str, message: str) -> None:
    films = tmp_path / "films.toml"
    films.write_text(FILM.replace(old, new))
    with pytest.raises(build_fmus.BuildError, match=message):
        build_fmus.build("membrane", alias="membrane_bad", data=films, into=tmp_path)
    assert not list(tmp_path.glob("*.fmu"))


def test_a_part_without_data_takes_none(tmp_path: Path) -> None:
    with pytest.raises(build_fmus.BuildError, match="no data file"):
        build_fmus.build("payload", alias="other", data=tmp_path / "films.toml", into=tmp_path)
