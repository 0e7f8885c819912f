"""The pages: every link has its file and its heading, every page its place in the site."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(
    [
        *ROOT.glob("*.md"),
        *DOCS.rglob("*.md"),
        *ROOT.glob("fmus/**/README.md"),
        *ROOT.glob("examples/**/*.md"),
    ]
)
FENCE = re.compile(r"^```.*?^```$", re.M | re.S)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.+?) *$", re.M)
MENTION = re.compile(r"\bdocs/[\w/-]+\.(?:md|py|txt)\b")
IDENTIFIER = re.compile(r"^::: ([\w.]+)$", re.M)
SOURCES = sorted(
    path
    for pattern in ("*.py", "*.toml", "*.md", "*.yml")
    for folder in ("fmus", "orchestrator", "scenarios", "benchmarks", "tests", "docs")
    for path in (ROOT / folder).rglob(pattern)
)


@cache
def prose(path: Path) -> str:
    """A page without its code blocks, in which nothing is a link or a heading."""
    return FENCE.sub("", path.read_text(encoding="utf-8"))


@cache
def anchors(path: Path) -> set[str]:
    """Names of the headings, as the site and the forges make them."""
    found = set()
    for heading in HEADING.findall(prose(path)):
        text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        words = re.sub(r"[^\w\s-]", "", text).strip().lower()
        found.add(re.sub(r"[-\s]+", "-", words))
    return found


def listed(entries: Any) -> Iterator[str]:
    """Pages of a navigation in the order in which it shows them."""
    if isinstance(entries, str):
        yield entries
    else:
        for entry in entries.values() if isinstance(entries, dict) else entries:
            yield from listed(entry)


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_link_leads_somewhere(page: Path) -> None:
    dead = []
    for target in LINK.findall(prose(page)):
        if "://" in target or target.startswith("mailto:"):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists() or not file.is_relative_to(ROOT):
            dead.append(f"{target}: no such file")
        elif anchor and file.suffix == ".md" and anchor not in anchors(file):
            dead.append(f"{target}: no such heading; there is {', '.join(sorted(anchors(file)))}")
    assert dead == []


def test_there_are_links_to_check() -> None:
    """A pattern that finds nothing would make the test above pass for ever."""
    assert sum(len(LINK.findall(prose(page))) for page in PAGES) > 100


def test_every_page_has_its_place_in_the_site() -> None:
    settings = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))

    pages = list(listed(settings["nav"]))
    assert len(pages) == len(set(pages))
    elsewhere = {"index.md", "contributing.md", "changelog.md", "examples.md", "parts/index.md"}
    parts = {f"parts/{path.parent.name}.md" for path in ROOT.glob("fmus/*/README.md")}
    written = {path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md")}
    assert set(pages) == elsewhere | parts | written


def test_sources_that_name_a_page_name_one_that_is_there() -> None:
    named = {
        (mention, source)
        for source in SOURCES
        if "recipes" not in source.parts
        for mention in MENTION.findall(source.read_text(encoding="utf-8"))
    }
    assert named
    missing = [f"{source}: {mention}" for mention, source in named if not (ROOT / mention).exists()]
    assert missing == []


@pytest.mark.parametrize(
    "page", sorted((DOCS / "reference" / "api").glob("*.md")), ids=lambda path: str(path.name)
)
def test_the_api_pages_name_what_there_is(page: Path) -> None:
    """Read from the source, since the site is built from it too: nothing is imported."""
    named = IDENTIFIER.findall(page.read_text(encoding="utf-8"))
    assert named
    for identifier in named:
        parts = identifier.split(".")
        known = next(n for n in range(len(parts), 0, -1) if module(parts[:n]))
        file = module(parts[:known])
        assert file is not None, identifier
        rest = parts[known:]
        assert len(rest) <= 1, f"{identifier}: no module {'.'.join(parts[: known + 1])}"
        if rest:
            tree = ast.parse(file.read_text(encoding="utf-8"))
            there = {getattr(node, "name", "") for node in tree.body}
            assert rest[0] in there, f"{identifier}: not in {file}"


def module(parts: list[str]) -> Path | None:
    """File of a module or package."""
    base = ROOT.joinpath(*parts)
    return next((p for p in (base.with_suffix(".py"), base / "__init__.py") if p.is_file()), None)
