"""An experiment: a film whose permittivity falls with the stretch of its area."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from ....report.plot import Axis, Curve, Figure, Plot, Style
from ....report.table import Cell, Column, Table, quantity
from ...calibration.fits import Fit, load_fits, shipped
from ...calibration.predictions import Model
from ..cached_runs import CachedRuns
from ..comparison import Comparison
from ..figure3 import FIRST, SILICONE
from ..frequency_sweep import FrequencySweep, Measure, Sweep, frequency_sweeps
from ..layer_sweeps import LAYERS, once, payload_share, stack
from ..metrics import amplitude, power
from ..published_values import given, number
from ..table1 import DEVICES, FILM, about

TITLE = "Beyond: permittivity that falls with stretch"
FIT = "material-falling"

Swept = dict[str, FrequencySweep]


def permittivity(cached_runs: CachedRuns) -> Comparison:
    """Tables 1 and 2 and figures 3 and 9 by the film as it is, and by one that falls."""
    (fit,) = load_fits(shipped(), [FIT])
    fitted = Model(fit, cached_runs.library).start
    constant = _swept(cached_runs, None, [])
    falling = _swept(cached_runs, fit, fitted)
    rows = _rows(cached_runs, constant, falling)
    failures = [t for each in (constant, falling) for s in each.values() for t in s.failures]
    told = ", ".join(
        f"{parameter.name} {parameter.value} for {now}"
        for parameter, now in zip(fit.parameters, _own(fit), strict=True)
    )
    words = (
        "The relative permittivity of a film is taken as eps (1 - k (l1 l2 - 1)), with l1 l2 the"
        " stretch of the area and k = 0.22; k = 0 is the film of the scenarios. Energy, force and"
        " charge still come from one potential. With k the other numbers were fitted again to the"
        f" same data: {told}.",
        "One parameter more mends most of table 1's displacements, figure 3 and figure 9, which the"
        " film as it is misses in both directions: the films of the oscillators that move far have"
        " less of a Maxwell stress at their largest stretch. It takes the power of four layers"
        " further away, and it wants a permittivity without stretch that no silicone of this kind"
        " has. Nothing was measured that says so: no scenario has it.",
    )
    columns = [
        Column("Quantity"), Column("Paper", number=True),
        Column("Constant", number=True), Column("Falling", number=True),
    ]  # fmt: skip
    table = Table("Relative errors, constant and falling permittivity", columns, rows)
    return Comparison(
        key="permittivity",
        title=TITLE,
        words=words,
        rows=(),
        figures=[_drawn(cached_runs, constant, falling)],
        failures=failures,
        extras=[table],
    )


def _swept(cached_runs: CachedRuns, fit: Fit | None, fitted: Sequence[float]) -> Swept:
    """All sweeps, by scenario, with the values of a fit; those of the other items without."""
    bench = [
        *(Sweep(FILM.scenario.format(k), about(k)) for k in DEVICES),
        Sweep("bench-silicone", SILICONE),
    ]
    powers = [stack(n) for n in LAYERS]
    if fit is not None:
        bench, powers = (
            [replace(s, changes=_changes(fit, fitted, s.scenario)) for s in each]
            for each in (bench, powers)
        )
    found = [
        *frequency_sweeps(cached_runs, bench, amplitude),
        *frequency_sweeps(cached_runs, powers, power),
    ]
    return {each.sweep.scenario: each for each in found}


def _changes(fit: Fit, fitted: Sequence[float], scenario: str) -> dict[str, str]:
    """What the fit gives a scenario: its film, and its parameters."""
    changes = {
        key: str(value)
        for datum in fit.data
        if datum.scenario == scenario
        for key, value in datum.set.items()
        if key.startswith("spring.")
    }
    for parameter, value in zip(fit.parameters, fitted, strict=True):
        changes[parameter.sets] = repr(value * parameter.times.get(scenario, 1.0))
    return changes


def _own(fit: Fit) -> list[str]:
    """The scenarios' own values of the fit's parameters, in its words."""
    (own,) = load_fits(shipped(), ["material"])
    known = {parameter.sets: f"{parameter.value}" for parameter in own.parameters}
    return [known[parameter.sets] for parameter in fit.parameters]


def _rows(cached_runs: CachedRuns, constant: Swept, falling: Swept) -> list[list[Cell]]:
    """Each number of the paper, and how far both are off."""
    made = []
    for k in DEVICES:
        scenario = FILM.scenario.format(k)
        pair = [_peak(each[scenario], amplitude) for each in (constant, falling)]
        made.append(_row(f"table 1, displacement {k}", f"table1.displacement_{k}", pair))
    made.append(_root_mean_square(made))
    low = [amplitude(each["bench-silicone"].answers[1.0]) for each in (constant, falling)]
    main = [_peak(each["bench-silicone"], amplitude, FIRST) for each in (constant, falling)]
    made.append(_row("figure 3, 1 Hz", "figure3.low", low))
    made.append(_row("figure 3, main peak", "figure3.main_amplitude", main))
    far = [_stroke(each["power-2"]) for each in (constant, falling)]
    made.append(_row("figure 9, stroke", "figure9.stroke", far))
    for n in LAYERS:
        pair = [
            payload_share(cached_runs, each[f"power-{n}"]) * _peak(each[f"power-{n}"], once)
            for each in (constant, falling)
        ]
        made.append(_row(f"table 2, power of {n} layers", f"table2.power_{n}", pair))
    return made


def _peak(found: FrequencySweep, measure: Measure, low: float = 0.0) -> float:
    peak = found.peak(measure, low=low)
    return math.nan if peak is None else peak.value


def _stroke(found: FrequencySweep) -> float:
    """Travel over the spacer's height at the frequency of largest power."""
    peak = found.peak(power)
    if peak is None:
        return math.nan
    return 2.0 * amplitude(found.answers[found.nearest(peak.at)]) / float(given("spacer"))


def _row(words: str, key: str, pair: Sequence[float]) -> list[Cell]:
    stated = number(key)
    value = float(stated.value)
    errors = [each / (value * stated.scale) - 1.0 for each in pair]
    cells = [quantity(error, f"{100.0 * error:+.1f} %") for error in errors]
    return [Cell(words), quantity(value, f"{value:g} {stated.unit}"), *cells]


def _root_mean_square(rows: Sequence[Sequence[Cell]]) -> list[Cell]:
    cells = []
    for column in (2, 3):
        errors = [float(row[column].sort or 0.0) for row in rows]
        rms = math.sqrt(sum(error * error for error in errors) / len(errors))
        cells.append(quantity(rms, f"{100.0 * rms:.1f} %"))
    return [Cell("table 1, displacements, root mean square"), Cell("-"), *cells]


def _drawn(cached_runs: CachedRuns, constant: Swept, falling: Swept) -> Figure:
    """Amplitudes of the oscillators and powers of the stacks, both ways, beside the paper's."""
    devices = [FILM.scenario.format(k) for k in DEVICES]
    ways: list[tuple[str, Swept, Style]] = [
        ("constant", constant, "dashed"),
        ("falling", falling, "line"),
    ]
    sizes = [
        Curve(f"{name}, {words}", each[name].frequencies,
              [1e3 * v for v in each[name].values(amplitude)], style)
        for words, each, style in ways
        for name in devices
    ]  # fmt: skip
    sizes.append(
        Curve(
            "paper",
            [float(number(f"table1.measured_{k}").value) for k in DEVICES],
            [float(number(f"table1.displacement_{k}").value) for k in DEVICES],
            "stated",
        )
    )
    powers = []
    for words, each, style in ways:
        for n in LAYERS:
            found = each[f"power-{n}"]
            scale = 1e3 * payload_share(cached_runs, found)
            values = [scale * v for v in found.values(once)]
            powers.append(Curve(f"{n} layers, {words}", found.frequencies, values, style))
    at = float(number("figure8.resonance").value)
    stated = [float(number(f"table2.power_{n}").value) for n in LAYERS]
    powers.append(Curve("paper", [at] * len(LAYERS), stated, "stated"))
    across = Axis("frequency (Hz)")
    return Figure(
        "permittivity",
        "Constant and falling permittivity",
        "Dashed with constant permittivity, drawn through with a falling one; points: the paper.",
        [
            Plot("Table 1", across, Axis("amplitude (mm)", least=0.0), sizes),
            Plot("Table 2", Axis("frequency (Hz)", least=20.0, most=70.0),
                 Axis("power, once a cycle (mW)", least=0.0), powers),
        ],
    )  # fmt: skip
