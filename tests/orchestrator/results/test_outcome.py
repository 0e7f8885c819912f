"""What an outcome gives beside its rows."""

from __future__ import annotations

import pytest

from orchestrator.errors import Divergence
from tests.conftest import Runner


def test_checked_is_the_outcome_itself_or_its_failure(outcome: Runner) -> None:
    done = outcome("oscillator-1", time={"stop": "1 cycles"})
    assert done.checked() is done
    changes = {"payload.start_velocity": "9000", "spring.blocked_force": "0"}
    stopped = outcome("oscillator-1", changes)
    with pytest.raises(Divergence) as caught:
        stopped.checked()
    assert caught.value is stopped.failure
