"""Every function of `math` that is allowed answers and raises as CPython's does."""

from __future__ import annotations

import importlib.util
import itertools
import math
import struct
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from fmus.native.translate import subset
from tests.fmus.native.translate.harness import Translated

VALUES = [
    0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 1.5, -2.5, 1e-300, -1e-300, 1e300, -1e300, 5e-324, 710.0,
    -710.0, 745.5, 2.0**52 + 1.0, 1e18, 1e19, -1e19, math.pi, math.inf, -math.inf, math.nan,
]  # fmt: skip
LARGEST = 2.0**62


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Translated]:
    """A function for each of the list of what is allowed, and `int`."""
    folder = tmp_path_factory.mktemp("mathematics")
    lines = ["from __future__ import annotations", "import math"]
    for name, count in subset.ARGUMENTS.items():
        given = ["x", "y"][:count]
        call = f"math.{name}({', '.join(given)})"
        if name in subset.ROUNDING:
            call = f"float({call})"
        parameters = ", ".join(f"{x}: float" for x in given)
        lines += [f"def call_{name}({parameters}) -> float:", f"    return {call}"]
    lines += ["def call_int(x: float) -> int:", "    return int(x)"]
    path = folder / "allowed.py"
    path.write_text("\n".join(lines), encoding="utf-8")
    spec = importlib.util.spec_from_file_location("allowed", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["allowed"] = module
    spec.loader.exec_module(module)
    names = [f"call_{name}" for name in (*subset.ARGUMENTS, "int")]
    yield Translated(module, names, folder)
    del sys.modules["allowed"]


@pytest.mark.parametrize("name", [n for n, count in subset.ARGUMENTS.items() if count == 1])
def test_functions_of_one_argument(both: Translated, name: str) -> None:
    random = np.random.default_rng(5).normal(scale=3.0, size=2000).tolist()
    for value in [*VALUES, *random]:
        ours, theirs = (call(f"call_{name}", value) for call in (both.c, both.python))
        assert ours == theirs, value


@pytest.mark.parametrize("name", subset.ARGUMENTS)
def test_derivatives(both: Translated, name: str) -> None:
    """Slopes on dual numbers against central differences of fourth order."""
    rng = np.random.default_rng(7)
    count = subset.ARGUMENTS[name]
    compared = 0
    for _ in range(200):
        given, seed = rng.uniform(-2.0, 2.0, count), rng.uniform(-1.0, 1.0, count)
        value, slope = both.dual(f"call_{name}", given.tolist(), seed.tolist())
        ours = [both.c(f"call_{name}", *(given + k * 1e-3 * seed)) for k in (-2, -1, 0, 1, 2)]
        assert value == ours[2]
        if not all(isinstance(each, bytes) for each in ours):
            continue
        at = [struct.unpack("<d", each)[0] for each in ours if isinstance(each, bytes)]
        expected = (8.0 * (at[3] - at[1]) - (at[4] - at[0])) / 12e-3
        rough = (at[3] - at[1]) / 2e-3
        if math.fabs(expected - rough) < 1e-5 * (1.0 + math.fabs(rough)):
            assert slope == pytest.approx(expected, rel=1e-6, abs=1e-7), given
            compared += 1
    assert compared > 20


@pytest.mark.parametrize("name", [n for n, count in subset.ARGUMENTS.items() if count == 2])
def test_functions_of_two_arguments(both: Translated, name: str) -> None:
    for x, y in itertools.product(VALUES, VALUES):
        ours, theirs = (call(f"call_{name}", x, y) for call in (both.c, both.python))
        assert ours == theirs, (x, y)


def test_whole_numbers_saturate(both: Translated) -> None:
    for value in VALUES:
        if math.fabs(value) < LARGEST or not math.isfinite(value):
            assert both.c("call_int", value) == both.python("call_int", value), value
    assert both.c("call_int", 1e19) == both.python("call_int", LARGEST)
    assert both.c("call_int", -1e19) == both.python("call_int", -LARGEST)
