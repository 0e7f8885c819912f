"""What the pages show: every marked block runs, and the table of commands is the present one."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
QUICK = {"README.md"}
"""Pages that every run of the tests carries out, and whose output is the same on every machine.

The others take half a minute each.
"""


def loaded() -> Any:
    """The script that refreshes the pages."""
    spec = importlib.util.spec_from_file_location("docs_refresh", ROOT / "docs" / "refresh.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


REFRESH = loaded()
RUN = [path for path in REFRESH.pages() if any(REFRESH.blocks(path.read_text(encoding="utf-8")))]


@pytest.mark.timeout(1800)
@pytest.mark.parametrize(
    "page",
    [
        pytest.param(path, id=path.name, marks=[] if path.name in QUICK else [pytest.mark.slow])
        for path in RUN
    ],
)
def test_every_command_of_a_page_works(page: Path, library: Path, tmp_path: Path) -> None:
    """Each block leaves with the stated exit code, and prints where the page shows output."""
    text = page.read_text(encoding="utf-8")
    REFRESH.prepare(tmp_path, library)
    refreshed = REFRESH.refreshed(text, tmp_path)
    shown = [block for block in REFRESH.blocks(refreshed) if block.mark == "output"]
    assert shown
    assert all(block.text.strip() for block in shown)
    if page.name in QUICK:
        assert refreshed == text


def test_the_pages_with_commands_are_found() -> None:
    assert {path.name for path in RUN} > QUICK


def test_the_reference_of_the_command_line_is_up_to_date() -> None:
    page = (ROOT / "docs" / "reference" / "cli.md").read_text(encoding="utf-8")
    (table,) = REFRESH.COMMANDS.findall(page)
    assert table.strip() == REFRESH.commands().strip(), "run python docs/refresh.py"


@pytest.mark.parametrize(
    ("page", "complaint"),
    [
        ("<!-- run -->\n```sh\nexit 3\n```\n", "exit code 3 in the place of 0"),
        ("<!-- run: exit code 2 -->\n```sh\ntrue\n```\n", "exit code 0 in the place of 2"),
        ("<!-- output -->\n```text\n```\n", "before anything has run"),
        ("<!-- run -->\n```toml\na = 1\n```\n", "cannot be run"),
    ],
)
def test_a_page_that_does_not_hold_is_refused(page: str, complaint: str, tmp_path: Path) -> None:
    with pytest.raises(REFRESH.PageError, match=complaint):
        REFRESH.refreshed(page, tmp_path)


def test_output_replaces_what_stood_there(tmp_path: Path) -> None:
    page = (
        "<!-- file: a.txt -->\n```text\nfrom a file\n```\n"
        "<!-- run -->\n```sh\ncat a.txt\n```\n"
        "<!-- output -->\n```text\nold\n```\nend\n"
    )
    assert REFRESH.refreshed(page, tmp_path) == page.replace("old", "from a file")
