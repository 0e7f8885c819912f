"""What an FMU shows of itself: its part's README as a page, its icon, its licence."""

from __future__ import annotations

import hashlib
import html
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

TERMINALS = "terminalsAndIcons"
"""Folder and file of FMI 3 for terminals and icons."""
MARKS = Path(__file__).parent / "icons"
"""Marks of the terminals: a triangle into the part, and one out of it."""
LINK = re.compile(r'<a href="(?![a-z]+:|#)[^"]*">(.*?)</a>', re.DOTALL)
"""A link to a file that is not in the FMU."""

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>
body {{ font: 1rem/1.5 sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }}
table {{ border-collapse: collapse; display: block; overflow-x: auto; }}
th, td {{ border: 1px solid #bbb; padding: 0.2rem 0.6rem; text-align: left; }}
pre {{ overflow-x: auto; background: #f4f4f4; padding: 0.6rem; }}
:root {{ color-scheme: light dark; }}
@media (prefers-color-scheme: dark) {{ pre {{ background: #222; }} }}
</style>
</head>
<body>
{body}
</body>
</html>
"""


@dataclass(frozen=True)
class Documentation:
    """README, drawing and picture of a part as they are; empty where it has none."""

    title: str
    readme: bytes
    drawing: bytes
    picture: bytes

    @property
    def has_icon(self) -> bool:
        """Whether there is a picture, which every version of FMI asks for."""
        return bool(self.picture)

    @property
    def digest(self) -> str:
        """What stands for all of it in the digest of an FMU."""
        digest = hashlib.sha256(PAGE.encode())
        for content in (self.readme, self.drawing, self.picture):
            digest.update(str(len(content)).encode() + b"\0" + content)
        return digest.hexdigest()

    def files(self, fmi: int) -> dict[str, bytes]:
        """Place in the archive of that version of FMI -> content."""
        page = _page(self.title, self.readme.decode()).encode() if self.readme else b""
        files = {"documentation/index.html": page}
        if fmi == 2:
            files["model.png"] = self.picture
        else:
            files |= {f"{TERMINALS}/icon.svg": self.drawing, f"{TERMINALS}/icon.png": self.picture}
            if self.has_icon:
                marks = sorted(MARKS.glob("*.*"))
                files |= {f"{TERMINALS}/{mark.name}": mark.read_bytes() for mark in marks}
        return {name: content for name, content in files.items() if content}


def documentation_of(part: Any) -> Documentation:
    """The documentation of a part: `README.md`, `icon.svg` and `icon.png` of its folder."""
    folder = Path(part.physics.__file__).parent
    names = ("README.md", "icon.svg", "icon.png")
    return Documentation(part.name, *(_content(folder / name) for name in names))


def _content(path: Path) -> bytes:
    return path.read_bytes() if path.is_file() else b""


def _page(title: str, text: str) -> str:
    """A README as a page that needs nothing else: links to other files become plain text."""
    from markdown_it import MarkdownIt

    body = MarkdownIt("commonmark", {"html": False}).enable("table").render(text)
    return PAGE.format(title=html.escape(title), body=LINK.sub(r"\1", body))
