"""A page: title, facts and sections, rendered by escaping templates into one file.

Texts come from scenarios, FMUs and foreign files: jinja2 escapes all of them, data stand in
`<script type="application/json">` without any `<`, and the Content-Security-Policy allows
the page's own style and script, by their digests, and no access to the network.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from .animation import Animation
from .files import check_place, written_whole
from .picture import Picture
from .plot import Figure
from .table import Table

if TYPE_CHECKING:
    from jinja2 import Environment

TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class Words:
    """Paragraphs."""

    kind: ClassVar[str] = "words"
    paragraphs: Sequence[str]


@dataclass(frozen=True)
class Notes:
    """A list of remarks."""

    kind: ClassVar[str] = "notes"
    items: Sequence[str]


@dataclass(frozen=True)
class Fold:
    """Parts out of sight behind a line that says what they are."""

    kind: ClassVar[str] = "fold"
    line: str
    parts: Sequence[Part]


Part = Words | Notes | Table | Figure | Animation | Picture | Fold


@dataclass(frozen=True)
class Section:
    """The parts under one heading. `key` is its anchor, as in `#figure3`."""

    key: str
    title: str
    parts: Sequence[Part]


@dataclass(frozen=True)
class Page:
    """All that a file shows. `facts` are pairs of a name and a text: versions, parts, times.

    `alarms` stand above all: what forbids to use the page.
    """

    title: str
    lead: str
    sections: Sequence[Section]
    facts: Sequence[tuple[str, str]] = field(default_factory=tuple)
    alarms: Sequence[str] = ()


def rendered(page: Page) -> str:
    """The page as one HTML text."""
    style, script = _own("page.css"), _own("page.js")
    return environment().get_template("page.html").render(
        page=page, style=style, script=script, style_digest=_digest(style),
        script_digest=_digest(script),
    )  # fmt: skip


def write(page: Page, path: Path) -> Path:
    """Write a page to `path`, whole or not at all."""
    with written_whole(path) as waiting:
        waiting.write_text(rendered(page), encoding="utf-8", errors="backslashreplace")
    return path


def check_page(path: Path) -> None:
    """Check that a page can be written to `path`, before any work is done for it."""
    check_place(path, "pages are HTML files", [".html", ".htm"])


def anchor(text: str) -> str:
    """A text as an anchor: letters, digits and `-`."""
    return re.sub(r"[^A-Za-z0-9]+", "-", text).strip("-").lower() or "part"


def embedded(data: Any) -> str:
    """JSON that can stand in a script element: nothing in it can end that element."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _own(name: str) -> str:
    return (TEMPLATES / name).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


@cache
def environment() -> Environment:
    """Templates of this folder, which escape every text."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    made = Environment(
        loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True,
    )  # fmt: skip
    made.filters["anchor"] = anchor
    made.filters["embedded"] = lambda data: Markup(embedded(data))
    made.filters["own"] = Markup
    return made
