"""A drawing of a page: an SVG that stands in the file itself."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class Picture:
    """An SVG under a title. `text` says what it shows, for those who do not see it."""

    kind: ClassVar[str] = "picture"
    title: str
    text: str
    svg: bytes

    @property
    def source(self) -> str:
        """The drawing as an address of its own."""
        return f"data:image/svg+xml;base64,{base64.b64encode(self.svg).decode()}"
