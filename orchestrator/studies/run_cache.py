"""Answers of runs on disk, each whole or not there, for repeated and resumed studies."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import OutputError
from ..report.files import written_whole


class RunCache:
    """A folder with one JSON file for each answer, named by the key of its run."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def prepare(self) -> None:
        """Make the folder; `OutputError` where it cannot be made."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{self.folder}: cannot be made ({error.strerror})") from None

    def read(self, key: str) -> Mapping[str, Any] | None:
        """The answer of a key; None where there is none, or where its digest does not match."""
        try:
            content = json.loads(self.path(key).read_text(encoding="utf-8"))
            answer = content["answer"]
            return answer if content["sha256"] == _digest(answer) else None
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def write(self, key: str, answer: Mapping[str, Any]) -> None:
        """Write an answer, which survives a kill once this returns; else `OutputError`."""
        with written_whole(self.path(key), durable=True) as waiting:
            content = {"answer": answer, "sha256": _digest(answer)}
            waiting.write_text(json.dumps(content, separators=(",", ":")), encoding="utf-8")

    def path(self, key: str) -> Path:
        """The file of a key."""
        return self.folder / f"{key}.json"


def _digest(answer: Any) -> str:
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()
