"""A plot of a sweep: lines over one axis, heat maps over two."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import QuadMesh

from orchestrator.errors import InputError
from orchestrator.studies.sweep import plot
from orchestrator.studies.sweep.points import Point
from tests.orchestrator.studies.sweep.grids import Metrics, grid, made

FREQUENCY, MASS, WAVEFORM = "amplifier.frequency", "payload.mass", "amplifier.waveform"


def metrics(point: Point) -> Metrics:
    """One that varies with every axis, and a constant."""
    place = sum(len(each) if isinstance(each, str) else each for each in point.place)
    return (("travel", 1e-3 * place, "m"), ("frequency", 50.0, "Hz"))


@pytest.fixture
def panels(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The axes of the figure that was saved."""
    saved: list[Any] = []

    def keep(figure: Any, path: Path, *_: Any) -> Path:
        figure.canvas.draw()
        saved.extend(figure.axes)
        return path

    monkeypatch.setattr(plot, "save_figure", keep)
    return saved


def test_one_axis_is_a_line(panels: list[Any], library: Path) -> None:
    data = made(grid(library, f"{FREQUENCY}=48,50,54Hz", f"{MASS}=1g"), metrics)
    plot.draw(data, Path("a.png"))
    (panel,) = panels
    (line,) = panel.lines
    np.testing.assert_allclose(line.get_xdata(), [48.0, 50.0, 54.0])
    np.testing.assert_allclose(line.get_ydata(), [48.001, 50.001, 54.001])
    assert panel.get_xlabel() == f"{FREQUENCY} (Hz)"
    assert panel.get_ylabel() == "travel (mm)"


def test_two_axes_are_a_heat_map(panels: list[Any], library: Path) -> None:
    data = made(grid(library, f"{FREQUENCY}=48,50,54Hz", f"{MASS}=1,2g"), metrics)
    plot.draw(data, Path("a.png"))
    (mesh,) = (c for c in panels[0].collections if isinstance(c, QuadMesh))
    np.testing.assert_allclose(
        mesh.get_array(), [[48.001, 50.001, 54.001], [48.002, 50.002, 54.002]]
    )
    assert panels[0].get_ylabel() == f"{MASS} (kg)"
    assert panels[1].get_ylabel() == "travel (mm)"


def test_texts_are_lines_of_their_own(panels: list[Any], library: Path) -> None:
    data = made(grid(library, f"{WAVEFORM}=square,sine", f"{FREQUENCY}=48,50Hz"), metrics)
    plot.draw(data, Path("a.png"))
    assert {line.get_label(): list(line.get_ydata()) for line in panels[0].lines} == {
        "square": pytest.approx([54.0, 56.0]),
        "sine": pytest.approx([52.0, 54.0]),
    }


def test_two_axes_of_texts_are_a_heat_map(panels: list[Any], library: Path) -> None:
    axes = (f"{WAVEFORM}=square,sine", "amplifier.amplitude=1kV,2kV")
    data = made(grid(library, *axes), metrics).assign_coords(
        {"amplifier.amplitude": ["low", "high"]}
    )
    plot.draw(data, Path("a.png"), ["trav*"])
    assert [text.get_text() for text in panels[0].get_yticklabels()] == ["low", "high"]


def test_a_refined_peak_is_marked(panels: list[Any], library: Path) -> None:
    data = made(grid(library, f"{FREQUENCY}=48,50,54Hz"), metrics)
    data.attrs |= {"refined": "travel", "peak": 0.05, "peak_at": 50.5}
    data.attrs |= {"peak_uncertainty": 1e-4, "peak_at_uncertainty": 0.1}
    plot.draw(data, Path("a.png"))
    assert panels[0].lines[1].get_xydata().tolist() == [[50.5, 50.0]]


@pytest.mark.parametrize(
    ("axes", "patterns", "reason"),
    [
        ((f"{FREQUENCY}=48,50Hz", f"{MASS}=1,2g", f"{WAVEFORM}=sine,square"), None, "one or two"),
        ((f"{FREQUENCY}=48Hz",), None, "one or two axes"),
        ((f"{FREQUENCY}=48,50Hz",), ["travle"], "did you mean 'travel'"),
    ],
)
def test_what_cannot_be_drawn_is_refused(
    axes: tuple[str, ...], patterns: list[str] | None, reason: str, library: Path, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=reason):
        plot.draw(made(grid(library, *axes), metrics), tmp_path / "a.png", patterns)
    assert list(tmp_path.iterdir()) == []
