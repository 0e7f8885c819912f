"""Faults that a scenario injects: what they do, when they end, what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orchestrator.errors import Divergence, InstanceFailure, ScenarioError
from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.masters import MASTERS
from orchestrator.simulation.run import run


def faulty(library: Path, folder: Path, fault: str, kind: str = "gauss-seidel") -> Outcome:
    """oscillator-1 for six cycles with one fault."""
    scenario = folder / "faulty.toml"
    scenario.write_text(
        'extends = "oscillator-1"\n[time]\nstop = "6 cycles"\n'
        f'[[faults]]\nat = "3 cycles"\n{fault}\n'
    )
    return run(load(scenario, None, library, master={"kind": kind}))


@pytest.mark.parametrize("kind", MASTERS)
def test_an_instance_that_drops_out_stops_the_run(library: Path, tmp_path: Path, kind: str) -> None:
    done = faulty(library, tmp_path, 'on = "spring"\nkind = "drop"', kind)
    assert isinstance(done.failure, InstanceFailure)
    assert str(done.failure).startswith("spring: step to t = 0.0")
    assert len(done.times) == 181
    assert np.isfinite(done.rows).all()


def test_nan_stops_the_run_where_it_is_put_out(library: Path, tmp_path: Path) -> None:
    done = faulty(library, tmp_path, 'on = "payload.displacement"\nkind = "nan"')
    assert isinstance(done.failure, Divergence)
    assert "payload.displacement = nan m at t = 0.0579" in str(done.failure)


@pytest.mark.parametrize("kind", MASTERS)
def test_what_is_frozen_stays_until_the_fault_ends(
    library: Path, tmp_path: Path, kind: str
) -> None:
    fault = 'on = "payload.displacement"\nkind = "freeze"\nuntil = "4 cycles"'
    done = faulty(library, tmp_path, fault, kind)
    frozen = done.series("payload.displacement")
    assert done.failure is None
    assert np.ptp(frozen[179:240]) == 0.0
    assert np.ptp(frozen[240:]) > 0.0
    assert np.ptp(done.series("payload.velocity")[179:240]) > 0.0


def test_a_bias_is_added_in_the_unit_of_the_output(library: Path, tmp_path: Path) -> None:
    fault = 'on = "spring.elastic_energy"\nkind = "bias"\nsize = "1 mJ"\nuntil = "4 cycles"'
    done, sound = (
        faulty(library, tmp_path, fault),
        run(load("oscillator-1", None, library, time={"stop": "6 cycles"})),
    )
    off = done.series("spring.elastic_energy") - sound.series("spring.elastic_energy")
    assert off[180:240] == pytest.approx(1e-3)
    assert np.abs(np.delete(off, np.s_[180:240])).max() < 1e-15


def test_noise_is_the_same_for_the_same_seed(library: Path, tmp_path: Path) -> None:
    fault = 'on = "payload.velocity"\nkind = "noise"\nsize = "1 mm/s"\nseed = 3'
    first, again = (faulty(library, tmp_path, fault).series("payload.velocity") for _ in range(2))
    other = faulty(library, tmp_path, fault.replace("3", "4")).series("payload.velocity")
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    assert np.array_equal(first[:180], other[:180])
    rough = np.diff(first[180:], 3).std() / np.sqrt(20.0)
    assert 0.7e-3 < rough < 1.5e-3


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ('on = "sprung"\nkind = "drop"', r"on: no component 'sprung'; did you mean 'spring'\?"),
        ('on = "spring.force.value"\nkind = "drop"', "on: a component drops out as a whole"),
        ('on = "spring"\nkind = "noise"\nsize = 1.0', "on: noise needs one output"),
        ('on = "spring.force.valve"\nkind = "nan"', "did you mean 'spring.force.value'|'force"),
        ('on = "spring.force.value"\nkind = "bias"', "size: bias needs one, in N"),
        ('on = "spring.force.value"\nkind = "bias"\nsize = "1 V"', "size: .*V"),
        ('on = "spring"\nkind = "nan"\nsize = 1.0', "size: means nothing to nan"),
        ('on = "spring"\nkind = "drop"\nuntil = "2 cycles"', "until: has to be after at"),
        ('on = "spring"\nkind = "melt"', "faults.0.kind"),
    ],
)
def test_what_makes_no_sense_is_refused(
    library: Path, tmp_path: Path, fault: str, reason: str
) -> None:
    with pytest.raises(ScenarioError, match=reason):
        faulty(library, tmp_path, fault)
