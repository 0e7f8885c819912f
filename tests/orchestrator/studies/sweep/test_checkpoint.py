"""Points of a sweep on disk: reused, damaged, in use."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from orchestrator.errors import OutputError
from orchestrator.studies.sweep.checkpoint import Checkpoint
from orchestrator.studies.sweep.points import Record, Setting, planned
from orchestrator.studies.sweep.study import parse_axis
from tests.orchestrator.studies.sweeps import SCENARIO, Sweep, files, ok


def test_points_are_reused_where_nothing_has_changed(swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    swept("amplifier.frequency=17:18/2Hz", target=target, keep=True)
    first = files(target)
    swept("amplifier.frequency=17,18,19Hz", target=target, keep=True)
    second = files(target)
    assert len(second) == 3 and first.items() <= second.items()
    damaged = Checkpoint(target).path / sorted(first)[0]
    damaged.write_text(damaged.read_text().replace("1", "2", 1))
    swept("amplifier.frequency=17,18Hz", target=target, keep=True)
    changed = {name for name, written in files(target).items() if second[name] != written}
    assert changed == {damaged.name}
    other = {"time": {"stop": "3 cycles"}}
    data = swept("amplifier.frequency=17,18Hz", target=target, options=other)
    assert (data["steps"].values == 150).all()
    assert not files(target)


def test_a_folder_is_for_one_sweep_at_a_time(swept: Sweep, tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    with (
        Checkpoint(target),
        pytest.raises(OutputError, match="in use by another sweep"),
    ):
        swept("amplifier.frequency=17,18Hz", target=target)
    assert not list(tmp_path.iterdir())


def test_a_record_survives_its_file(tmp_path: Path, library: Path) -> None:
    """Infinite numbers included; a file that is not whole counts as missing."""
    axes = [parse_axis("amplifier.frequency=17Hz")]
    point = planned(Setting(SCENARIO, str(library), {}, {}), axes, ok).points[0]
    record = Record("done", "", (("a", math.inf, "m"), ("b", 0.1, "N")), 1.5, 7)
    with Checkpoint(tmp_path / "out.nc") as folder:
        folder.write(point, record)
        read = folder.read(point)
        assert read is not None and math.isnan(read.metrics[0][1])
        assert read.metrics[1] == ("b", 0.1, "N") and read.steps == 7
        path = folder.path / f"{point.key}.json"
        content = json.loads(path.read_text())
        for text in ("", "[]", "{}", json.dumps(content | {"sha256": "0"})):
            path.write_text(text)
            assert folder.read(point) is None
