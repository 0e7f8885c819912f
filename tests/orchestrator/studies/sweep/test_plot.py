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
from tests.orchestrator.studies.sweep.flat import FREQUENCY, MASS, WAVEFORM, flat
from tests.orchestrator.studies.sweep.grids import Metrics, grid, made


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


def test_sweeps_over_one_axis_are_lines_over_each_other(panels: list[Any]) -> None:
    """Each at its own points, and in the first one's units."""
    plot.overlay(
        {
            "a": flat({FREQUENCY: [48.0, 50.0]}, lambda f: 1e-3 * f),
            "b": flat({FREQUENCY: [50.0, 51.0, 52.0]}, lambda f: f + 1.0, unit="mm"),
        },
        Path("a.png"),
    )
    one, other = panels[0].lines
    np.testing.assert_allclose(one.get_xydata(), [[48.0, 48.0], [50.0, 50.0]])
    np.testing.assert_allclose(other.get_xydata(), [[50.0, 51.0], [51.0, 52.0], [52.0, 53.0]])
    assert [line.get_label() for line in (one, other)] == ["a", "b"]
    assert one.get_color() != other.get_color()


def test_texts_of_two_sweeps_share_a_colour(panels: list[Any]) -> None:
    axes = {FREQUENCY: [48.0, 50.0], WAVEFORM: ["sine", "square"]}
    turned = axes | {WAVEFORM: ["square", "sine"]}
    sweeps = {name: flat(a, lambda f, w: f + len(w)) for name, a in (("a", axes), ("b", turned))}
    plot.overlay(sweeps, Path("a.png"))
    lines = {line.get_label(): line for line in panels[0].lines}
    assert set(lines) == {"sine, a", "square, a", "sine, b", "square, b"}
    assert lines["sine, a"].get_color() == lines["sine, b"].get_color()
    assert lines["sine, a"].get_linestyle() != lines["sine, b"].get_linestyle()


def test_of_two_heat_maps_the_difference_is_drawn(panels: list[Any]) -> None:
    axes = {FREQUENCY: [48.0, 50.0], MASS: [1.0, 2.0]}
    a, b = flat(axes, lambda f, m: 1e-3 * f), flat(axes, lambda f, m: 1e-3 * (f + m))
    plot.overlay({"a": a, "b": b}, Path("a.png"))
    (mesh,) = (c for c in panels[0].collections if isinstance(c, QuadMesh))
    np.testing.assert_allclose(mesh.get_array(), [[1.0, 1.0], [2.0, 2.0]])
    assert panels[0].figure.get_suptitle() == "b minus a"
    with pytest.raises(InputError, match=r"3 sweeps over two axes: .*give two"):
        plot.overlay({"a": a, "b": b, "c": a}, Path("a.png"))
    with pytest.raises(InputError, match="same axes"):
        plot.overlay({"a": a, "b": flat({MASS: [1.0, 2.0]}, lambda m: m)}, Path("a.png"))


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
