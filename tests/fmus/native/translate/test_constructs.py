"""Every construct of the subset gives in C what it gives in Python: bits, and words of errors."""

from __future__ import annotations

import inspect
import itertools
import math
import subprocess
from pathlib import Path

import pytest

from fmus.native.link import PLATFORMS, compiler, own_platform
from fmus.native.translate import unit
from tests.fmus.native.translate import sample
from tests.fmus.native.translate.harness import Translated, written

FLOATS = [
    0.0, -0.0, 1.0, -1.0, 0.5, 0.7, -0.5, 1.5, -2.5, 3.0, 4.0, 1e-300, -1e-300, 1e300, -1e300,
    5e-324, 700.5, 710.0, -710.0, -745.5, 2.0**52 + 1.0, math.pi, 1e22, math.inf, -math.inf,
    math.nan,
]  # fmt: skip
WHOLES = [-100, -4, -3, -2, -1, 0, 1, 2, 3, 4, 9, 2**40]
FLAGS = [False, True]
FEW = [n for n in WHOLES if n < 20]
TAME = {x for x in FLOATS if x == 0.0 or 1e-18 < math.fabs(x) < 1e18}
TO_INT = {"whole", "converted", "index_order", "words"}
"""Functions with int(), which saturates in C where Python goes on."""

HELPERS = {
    "two",
    "several",
    "taken",
    "passed_row",
    "passed_rows",
    "moved",
    "sized",
    "same",
    "inner",
}
"""Functions that others call, with arguments or results that are no numbers."""

NAMES = [
    name
    for name, found in vars(sample).items()
    if inspect.isfunction(found) and found.__module__ == sample.__name__ and name not in HELPERS
]


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> Translated:
    """The sample, compiled with every warning an error."""
    return Translated(sample, NAMES, tmp_path_factory.mktemp("sample"))


@pytest.mark.parametrize("name", NAMES)
def test_a_construct(both: Translated, name: str) -> None:
    loops = "n" in inspect.signature(getattr(sample, name)).parameters
    values = {float: FLOATS, int: FEW if loops else WHOLES, bool: FLAGS}
    if name in TO_INT:
        values[float] = [x for x in FLOATS if x in TAME or not math.isfinite(x)]
    answers = set()
    for given in itertools.product(*(values[kind] for kind in both.kinds(name))):
        ours, theirs = both.c(name, *given), both.python(name, *given)
        assert ours == theirs, given
        assert both.dual(name, given, [0.0] * len(given))[0] == ours, given
        answers.add(theirs)
    assert len(answers) > 1, "the arguments make no difference"


def test_the_text_is_the_same_again() -> None:
    first, second = (unit.translated(sample, "sample", NAMES, {}) for _ in range(2))
    assert first == second


def test_a_table_stands_once(both: Translated) -> None:
    for name in ("ROW[3]", "ROWS[3][3]", "CUBE[2][3][3]", "SHARED[2][3]"):
        assert both.source.count(f"static const double {name} = ") == 1


def test_docstrings_become_comments(both: Translated) -> None:
    assert "/* A function with defaults; / * and what * / would end a comment. */" in both.source
    assert "/* Its own, though the sample has another one. */" in both.source


def test_names_have_their_module_only_where_they_clash(both: Translated) -> None:
    assert "static inline double scaled(" in both.source
    assert "static inline double sibling_chosen(" in both.source
    assert "static inline double sibling_free(" in both.source
    assert "static const double sibling_SCALE = 3.0;" in both.source


def test_nothing_is_fused_whatever_the_flags(tmp_path: Path) -> None:
    """The sources forbid it themselves: a host compiles them with its own options."""
    written(unit.translated(sample, "sample", NAMES, {}), tmp_path)
    command = [*compiler(PLATFORMS[own_platform()].targets[0], own=True), "-O2", "-mfma"]
    command += ["-S", "sample.c"]
    subprocess.run([*command, "-o", "sample.s"], check=True, cwd=tmp_path)
    assert "mulsd" in (tmp_path / "sample.s").read_text()
    assert "fmadd" not in (tmp_path / "sample.s").read_text()
