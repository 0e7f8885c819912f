"""Answers on disk, each whole or not there: what makes the second time quick."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import OutputError
from .job import Answer, answer_of


class RunCache:
    """A folder with one JSON file for each answer, named by the job's digest."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def prepare(self) -> None:
        """Make the folder; `OutputError` where that cannot be."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{self.folder}: cannot be made ({error.strerror})") from None

    def read(self, key: str) -> Answer | None:
        """The answer under a key; None where there is none, or no longer a readable one."""
        try:
            content = json.loads((self.folder / f"{key}.json").read_text(encoding="utf-8"))
            if content["sha256"] != _digest(content["answer"]):
                return None
            return answer_of(content["answer"])
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None

    def write(self, key: str, answer: Mapping[str, Any]) -> None:
        """Keep an answer, whole under its name or not there."""
        waiting = self.folder / f".{key}.part"
        try:
            content = {"answer": answer, "sha256": _digest(answer)}
            waiting.write_text(json.dumps(content, separators=(",", ":")), encoding="utf-8")
            waiting.replace(self.folder / f"{key}.json")
        except OSError as error:
            raise OutputError(f"{self.folder}: cannot be written ({error.strerror})") from None
        finally:
            waiting.unlink(missing_ok=True)


def _digest(answer: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()
