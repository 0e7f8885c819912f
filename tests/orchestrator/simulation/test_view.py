"""The view that observers get: a mapping of the present values, with no way to change them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orchestrator import load
from orchestrator.simulation.system import System
from orchestrator.simulation.view import View


def test_a_view_is_a_mapping_of_the_present_values(library: Path) -> None:
    with System(load("oscillator-1", None, library)) as system:
        view = View(system)
        assert view.names == tuple(system.names) == tuple(view)
        assert len(view) == len(system.names)
        assert "payload.displacement" in view and "payload.mass" not in view
        assert dict(view) == dict(zip(system.names, system.values.tolist(), strict=True))
        assert (view.step, view.time) == (0, 0.0)
        system.values[3] = 0.25
        assert view[system.names[3]] == 0.25


def test_a_view_takes_no_change(library: Path) -> None:
    with System(load("oscillator-1", None, library)) as system:
        view = View(system)
        before = system.values.copy()
        taken = view.array()
        taken[:] = np.nan
        with pytest.raises(TypeError, match="item assignment"):
            view["payload.displacement"] = 1.0  # type: ignore[index]
        with pytest.raises(AttributeError):
            view.time = 1.0  # type: ignore[misc]
        assert system.values.tobytes() == before.tobytes()
