"""The parts under test are those that pythonfmu exports."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def library(python_parts: Path) -> Path:
    """Folder with every part in Python."""
    return python_parts
