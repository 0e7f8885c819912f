"""The benchmark folders are not an installed package: they are put on the path here."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))


@pytest.fixture(scope="session")
def library(python_parts: Path) -> Path:
    """Other tools step the parts that pythonfmu exports."""
    return python_parts
