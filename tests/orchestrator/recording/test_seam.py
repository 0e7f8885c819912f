"""A recording of one cycle that is repeated: does its last row repeat the first?"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orchestrator.recording.recording import Recording, open_recording
from orchestrator.recording.settings import RecordingSettings

TURN = 2.0 * np.pi


def repeated(folder: Path, values: np.ndarray, repeat: bool | str = True) -> Recording:
    times = 0.01 * np.arange(len(values))
    rows = "".join(f"{t!r},{y!r}\n" for t, y in zip(times.tolist(), values.tolist(), strict=True))
    (folder / "cycle.csv").write_text(f"time [s],u\n{rows}")
    settings = RecordingSettings(data="cycle.csv", repeat=repeat)
    return open_recording(settings, folder / "scenario.toml")


@pytest.mark.parametrize("count", [20, 50, 400])
@pytest.mark.parametrize("phase", [0.0, 0.25, 0.4, 0.5])
def test_an_open_cycle_is_told_with_its_period(tmp_path: Path, count: int, phase: float) -> None:
    wave = np.sin(TURN * (np.arange(count) / count + phase))
    (warning,) = repeated(tmp_path, wave).interface.warnings
    assert f'repeat = "{0.01 * count:.9g} s"' in warning
    assert repeated(tmp_path, wave, f"{0.01 * count} s").interface.warnings == ()


@pytest.mark.parametrize(
    "values",
    [
        np.sin(TURN * (np.arange(51) / 50 + 0.1)),
        np.arange(50.0),
        np.where(np.arange(50) < 25, 0.0, 1.0),
        np.zeros(20),
        np.cumsum(np.random.default_rng(1).standard_normal(50)),
    ],
    ids=["closed", "sawtooth", "square", "still", "drifting"],
)
def test_closed_cycles_and_discontinuities_are_not_told(tmp_path: Path, values: np.ndarray) -> None:
    assert repeated(tmp_path, values).interface.warnings == ()
