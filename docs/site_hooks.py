"""Hooks of mkdocs: pages that stand elsewhere in the repository, and links between them.

README, CONTRIBUTING, CHANGELOG and the READMEs of folders are pages of the site under other
names. A link is written as it has to be in the repository; here it becomes the one that holds in
the site. A link to a file that is not a page of the site becomes plain text.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"(?P<image>!?)\[(?P<text>[^\]]*)\]\((?P<target>[^)\s]+)\)")
FENCE = re.compile(r"(^```.*?^```$)", re.M | re.S)
ROLE = re.compile(r":(?:func|class|meth|mod|attr|data|exc):(?=<code>)")


def elsewhere() -> dict[str, str]:
    """Path in the repository to path in the site, for pages outside of `docs/`."""
    found = {
        "README.md": "index.md",
        "CONTRIBUTING.md": "contributing.md",
        "CHANGELOG.md": "changelog.md",
        "examples/README.md": "examples.md",
        "fmus/README.md": "parts/index.md",
    }
    for path in sorted(ROOT.glob("fmus/*/README.md")):
        found[path.relative_to(ROOT).as_posix()] = f"parts/{path.parent.name}.md"
    return found


ELSEWHERE = elsewhere()


def in_site(path: str) -> str:
    """Path in the site of a file of the repository."""
    return ELSEWHERE.get(path, path.removeprefix("docs/"))


def on_files(files: Files, config: Any) -> Files:
    """Add the pages that stand outside of `docs/`."""
    for source, target in ELSEWHERE.items():
        text = (ROOT / source).read_text(encoding="utf-8")
        files.append(File.generated(config, target, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: Any, files: Files) -> str:
    """The page with its links as they hold in the site; code blocks stay as they are."""
    here = page.file.src_uri
    source = {target: path for path, target in ELSEWHERE.items()}.get(here, f"docs/{here}")
    pieces = FENCE.split(markdown)
    return "".join(
        piece if k % 2 else LINK.sub(lambda found: _link(found, source, here, files), piece)
        for k, piece in enumerate(pieces)
    )


def _link(found: re.Match[str], source: str, here: str, files: Files) -> str:
    target, hash_, anchor = found["target"].partition("#")
    if not target or "://" in target or target.startswith("mailto:"):
        return found[0]
    path = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
    page = in_site(path)
    if files.get_file_from_path(page) is None:
        return found["text"] if (ROOT / path).exists() else found[0]
    near = posixpath.relpath(page, posixpath.dirname(here) or ".")
    return f"{found['image']}[{found['text']}]({near}{hash_}{anchor})"


def on_page_content(html: str, page: Page, config: Any, files: Files) -> str:
    """Roles of docstrings, as `:func:`, leave the name alone."""
    return ROLE.sub("", html)
