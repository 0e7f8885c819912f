"""The examples: each runs as it stands in an empty folder, and prints figures that are right."""

from __future__ import annotations

import ast
import os
import re
import subprocess
from math import pi, sqrt
from pathlib import Path

import pytest

from tests.processes import python

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
NUMBER = r"(-?\d+(?:\.\d+)?(?:e[-+]\d+)?)"
LONG = {"sweep_with_plot", "fit_a_parameter", "error_against_run_time", "controller_in_the_loop"}
MARKED = [
    pytest.param(path, marks=[pytest.mark.slow] if path.stem in LONG else []) for path in EXAMPLES
]

Figure = tuple[str, float, float]
"""What stands before a number that is printed, and the bounds of that number."""

FIGURES: dict[str, list[Figure]] = {
    "controller_in_the_loop": [
        (f"{grams} g: ", 0.95 * natural, natural)
        for grams in (0.4, 0.6, 0.8)
        for natural in [sqrt(63.5 / (1e-3 * grams)) / (2.0 * pi)]
    ],
    "error_against_run_time": [
        ("gauss-seidel, curvature +120 per cycle +error ", 0.0, 1e-5),
        ("gauss-seidel, curvature +120 per cycle .* order +", 1.5, 4.0),
        ("gauss-seidel, held +120 per cycle +error ", 1e-2, 1.0),
        ("gauss-seidel, held +120 per cycle .* order +", 0.8, 1.4),
    ],
    "fit_a_parameter": [
        ("spring.stiffness: ", 69.0, 71.0),
        ("spring.loss_factor: ", 0.245, 0.255),
        ("payload.mass: ", 0.64e-3, 0.66e-3),
    ],
    "linearise_with_control": [
        ("pole: ", 51.0, 52.3),
        ("damping ratio ", 0.13, 0.15),
        ("at rest ", 1.0, 1.2),
        ("overshoot ", 60.0, 68.0),
    ],
    "measured_voltage": [
        ("measured voltage: travel ", 13.9, 14.1),
        ("ideal voltage: travel ", 13.9, 14.1),
    ],
    "run_and_plot": [
        ("stroke: ", 45.0, 75.0),
        ("deg, \\+- ", 1e-6, 0.5),
        ("mean lift: ", 30.0, 200.0),
    ],
    "stream_values": [
        ("t = 0.154 s: up to ", 6.9e-3, 7.2e-3),
    ],
    "swap_film_for_spring": [
        ("film *: travel ", 13.0, 14.5),
        ("spring *: travel ", 10.5, 11.5),
    ],
    "sweep_with_plot": [
        ("0.5 g: .* at ", 51.0, 57.0),
        ("0.7 g: .* at ", 45.0, 51.0),
    ],
    "two_foreign_fmus": [
        ("gauss-seidel +step 0.02 s: largest error ", 0.03, 0.06),
        ("extrapolated +step 0.02 s: largest error ", 5e-4, 2e-3),
        ("extrapolated +step 0.04 s: largest error ", 2e-3, 8e-3),
    ],
}
"""Figures of each example; bounds follow from closed forms, known values, or the scenario's own."""


def named(paths: list[Path]) -> list[str]:
    return [path.stem for path in paths]


@pytest.mark.parametrize("example", MARKED, ids=named(EXAMPLES))
def test_an_example_runs_and_its_figures_are_right(
    example: Path, python_parts: Path, native: Path, tmp_path: Path
) -> None:
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "fmus").symlink_to(python_parts)
    (tmp_path / "build" / "native").symlink_to(native)
    done = subprocess.run(
        python("-W", "error", example),
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    for before, least, most in FIGURES[example.stem]:
        found = re.search(before + NUMBER, done.stdout)
        assert found is not None, f"no {before!r} in:\n{done.stdout}"
        assert least <= float(found[1]) <= most, found[0]
    for name in re.findall(r"results/\w+\.\w+", example.read_text()):
        assert (tmp_path / name).stat().st_size > 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["build", "results"]


@pytest.mark.parametrize("example", EXAMPLES, ids=named(EXAMPLES))
def test_an_example_is_short_and_tells_what_one_learns(example: Path) -> None:
    text = example.read_text()
    assert len(text.splitlines()) <= 60
    tree = ast.parse(text)
    assert "You learn:" in (ast.get_docstring(tree) or "")
    modules = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    modules |= {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
    ours = {str(m).split(".")[0] for m in modules} & {"fmus", "tests", "build_fmus", "benchmarks"}
    assert not ours, "an example uses the public packages alone"


def test_the_table_has_every_example() -> None:
    table = re.findall(r"^\| \[(\w+)\.py\]\((\w+)\.py\)", readme(), re.MULTILINE)
    assert [shown for shown, _ in table] == [linked for _, linked in table]
    assert sorted(shown for shown, _ in table) == named(EXAMPLES) == sorted(FIGURES)
    assert len(EXAMPLES) >= 8


def readme() -> str:
    return (ROOT / "examples" / "README.md").read_text()
