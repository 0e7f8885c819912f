"""The builder: variants, refusals, nothing half made."""

from __future__ import annotations

from pathlib import Path

import pytest

import build_fmus
from orchestrator.interface import read_interface


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
