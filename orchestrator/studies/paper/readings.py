"""How surely figure 11 tells the vehicle: readings beside each other, and what they share.

All of it is data of `scenarios/paper/`: readings and verdicts in `readings.toml`, the profile of
the fit in `profile.toml` as `resilin calibrate vehicle --profile --json` has it. No run is made.
"""

from __future__ import annotations

import math

from ...report.plot import Axis, Curve, Figure, Plot
from ...report.table import Cell, Column, Table, Tone, quantity
from .cached_runs import CachedRuns
from .comparison import Comparison
from .published_values import profile, readings

TITLE = "Beyond: how surely figure 11 tells the vehicle"
TONES: dict[str, Tone] = {
    "default": "green", "beside": "blue", "possible": "grey", "unlikely": "amber",
    "excluded": "red",
}  # fmt: skip


def vehicle_readings(cached_runs: CachedRuns) -> Comparison:
    """Table of readings, and the profile over the share of the film's force."""
    del cached_runs
    words = (
        "Five of the six numbers of figure 11 are met by all of these; the sixth, the stroke with"
        " full wings, hardly tells them apart. What the five fix is the force less the friction,"
        " about 0.08 N: the whole force of the film with a quarter of a newton of dry friction, or"
        " less of both. A stroke at 1 Hz would decide, or the travel of figure 13 in millimetres.",
    )
    return Comparison(*("readings", TITLE, words, (), [_drawn()]), extras=[_table()])


def _table() -> Table:
    columns = [
        Column("Reading"), Column("Verdict"), Column("Sixth number", number=True),
        Column("Stroke at 1 Hz", number=True), Column("Scenario"),
    ]  # fmt: skip
    rows = []
    for each in readings():
        sixth, low = each.get("sixth", math.nan), each.get("low", math.nan)
        rows.append(
            [
                Cell(each["name"], note=each["reason"]),
                Cell(each["verdict"], tone=TONES[each["verdict"]]),
                quantity(sixth, "" if math.isnan(sixth) else f"{100 * sixth:+.2g} %"),
                quantity(low, "" if math.isnan(low) else f"{low:g} deg"),
                Cell(each.get("scenario", "")),
            ]
        )
    return Table("What could drive the vehicle, and what could slow it", columns, rows)


def _drawn() -> Figure:
    known = profile()
    shares = known["shares"]
    parameters, data = known["parameters"], known["data"]

    def curve(name: str, values: list[float], scale: float = 1.0) -> Curve:
        return Curve(name, shares, [scale * value for value in values], "line-points")

    share = Axis(known["profile"], least=0.0, most=1.1)
    degrees = math.degrees(1.0)
    sixth = data["peak with full wings, stroke"]
    plots = [
        Plot("Friction that goes with it", share, Axis("dry friction (N)", least=0.0),
             [curve("dry friction", parameters["dry friction"])]),
        Plot("Friction on the load", share, Axis("coefficient", least=0.0),
             [curve("friction on the load", parameters["friction on the load"])]),
        Plot("The sixth number", share, Axis("stroke with full wings (deg)"),
             [curve("predicted", sixth, degrees)]),
        Plot("What would decide", share, Axis("stroke at 1 Hz (deg)", least=0.0),
             [curve("no wings", data["stroke at 1 Hz without wings"], degrees),
              curve("full wings", data["stroke at 1 Hz with full wings"], degrees)]),
    ]  # fmt: skip
    return Figure(
        "readings", "All met by five numbers",
        "The vehicle fitted again at each share of the film's Maxwell force.", plots,
    )  # fmt: skip
