"""The example of docs/observers.md, as it stands there."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

from tests.conftest import Runner

PAGE = Path(__file__).resolve().parents[2] / "docs" / "observers.md"


def test_the_observer_of_the_page_runs(
    library: Path, outcome: Runner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = re.search(
        r"^    from resilin import Observer.*\n(?:\n|    .*\n)+", PAGE.read_text(), re.M
    )
    assert found is not None
    code = "\n".join(line[4:] for line in found[0].splitlines())
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "fmus").symlink_to(library)
    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, str(PAGE), "exec"), {})
    value, unit = printed.getvalue().split()
    whole = outcome("flapping-full-wings")
    assert float(value) == abs(whole.series("linkage.flap_angle")).max()
    assert unit == "rad"
