"""Shape of both cones: where six points of each film are, at a displacement and two voltages.

Point k is at flat radius R_k = a (b/a)^s_k, s_k the inner Chebyshev-Lobatto points; both rims are
known, (a, h) and (b, 0). Radius and height come from the membrane's direct solution, tabled in
x = h/b and e = eps V^2/(mu_1 T^2) as its potential is. The film has no inertia: the shape follows
its inputs at once. Nothing of it acts on anything else.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..constants import VACUUM_PERMITTIVITY
from ..membrane.splines import values
from ..quantity import parameter, provided, received
from .tables import CELLS_E, CELLS_X, FILMS, HEIGHT, HIGHEST, LOADING, LOWEST, RADIUS


@dataclass(frozen=True)
class Params:
    """Which film it is, as the membrane has it."""

    film: float = parameter(1.0, "1", "Film, by its table", "chosen: the vehicle's", choices=FILMS)
    outer_radius: float = parameter(
        13.0e-3, "m", "Radius b of the frames", "printed: table 3", least=1.0e-6
    )
    spacer: float = parameter(
        13.0e-3, "m", "Height L of the spacer between the cones", "printed: table 3", least=1.0e-6
    )
    thickness: float = parameter(
        40.0e-6, "m", "Thickness of a layer before pre-stretch", "printed: text", least=1.0e-9
    )
    modulus: float = parameter(
        1.287e5,
        "Pa",
        "First Ogden modulus; the others keep their ratio",
        "printed: equation 5",
        least=1.0,
    )
    permittivity: float = parameter(
        2.65, "1", "Relative permittivity", "calibrated: as the membrane's", least=1.0e-3
    )


@dataclass(frozen=True)
class Input:
    """Voltages and place of the spacer."""

    top_voltage: float = received(0.0, "V", "Voltage of the top cone", port="top")
    bottom_voltage: float = received(0.0, "V", "Voltage of the bottom cone", port="bottom")
    motion_displacement: float = received(0.0, "m", "Displacement of the spacer", port="motion")


@dataclass(frozen=True)
class State:
    """The time, as a shape has no past."""

    time: float


Six = tuple[float, float, float, float, float, float]
Spot = tuple[int, int, Six, Six]
"""A cell of a table in x and e, and the weights of the splines there."""

_TOP = ("top", "motion")
_BOTTOM = ("bottom", "motion")


@dataclass(frozen=True)
class Output:
    """Points from the inner rim to the outer; axial positions from the plane of the frames."""

    top_shape_radius_1: float = provided(
        "m", "Radius of point 1, top cone", port="top_shape", depends=_TOP
    )
    top_shape_axial_1: float = provided(
        "m", "Axial position of point 1, top cone", port="top_shape", depends=_TOP
    )
    top_shape_radius_2: float = provided(
        "m", "Radius of point 2, top cone", port="top_shape", depends=_TOP
    )
    top_shape_axial_2: float = provided(
        "m", "Axial position of point 2, top cone", port="top_shape", depends=_TOP
    )
    top_shape_radius_3: float = provided(
        "m", "Radius of point 3, top cone", port="top_shape", depends=_TOP
    )
    top_shape_axial_3: float = provided(
        "m", "Axial position of point 3, top cone", port="top_shape", depends=_TOP
    )
    top_shape_radius_4: float = provided(
        "m", "Radius of point 4, top cone", port="top_shape", depends=_TOP
    )
    top_shape_axial_4: float = provided(
        "m", "Axial position of point 4, top cone", port="top_shape", depends=_TOP
    )
    top_shape_radius_5: float = provided(
        "m", "Radius of point 5, top cone", port="top_shape", depends=_TOP
    )
    top_shape_axial_5: float = provided(
        "m", "Axial position of point 5, top cone", port="top_shape", depends=_TOP
    )
    top_shape_radius_6: float = provided(
        "m", "Radius of point 6, top cone", port="top_shape", depends=_TOP
    )
    top_shape_axial_6: float = provided(
        "m", "Axial position of point 6, top cone", port="top_shape", depends=_TOP
    )
    bottom_shape_radius_1: float = provided(
        "m", "Radius of point 1, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_axial_1: float = provided(
        "m", "Axial position of point 1, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_radius_2: float = provided(
        "m", "Radius of point 2, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_axial_2: float = provided(
        "m", "Axial position of point 2, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_radius_3: float = provided(
        "m", "Radius of point 3, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_axial_3: float = provided(
        "m", "Axial position of point 3, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_radius_4: float = provided(
        "m", "Radius of point 4, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_axial_4: float = provided(
        "m", "Axial position of point 4, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_radius_5: float = provided(
        "m", "Radius of point 5, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_axial_5: float = provided(
        "m", "Axial position of point 5, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_radius_6: float = provided(
        "m", "Radius of point 6, bottom cone", port="bottom_shape", depends=_BOTTOM
    )
    bottom_shape_axial_6: float = provided(
        "m", "Axial position of point 6, bottom cone", port="bottom_shape", depends=_BOTTOM
    )


def loading(p: Params, voltage: float) -> float:
    """e = eps V^2/(mu_1 T^2) of a voltage [V]."""
    field = voltage / p.thickness
    return VACUUM_PERMITTIVITY * p.permittivity * field * field / p.modulus


def spot(film: int, x: float, e: float) -> Spot:
    """Where x and e are in a film's table; below it at its lowest x."""
    if e > LOADING[film]:
        raise ValueError("the voltage is above the film's table: near or past pull-in")
    if x > HIGHEST[film]:
        raise ValueError("a cone is higher than the film's table: no stable equilibrium nearby")
    place_x = max(0.0, x - LOWEST[film]) * CELLS_X / (HIGHEST[film] - LOWEST[film])
    place_e = e * CELLS_E / LOADING[film]
    cell_x = min(int(place_x), CELLS_X - 1)
    cell_e = min(int(place_e), CELLS_E - 1)
    return cell_x, cell_e, values(place_x - float(cell_x)), values(place_e - float(cell_e))


def place(rows: tuple[tuple[float, ...], ...], at: Spot) -> float:
    """A tabled length over b."""
    cell_x, cell_e, n, m = at
    found = 0.0
    for i in range(6):
        row = rows[cell_x + i]
        for j in range(6):
            found = found + n[i] * m[j] * row[cell_e + j]
    return found


def taut(film: int, x: float) -> float:
    """What a cone has of the height in its table: less than 1 where it is slack, below it."""
    if x < LOWEST[film]:
        return max(0.0, x) / LOWEST[film]
    return 1.0


def initial(p: Params, u: Input, t: float) -> State:
    return State(time=t)


def advance(p: Params, x: State, u: Input, t: float, h: float) -> State:
    return State(time=t + h)


def observe(p: Params, x: State, u: Input, t: float) -> Output:
    """Both shapes; `ValueError` above the film's table in height or voltage."""
    film = int(p.film) - 1
    top_x = (0.5 * p.spacer + u.motion_displacement) / p.outer_radius
    bottom_x = (0.5 * p.spacer - u.motion_displacement) / p.outer_radius
    top = spot(film, top_x, loading(p, u.top_voltage))
    bottom = spot(film, bottom_x, loading(p, u.bottom_voltage))
    upper = p.outer_radius * taut(film, top_x)
    lower = p.outer_radius * taut(film, bottom_x)
    return Output(
        top_shape_radius_1=p.outer_radius * place(RADIUS[film][0], top),
        top_shape_axial_1=upper * place(HEIGHT[film][0], top),
        top_shape_radius_2=p.outer_radius * place(RADIUS[film][1], top),
        top_shape_axial_2=upper * place(HEIGHT[film][1], top),
        top_shape_radius_3=p.outer_radius * place(RADIUS[film][2], top),
        top_shape_axial_3=upper * place(HEIGHT[film][2], top),
        top_shape_radius_4=p.outer_radius * place(RADIUS[film][3], top),
        top_shape_axial_4=upper * place(HEIGHT[film][3], top),
        top_shape_radius_5=p.outer_radius * place(RADIUS[film][4], top),
        top_shape_axial_5=upper * place(HEIGHT[film][4], top),
        top_shape_radius_6=p.outer_radius * place(RADIUS[film][5], top),
        top_shape_axial_6=upper * place(HEIGHT[film][5], top),
        bottom_shape_radius_1=p.outer_radius * place(RADIUS[film][0], bottom),
        bottom_shape_axial_1=-lower * place(HEIGHT[film][0], bottom),
        bottom_shape_radius_2=p.outer_radius * place(RADIUS[film][1], bottom),
        bottom_shape_axial_2=-lower * place(HEIGHT[film][1], bottom),
        bottom_shape_radius_3=p.outer_radius * place(RADIUS[film][2], bottom),
        bottom_shape_axial_3=-lower * place(HEIGHT[film][2], bottom),
        bottom_shape_radius_4=p.outer_radius * place(RADIUS[film][3], bottom),
        bottom_shape_axial_4=-lower * place(HEIGHT[film][3], bottom),
        bottom_shape_radius_5=p.outer_radius * place(RADIUS[film][4], bottom),
        bottom_shape_axial_5=-lower * place(HEIGHT[film][4], bottom),
        bottom_shape_radius_6=p.outer_radius * place(RADIUS[film][5], bottom),
        bottom_shape_axial_6=-lower * place(HEIGHT[film][5], bottom),
    )
