"""Where the links are: the pose of conrod, bell crank, coupler and rocker at a displacement.

The crank's pivot is the origin, the slider moves along y at x = -crank. In the neutral pose the
crank lies along -x, conrod and arm along y, the coupler along x. As the part `linkage` has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .published_values import given

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Links:
    """Lengths L1 to L5 [m]."""

    conrod: float
    crank: float
    arm: float
    coupler: float
    rocker: float


def links() -> Links:
    """The printed lengths."""
    return Links(*map(float, given("links")))


def joints(
    sizes: Links, displacement: Values, flap_angle: Values
) -> Mapping[str, tuple[Values, Values]]:
    """Places [m] of all joints for displacements (n,) [m] and flap angles (n,) [rad].

    The crank follows from the first loop, the rocker from the flap angle; that the coupler keeps
    its length is then what the mechanism's own solution must give.
    """
    c = sizes
    reach = c.conrod + displacement
    far = np.hypot(c.crank, reach)
    within = (c.crank**2 + far**2 - c.conrod**2) / (2.0 * c.crank * far)
    crank = np.arctan2(reach, -c.crank) + np.arccos(within)
    arm = crank - 0.5 * np.pi
    rocker = 0.5 * np.pi - flap_angle
    root = (c.coupler, c.arm - c.rocker)
    zero = np.zeros_like(displacement)
    return {
        "slider": (zero - c.crank, reach),
        "crank": (c.crank * np.cos(crank), c.crank * np.sin(crank)),
        "pivot": (zero, zero),
        "arm": (c.arm * np.cos(arm), c.arm * np.sin(arm)),
        "rocker": (root[0] + c.rocker * np.cos(rocker), root[1] + c.rocker * np.sin(rocker)),
        "root": (zero + root[0], zero + root[1]),
    }
