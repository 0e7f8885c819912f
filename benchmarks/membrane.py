"""Error against evaluation time of every fidelity of the membrane, one cone.

    python benchmarks/membrane.py --output results/membrane-fidelities.png

Linear spring, truncated cone, surrogates of several sizes (the time is that of the FMU's
evaluation, which is local and does not depend on the size of the table), direct solutions, and
the paper's own way, shooting with a stiff integrator at several tolerances. All in one run; error
of the force over its largest value, for voltages up to 1500 and up to 1920 V; heights 8 to 22 mm.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from scipy.integrate import solve_ivp
from scipy.optimize import root

from fmus.membrane import physics
from fmus.membrane.film import Film, density
from fmus.membrane.ritz_solver import Equilibrium, NoEquilibriumError, equilibrium
from fmus.membrane.surrogate import Range, cardinal, group, table

FILM = Film(4e-3, 20e-3, 40e-6, (1.287e5, 2.6e4), (2.0, 4.0), 2.8)
Force = Callable[[float, float], float]


def linear_spring() -> Force:
    """Stiffness and dF/dE of the point h = 15 mm, V = 0."""
    here = equilibrium(FILM, 15e-3, 0.0)

    def force(height: float, voltage: float) -> float:
        return (
            here.force
            + here.stiffness * (height - here.height)
            + here.force_by_square * voltage * voltage
        )

    return force


def truncated_cone() -> Force:
    """Straight cone: uniform l1 = sqrt(1 + (h/(b-a))^2), l2 = 1."""
    a, b = FILM.inner_radius, FILM.outer_radius
    area = 0.5 * FILM.volume * (b * b - a * a)

    def force(height: float, voltage: float) -> float:
        slope = height / (b - a)
        l1 = math.sqrt(1.0 + slope * slope)
        d = density(FILM, np.array(l1), np.array(1.0), voltage * voltage)
        return area * float(d.w1) * slope / l1 / (b - a)

    return force


def surrogate(nodes: tuple[int, int], cells: tuple[int, int]) -> Force:
    """A table of the given size, evaluated with numpy."""
    span = Range(0.3, 1.25, group(FILM, 2000.0), nodes, cells)
    made = table(FILM, span)
    rows = np.array(made["potential"])
    scale = FILM.volume * FILM.outer_radius**2 * FILM.moduli[0]
    h = 1e-4

    def potential(x: float, e: float) -> float:
        one = cardinal(5, np.array([(x - 0.3) / 0.95]), cells[0])
        other = cardinal(5, np.array([e / span.loading]), cells[1])
        return float((one @ rows @ other.T)[0, 0])

    def force(height: float, voltage: float) -> float:
        x, e = height / FILM.outer_radius, group(FILM, voltage)
        terms = ((-2, 1.0), (-1, -8.0), (1, 8.0), (2, -1.0))
        slope = sum(w * potential(x + k * h, e) for k, w in terms) / (12 * h)
        return slope * scale / FILM.outer_radius

    return force


def shipped() -> Force:
    """The table and the plain-Python evaluation of the FMU, all derivatives included."""
    p = physics.Params(film=2.0, outer_radius=20e-3, layers=1.0)

    def force(height: float, voltage: float) -> float:
        return physics.cone(p, height, voltage * voltage).force

    return force


def direct(modes: int) -> Force:
    """Ritz's method from a neighbour, as inside a time loop."""
    seeds: list[Equilibrium] = [equilibrium(FILM, 15e-3, 0.0, modes)]

    def force(height: float, voltage: float) -> float:
        return equilibrium(FILM, height, voltage, modes, seeds[0]).force

    return force


def shooting(tolerance: float) -> Force:
    """The paper's way: equations 1 to 3 by LSODA, both rim conditions by Powell's hybrid method.

    Unknown are the constant R s1 sin(theta) and theta at the inner rim; the guess is the
    truncated cone's.
    """
    a, b = FILM.inner_radius, FILM.outer_radius
    cone = truncated_cone()

    def stresses(l1: float, l2: float, load: float) -> tuple[float, float, float]:
        s1, s2, slope = -load * l1 * l2 * l2, -load * l1 * l1 * l2, -load * l2 * l2
        for mu, alpha in zip(FILM.moduli, FILM.exponents, strict=True):
            p1, p2 = l1**alpha, l2**alpha
            p3 = 1.0 / (p1 * p2)
            s1 += mu * (p1 - p3) / l1
            s2 += mu * (p2 - p3) / l2
            slope += mu * ((alpha - 1.0) * p1 + (alpha + 1.0) * p3) / (l1 * l1)
        return s1, s2, slope

    def force(height: float, voltage: float) -> float:
        load = FILM.loading * voltage * voltage
        scale = FILM.moduli[0] * a

        def slope(flat: float, y: Any, integral: float) -> list[float]:
            sine = math.sin(y[2])
            wanted = integral / (flat * sine)
            l1, l2 = 1.3, y[0] / flat
            s2 = 0.0
            for _ in range(25):
                s1, s2, rate = stresses(l1, l2, load)
                change = (s1 - wanted) / rate
                l1 = min(max(l1 - change, 0.5), 6.0)
                if abs(change) < 1e-12:
                    break
            return [l1 * math.cos(y[2]), -l1 * sine, -s2 / (flat * wanted) * sine]

        def miss(guess: Any) -> list[float]:
            if not 0.05 < guess[1] < 1.56 or guess[0] <= 0.0:
                return [1.0, 1.0]
            solved = solve_ivp(
                slope, (a, b), [a, height, guess[1]], method="LSODA",
                rtol=tolerance, atol=tolerance * b, args=(guess[0] * scale,),
            )  # fmt: skip
            return [(solved.y[0, -1] - b) / b, solved.y[1, -1] / b]

        start = cone(height, 0.0) / (2.0 * math.pi * FILM.thickness * scale)
        found = root(miss, [start, 1.1], tol=10 * tolerance, options={"maxfev": 60})
        if not found.success:
            return math.nan
        return 2.0 * math.pi * FILM.thickness * float(found.x[0]) * scale

    return force


def measured(
    name: str, force: Force, points: list[tuple[float, float, float]], repeats: int
) -> tuple[str, float, float, float, int]:
    """Name, errors up to 1500 and 1920 V over F_max, microseconds per evaluation, failures."""
    largest = max(exact for _, _, exact in points)
    low, high, failed = 0.0, 0.0, 0
    best = math.inf
    for _ in range(repeats):
        begun = perf_counter()
        for height, voltage, exact in points:
            try:
                found = force(height, voltage)
            except (NoEquilibriumError, ValueError, ZeroDivisionError):
                found = math.nan
            if math.isnan(found):
                failed += 1
                continue
            error = abs(found - exact) / largest
            high = max(high, error)
            if voltage <= 1500.0:
                low = max(low, error)
        best = min(best, (perf_counter() - begun) / len(points))
    return name, low, high, 1e6 * best, failed // repeats


def main(
    output: Annotated[Path, typer.Option()] = Path("results/membrane-fidelities.png"),
    count: Annotated[int, typer.Option()] = 40,
) -> None:
    """Print the table and draw the plot."""
    rng = np.random.default_rng(11)
    points = []
    for _ in range(count):
        height, voltage = rng.uniform(8e-3, 22e-3), rng.uniform(0.0, 1920.0)
        points.append((height, voltage, equilibrium(FILM, height, voltage, 28).force))
    rows = [
        measured("linear spring", linear_spring(), points, 5),
        measured("truncated cone", truncated_cone(), points, 5),
        measured("surrogate 8 x 6", surrogate((8, 6), (10, 6)), points, 3),
        measured("surrogate 12 x 8", surrogate((12, 8), (16, 10)), points, 3),
        measured("surrogate 16 x 12", surrogate((16, 12), (24, 16)), points, 3),
        measured("surrogate in the FMU, 24 x 16", shipped(), points, 5),
        *(measured(f"direct, {n} modes", direct(n), points, 2) for n in (4, 8, 12, 16, 24)),
        *(
            measured(f"shooting, rtol {t:g}", shooting(t), points[: max(6, count // 5)], 1)
            for t in (1e-4, 1e-6, 1e-8)
        ),
    ]
    own = next(row[3] for row in rows if "FMU" in row[0])
    rows = [(n, low, high, own if "surrogate" in n else t, f) for n, low, high, t, f in rows]
    shown = Table("fidelity", "error, V <= 1500", "error, V <= 1920", "us per force", "failed")
    for name, low, high, spent, failed in rows:
        shown.add_row(name, f"{low:.1e}", f"{high:.1e}", f"{spent:.1f}", str(failed))
    Console(width=100).print(shown)
    spent = {name: time for name, _, _, time, _ in rows}
    Console().print(
        f"one direct solve (16 modes) costs {spent['direct, 16 modes'] / own:.0f} evaluations of"
        f" the FMU's surrogate, one shooting solve (1e-6) {spent['shooting, rtol 1e-06'] / own:.0f}"
    )
    draw(rows, output)


def draw(rows: list[tuple[str, float, float, float, int]], output: Path) -> None:
    """Log-log plot of error against time."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axis = pyplot.subplots(figsize=(8.0, 5.0))
    for name, low, high, spent, _ in rows:
        axis.loglog(spent, max(low, 1e-16), "o", color="tab:blue")
        axis.loglog(spent, max(high, 1e-16), "s", color="tab:orange")
        axis.annotate(name, (spent, max(high, 1e-16)), fontsize=7)
    axis.set_xlabel("Time per force (us)")
    axis.set_ylabel("Error over largest force (dots: to 1500 V, squares: to 1920 V)")
    axis.grid(visible=True, alpha=0.3)
    output.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(output, dpi=110)
    Console().print(f"plot: {output}")


if __name__ == "__main__":
    typer.run(main)
