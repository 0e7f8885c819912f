"""Results of single points on disk, each whole or not there: what a sweep resumes from."""

from __future__ import annotations

import contextlib
import math
import re
from pathlib import Path
from typing import Any

from ...errors import OutputError
from ...results.lock import Lock
from ..run_cache import RunCache
from .points import Point, Record

LOCK = "lock"
_POINT = re.compile(r"\.?[0-9a-f]{32}\.(?:json|part)")


class Checkpoint:
    """`TARGET.points`: one JSON file for each finished point, named by the point's key.

    A context manager that holds the folder for one sweep at a time.
    """

    def __init__(self, target: Path) -> None:
        self.path = target.with_name(f"{target.name}.points")
        self._cache = RunCache(self.path)
        self._lock = Lock(self.path / LOCK)

    def __enter__(self) -> Checkpoint:
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            (self.path / LOCK).touch()
            held = self._lock.take()
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be used ({error.strerror})") from None
        if not held:
            raise OutputError(f"{self.path}: in use by another sweep; wait, or name another result")
        for left in self.path.glob(".*.part"):
            left.unlink(missing_ok=True)
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(OSError):
            if [entry.name for entry in self.path.iterdir()] == [LOCK]:
                (self.path / LOCK).unlink()
                self.path.rmdir()
        self._lock.release()

    def read(self, point: Point) -> Record | None:
        """The record of a point; None where there is none, or where it is no longer readable."""
        try:
            found = self._cache.read(point.key)
            return None if found is None else record_of(found["record"])
        except (ValueError, KeyError, TypeError, AttributeError):
            return None

    def write(self, point: Point, record: Record) -> None:
        """Write the record of a point, which survives a kill once this returns."""
        named = dict(zip(point.names, point.values, strict=True))
        try:
            self._cache.write(point.key, {"point": named, "record": plain(record)})
        except OutputError as error:
            raise OutputError(
                f"{error}; make room and sweep again: the points before it are kept"
            ) from None

    def remove(self) -> None:
        """Remove all points; the folder goes on exit where nothing else is in it."""
        with contextlib.suppress(OSError):
            for entry in self.path.iterdir():
                if _POINT.fullmatch(entry.name):
                    entry.unlink(missing_ok=True)


def plain(record: Record) -> dict[str, Any]:
    """A record as JSON; a metric that is not a finite number is null."""
    metrics = [[n, v if math.isfinite(v) else None, u] for n, v, u in record.metrics]
    return {
        "status": record.status,
        "reason": record.reason,
        "metrics": metrics,
        "wall_time": record.wall_time,
        "steps": record.steps,
    }


def record_of(known: dict[str, Any]) -> Record:
    """The record of its JSON, or of a worker's answer."""
    metrics = tuple(
        (str(name), math.nan if value is None else float(value), str(unit))
        for name, value, unit in known["metrics"]
    )
    return Record(
        status=str(known["status"]),
        reason=str(known["reason"]),
        metrics=metrics,
        wall_time=float(known["wall_time"]),
        steps=int(known["steps"]),
    )
