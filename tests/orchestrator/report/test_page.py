"""Pages: whole files whose texts stay text and that need no network."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
from pathlib import Path

import lxml.html
import pytest

from orchestrator.errors import OutputError
from orchestrator.report.image import draw
from orchestrator.report.page import (
    Fold,
    Notes,
    Page,
    Section,
    Words,
    anchor,
    check_page,
    embedded,
    rendered,
    write,
)
from orchestrator.report.plot import Axis, Curve, Figure, Plot, short
from orchestrator.report.table import Cell, Column, Table, quantity

HOSTILE = (
    "<script>alert(1)</script>",
    '"><svg onload=alert(2)>',
    "</script><script>alert(3)</script>",
    "<img src=x onerror=alert(4)>",
    "' onmouseover='alert(5)",
    "</style><style>*{display:none}</style>",
    "javascript:alert(6)",
    "{{ 7 * 7 }} {% raw %}",
    "<!--",
    "]]>\u2028\u2029\x00\udc80",
)
NAMESPACE = "http://www.w3.org/2000/svg"


def page(text: str) -> Page:
    """A page with the text in every place that takes one."""
    curve = Curve(text, [1.0, 2.0, 3.0], [1.0, math.nan, math.inf], "line-points")
    plot = Plot(text, Axis(text), Axis(text, log=True), [curve])
    cell = Cell(text, 1.0, "green", note=text)
    return Page(
        text,
        text,
        [
            Section(text, text, [Words([text]), Fold(text, [Notes([text])])]),
            Section("two", text, [Figure(text, text, text, [plot])]),
            Section("three", text, [Table(text, [Column(text, number=True)], [[cell]])]),
        ],
        [(text, text)],
    )


@pytest.mark.parametrize("text", HOSTILE)
def test_no_text_becomes_markup(text: str, tmp_path: Path) -> None:
    """The tree of elements and attributes is that of a page of harmless text."""
    made = write(page(text), tmp_path / "page.html").read_text(encoding="utf-8")
    plain = rendered(page("word"))
    assert shape(made) == shape(plain)
    assert "alert(" not in "".join(
        script.text or "" for script in scripts(made) if script.get("type") is None
    )


def shape(text: str) -> list[tuple[str, tuple[str, ...]]]:
    """Elements in order, with the names of their attributes."""
    root = lxml.html.document_fromstring(text.replace("\x00", "").encode())
    return [(str(e.tag), tuple(sorted(map(str, e.keys())))) for e in root.iter("*")]


def scripts(text: str) -> list[lxml.html.HtmlElement]:
    root = lxml.html.document_fromstring(text.replace("\x00", "").encode())
    return list(root.iter("script"))


def test_the_data_are_kept_as_json() -> None:
    """The page's script reads what the figure holds, gaps as null."""
    made = rendered(page("</script>"))
    (data,) = [s for s in scripts(made) if s.get("type") == "application/json"]
    assert "<" not in (data.text or "")
    (plot,) = json.loads(data.text or "")
    assert plot["title"] == "</script>"
    assert plot["curves"][0]["y"] == [1.0, None, None]


def test_the_policy_allows_the_pages_own_script_and_style_alone() -> None:
    made = rendered(page("word"))
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', made)
    assert policy is not None
    assert "default-src 'none'" in policy[1]
    assert "unsafe" not in policy[1]
    own = re.findall(r"<(?:script|style)>(.*?)</(?:script|style)>", made, flags=re.DOTALL)
    assert len(own) == 2
    for text in own:
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy[1]
    assert not re.search(
        r"\s(?:on\w+|style)=", re.sub(r"<script>.*?</script>", "", made, flags=re.S)
    )


def test_no_address_but_the_namespace() -> None:
    """Nothing in the page names a host, and nothing in it can load."""
    made = rendered(page("word"))
    found = set(re.findall(r"(?:https?:)?//[^\s\"'<>);]+", re.sub(r"/\*.*?\*/", "", made)))
    assert found == {NAMESPACE}
    sources = re.findall(r'(?:src|href|srcset|action)="([^"]*)"', made)
    assert all(source.startswith("#") or source == "data:," for source in sources)
    assert not re.search(r"@import|url\((?!#)", made)


def test_every_anchor_is_there() -> None:
    made = rendered(page("Figure 3: <b>"))
    ids = set(re.findall(r' id="([^"]+)"', made))
    assert {link[1:] for link in re.findall(r'href="(#[^"]*)"', made)} <= ids


def test_embedded_text_cannot_end_its_element() -> None:
    assert embedded(["</script>", "&"]) == '["\\u003c/script\\u003e","\\u0026"]'
    assert json.loads(embedded({"a": "<>&"})) == {"a": "<>&"}


def test_numbers_are_short_and_finite() -> None:
    assert short([1 / 3, math.nan, -math.inf]) == [0.333333, None, None]
    assert quantity(2.0, "2 mm").sort == 2.0
    assert anchor('"><x') == "x"
    assert anchor("<>") == "part"


def test_a_figure_is_a_file_too(tmp_path: Path) -> None:
    """Dollars are text, not formulas; the same figure gives the same file."""
    curve = Curve("$x", [1.0, 2.0], [1.0, 4.0], "line-points")
    plots = [Plot("a", Axis("x"), Axis("y"), [curve]), Plot("b", Axis("x"), Axis("y"), [curve])]
    figure = Figure("f", "cost in $", "", plots)
    paths = [tmp_path / "f.svg", tmp_path / "f.png"]
    draw(figure, paths)
    assert paths[1].read_bytes().startswith(b"\x89PNG")
    first = paths[0].read_text()
    draw(figure, paths)
    assert paths[0].read_text() == first
    assert sorted(p.name for p in tmp_path.iterdir()) == ["f.png", "f.svg"]


def test_a_path_that_cannot_take_a_page_is_refused_first(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"name it \*\.html"):
        check_page(tmp_path / "page.txt")
    (tmp_path / "folder.html").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        check_page(tmp_path / "folder.html")
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be made"):
        check_page(tmp_path / "file" / "page.html")
    with pytest.raises(OutputError, match="cannot be written"):
        write(page("word"), tmp_path / "folder.html")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file", "folder.html"]
