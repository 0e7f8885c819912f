"""The controller: edges, what it senses, and what it makes of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from fmus.controller import physics
from fmus.controller.interface import CAPACITANCE, Input, Output, Params
from fmus.controller.sensing import angle_of, following, normal

OPEN = Params(
    start_frequency=20.0, lag_integral_gain=0.0, stroke_gain=0.0, stroke_integral_gain=0.0
)
SIZE, LAG = 0.4, 1.1


def swinging(t: float, frequency: float = 20.0) -> Input:
    """A harmonic motion behind a drive that began at t = 0."""
    phase = 2.0 * math.pi * frequency * t - LAG
    return Input(
        motion_flap_angle=SIZE * math.sin(phase),
        motion_flap_rate=SIZE * 2.0 * math.pi * frequency * math.cos(phase),
    )


def stepped(
    p: Params, steps: int, stop: float, motion: Callable[[float], Input] = swinging
) -> list[tuple[float, Output]]:
    """Outputs at the communication points; as under a sequential master inputs are of the end."""
    h = stop / steps
    x = physics.initial(p, motion(0.0), 0.0)
    found = [(0.0, physics.observe(p, x, motion(0.0), 0.0))]
    for k in range(steps):
        u = motion((k + 1) * h)
        x = physics.advance(p, x, u, k * h, h)
        found.append(((k + 1) * h, physics.observe(p, x, u, (k + 1) * h)))
    return found


@pytest.mark.parametrize("steps", [20, 37, 100, 411])
def test_lag_and_stroke_wherever_the_points_lie(steps: int) -> None:
    """The cubic between two points: fourth order, 1e-4 at 20 points a cycle."""
    _, last = stepped(OPEN, 4 * steps, 0.2)[-1]
    allowed = 3e-4 * (20 / steps) ** 4 + 1e-9
    assert last.lag == pytest.approx(LAG, abs=allowed)
    assert last.stroke == pytest.approx(2.0 * SIZE, rel=allowed)
    assert last.cycles == 4.0


def test_a_jacobi_master_gives_inputs_of_the_start() -> None:
    """Their stamp says so: the angle goes on at its rate to the end of the step."""
    h = 0.05 / 400
    x = physics.initial(OPEN, swinging(0.0), 0.0)
    for k in range(1600):
        u = replace(swinging(k * h), motion_reference_time=k * h)
        x = physics.advance(OPEN, x, u, k * h, h)
    found = physics.observe(OPEN, x, swinging(0.2), 0.2)
    assert found.lag == pytest.approx(LAG, abs=1e-4)
    assert found.stroke == pytest.approx(2.0 * SIZE, rel=1e-4)


def test_the_next_edge_is_announced_and_taken_at_its_time() -> None:
    p = replace(OPEN, start_drive=0.25)
    x = physics.initial(p, swinging(0.0), 0.0)
    time, levels = 0.0, []
    for _ in range(8):
        found = physics.observe(p, x, swinging(time), time)
        levels.append((found.command_top, found.command_bottom))
        x = physics.advance(
            p, x, swinging(found.next_event_time), time, found.next_event_time - time
        )
        time = found.next_event_time
    assert time == pytest.approx(8 * 0.025, rel=1e-12)
    assert levels == [(960.0, 0.0), (0.0, 960.0)] * 4


@pytest.mark.parametrize("start_phase", [0.0, 1.0, math.pi, 5.0, -2.0])
def test_the_phase_at_the_start(start_phase: float) -> None:
    p = replace(OPEN, start_phase=start_phase)
    first = stepped(p, 1, 1e-9)[0][1]
    share = start_phase / (2.0 * math.pi) % 1.0
    assert (first.command_top > 0.0) == (share < 0.5)
    left = (0.5 if share < 0.5 else 1.0) - share
    assert first.next_event_time == pytest.approx(left / 20.0)


def test_each_gain_moves_its_command_by_its_error() -> None:
    p = replace(
        OPEN, start_drive=0.5, lag_gain=3.0, lag_integral_gain=2.0, stroke_gain=0.2,
        stroke_integral_gain=0.1, stroke_target=1.0, lag_target=1.2,
    )  # fmt: skip
    found = stepped(p, 400, 0.05)[-1][1]
    assert found.frequency == pytest.approx(20.0 + 5.0 * (1.2 - LAG), rel=1e-6)
    assert found.drive == pytest.approx(0.5 + 0.3 * (1.0 - 2.0 * SIZE), rel=1e-6)


def test_the_sums_do_not_wind_up() -> None:
    """A stroke that cannot be reached for fifty cycles is let go within one that can."""
    p = replace(OPEN, stroke_integral_gain=0.1, stroke_target=2.0)
    x = physics.initial(p, swinging(0.0), 0.0)
    for k in range(500):
        x = physics.advance(p, x, swinging((k + 1) * 0.005), k * 0.005, 0.005)
    assert x.drive == x.drive_sum == 1.0
    lower = replace(p, stroke_target=0.5)
    for k in range(500, 520):
        x = physics.advance(lower, x, swinging((k + 1) * 0.005), k * 0.005, 0.005)
    assert x.drive < 0.97


def test_what_does_not_move_has_no_lag_to_follow() -> None:
    p = replace(OPEN, lag_integral_gain=5.0)
    found = stepped(p, 100, 0.2, lambda t: Input())[-1][1]
    assert found.frequency == pytest.approx(20.0)
    assert found.stroke == 0.0


def charged(p: Params, t: float) -> Input:
    """Charges of both cones at an angle that the calibrated curve gives, mirrored at the bottom."""
    angle = 0.3 * math.sin(2.0 * math.pi * 20.0 * t - LAG)
    volts = p.largest_voltage
    rest = p.rest_capacitance * (1.0 + p.capacitance_by_square * volts * volts)

    def charge(wanted: float) -> float:
        low, high = -0.2, 0.2
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if angle_of(p, 0.0, middle) < wanted else (low, middle)
        return rest * (1.0 + low) * volts

    return Input(
        top_charge=charge(angle), top_reference_voltage=volts,
        bottom_charge=charge(-angle), bottom_reference_voltage=volts,
    )  # fmt: skip


def test_the_angle_by_the_capacitance_of_the_charged_cone() -> None:
    p = replace(OPEN, sensor=CAPACITANCE)
    found = stepped(p, 800, 0.2, lambda t: charged(p, t))[-1][1]
    assert found.lag == pytest.approx(LAG, abs=1e-3)
    assert found.stroke == pytest.approx(0.6, rel=1e-3)


def test_a_cone_that_is_not_charged_is_not_read() -> None:
    p = replace(OPEN, sensor=CAPACITANCE)
    found = stepped(p, 100, 0.2, lambda t: Input(top_charge=1e-9, top_reference_voltage=1.0))
    assert found[-1][1].stroke == 0.0


def test_noise_is_the_same_at_every_step() -> None:
    p = replace(OPEN, sensor=CAPACITANCE, noise=0.01)
    found = [stepped(p, n, 0.2, lambda t: charged(p, t))[-1][1] for n in (400, 800)]
    assert found[0].stroke == pytest.approx(found[1].stroke, rel=2e-3)
    other = stepped(replace(p, noise_seed=2.0), 400, 0.2, lambda t: charged(p, t))[-1][1]
    assert abs(other.stroke / found[0].stroke - 1.0) > 2e-3


def test_the_noise_is_normal() -> None:
    random, found = 1.0, []
    for _ in range(4000):
        first = following(random)
        random = following(first)
        found.append(normal(first, random))
    mean = sum(found) / len(found)
    spread = math.sqrt(sum((n - mean) ** 2 for n in found) / len(found))
    assert abs(mean) < 0.05
    assert spread == pytest.approx(1.0, rel=0.05)
    assert sum(abs(n) < 1.0 for n in found) / len(found) == pytest.approx(0.6827, abs=0.03)


def test_limits_in_the_wrong_order_are_refused() -> None:
    with pytest.raises(ValueError, match="least_frequency"):
        physics.initial(replace(OPEN, least_frequency=60.0), Input(), 0.0)
