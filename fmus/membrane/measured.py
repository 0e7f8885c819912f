"""A table of a cone whose force was measured over height and voltage, in the place of the solver's.

With the force F(h, E) at V^2 = E and the capacitance C(h0, E) at the lowest height,

    Pi(h, E) = int_h0^h F(h', E) dh' - 1/2 int_0^E C(h0, E') dE',

so the charge at any other height follows from the forces, dC/dh = -2 dF/dE: energy closes whatever
was measured, and a capacitance measured elsewhere would only repeat it. Forces and capacitances are
interpolated by cubic splines through the points, in h and in E; noise is to be smoothed before.
"""

from __future__ import annotations

import csv
import math
from typing import Any

import numpy as np

from ..constants import VACUUM_PERMITTIVITY
from .film import Array
from .surrogate import FIELD_POINTS, chebyshev_nodes, splined

COLUMNS = ("height", "voltage", "force", "capacitance")
LEAST = 4
"""Heights and voltages from which a cubic goes through."""
MAP_KEYS = ("outer_radius", "thickness", "modulus", "permittivity", "layers", "measured")


def measured_table(
    data: dict[str, Any], nodes: tuple[int, int], cells: tuple[int, int]
) -> dict[str, Any]:
    """Table of an entry with `measured`, in the shape of :func:`fmus.membrane.surrogate.table`.

    `measured` is CSV text with the columns `height` [m], `voltage` [V], `force` [N] and
    `capacitance` [F] of one cone, at every height each voltage; the capacitance counts at the
    lowest height. `ValueError` says what is wrong with it. Fields and stresses were not measured:
    the table has the field of the flat film, and hoop tension everywhere.
    """
    heights, squares, forces, capacitances = _grid(str(data["measured"]))
    radius, thickness = float(data["outer_radius"]), float(data["thickness"])
    modulus, permittivity = float(data["modulus"]), float(data["permittivity"])
    layers = float(data["layers"])
    if min(radius, thickness, modulus, permittivity, layers) <= 0.0:
        raise ValueError("outer_radius, thickness, modulus, permittivity, layers are above zero")
    unit = 2.0 * math.pi * layers * thickness * radius * radius * modulus
    group = VACUUM_PERMITTIVITY * permittivity / (modulus * thickness * thickness)
    low, high = float(heights[0]), float(heights[-1])
    places = low + (high - low) * chebyshev_nodes(nodes[0])
    loads = squares[-1] * chebyshev_nodes(nodes[1])
    energies = potential(heights, squares, forces, capacitances, places, loads)
    flat = [[1.0] * FIELD_POINTS[1] for _ in range(FIELD_POINTS[0])]
    return {
        "lowest": low / radius,
        "highest": high / radius,
        "loading": group * float(squares[-1]),
        "ratio": 0.0,
        "prestretch": 1.0,
        "cells": list(cells),
        "potential": [[float(c) for c in row] for row in splined(energies / unit, cells)],
        "field": flat,
        "hoop": flat,
    }


def potential(
    heights: Array, squares: Array, forces: Array, capacitances: Array, places: Array, loads: Array
) -> Array:
    """Pi [J] at places [m] and squared voltages [V2]: rows of the places, columns of the loads."""
    from scipy.interpolate import CubicSpline

    by_load = CubicSpline(squares, forces, axis=1)(loads)
    work = CubicSpline(heights, by_load, axis=0).antiderivative()(places)
    charge = CubicSpline(squares, capacitances).antiderivative()(loads)
    return np.asarray(work - 0.5 * charge[None, :])


def _grid(text: str) -> tuple[Array, Array, Array, Array]:
    """Heights, squared voltages, forces over both, capacitances at the lowest height."""
    rows = [row for row in csv.reader(text.strip().splitlines()) if row]
    heading = [name.strip() for name in rows[0]] if rows else []
    if tuple(heading) != COLUMNS:
        raise ValueError(f"measured: needs the columns {', '.join(COLUMNS)}, in SI")
    values: dict[tuple[float, float], tuple[float, float]] = {}
    for line, row in enumerate(rows[1:], start=2):
        try:
            height, voltage, force, capacitance = map(float, row)
        except ValueError:
            raise ValueError(f"measured: line {line} is not four numbers") from None
        if not all(map(math.isfinite, (height, voltage, force, capacitance))):
            raise ValueError(f"measured: line {line} is not four finite numbers")
        if (height, voltage) in values:
            raise ValueError(f"measured: line {line} repeats {height:g} m at {voltage:g} V")
        values[height, voltage] = force, capacitance
    heights = sorted({height for height, _ in values})
    voltages = sorted({voltage for _, voltage in values})
    if len(heights) < LEAST or len(voltages) < LEAST:
        raise ValueError(f"measured: needs {LEAST} heights and {LEAST} voltages at least")
    if heights[0] <= 0.0 or voltages[0] != 0.0:
        raise ValueError("measured: heights are above zero, and voltages begin at 0 V")
    missing = [(h, v) for h in heights for v in voltages if (h, v) not in values]
    if missing:
        h, v = missing[0]
        raise ValueError(f"measured: {len(missing)} points are missing, as {h:g} m at {v:g} V")
    forces = np.array([[values[h, v][0] for v in voltages] for h in heights])
    capacitances = np.array([values[heights[0], v][1] for v in voltages])
    if capacitances.min() <= 0.0:
        raise ValueError(f"measured: capacitances at {heights[0]:g} m have to be above zero")
    return np.array(heights), np.array(voltages) ** 2, forces, capacitances
