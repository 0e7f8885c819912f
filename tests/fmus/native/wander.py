"""A long random stepper of a pair through its life, every answer compared."""

from __future__ import annotations

import numpy as np

from tests.fmus.native.pair import Library, Pair

STEP = 1e-4


def wander(part: str, library: Library, steps: int, seed: int) -> Pair:
    """Random inputs for some steps; now and then other parameters, states, a reset, faults."""
    rng = np.random.default_rng(seed)
    pair = Pair(part, library)
    time = 0.0
    begin(pair, rng, time)
    kept = None
    for _ in range(steps):
        event = rng.random()
        if event < 0.002:
            pair.reset()
            time = float(rng.uniform(0.0, 10.0))
            begin(pair, rng, time)
        elif event < 0.01:
            if kept is not None:
                pair.forget(kept)
            kept = pair.save()
            if event < 0.006:
                kept = pair.through_bytes(kept)
        elif event < 0.015 and kept is not None:
            pair.restore(kept)
        elif event < 0.03:
            chosen, values = pair.tune(rng, everything=False)
            if chosen:
                pair.set(chosen, values)
        size = STEP * float(rng.choice([0.3, 1.0, 1.0, 1.0, 2.0, 7.0]))
        pair.set(pair.inputs, pair.drive(rng, time, size))
        if rng.random() < 0.3:
            pair.get(pair.outputs)
        if pair.step(time, size):
            time += size
        if not np.isfinite(pair.get(pair.outputs)).all():
            pair.reset()
            begin(pair, rng, time)
    pair.get(pair.parameters)
    if kept is not None:
        pair.forget(kept)
    pair.close()
    return pair


def begin(pair: Pair, rng: np.random.Generator, time: float) -> None:
    """Parameters and inputs that both can be initialised with, the usual ones in the end."""
    for attempt in range(4):
        if attempt:
            pair.reset()
        if attempt < 3:
            chosen, values = pair.tune(rng, everything=True)
            if chosen:
                pair.set(chosen, values)
            pair.set(pair.inputs, pair.drive(rng, time, STEP))
        pair.get(pair.outputs)
        if pair.initialise(time):
            return
    raise AssertionError("the usual parameters do not initialise")
