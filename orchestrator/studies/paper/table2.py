"""Table 2: power at resonance, its ratio to two layers, per mass, and the amplifier's limit."""

from __future__ import annotations

from dataclasses import replace

from .cached_runs import Lab, Measured
from .comparison import Item, Row, row
from .frequency_sweep import Spectrum, doubt
from .layer_sweeps import DEFINITION, LAYERS, READINGS, payload_share, stacks
from .metrics import gross, net, power
from .published_values import given, number
from .sensitivity import sensitivities, told


def table2(lab: Lab) -> Item:
    """The peaks of figure 8's sweeps, in all readings of the power."""
    found = dict(zip(LAYERS, stacks(lab), strict=True))
    tops: dict[int, Measured] = {}
    for n, spectrum in found.items():
        peak = spectrum.peak(power)
        if peak is not None:
            top, share = doubt(lab, spectrum, peak, power), payload_share(lab, spectrum)
            tops[n] = Measured(share * top.value, share * top.doubt, top.wall_time)
    rows: list[Row] = []
    for n, top in tops.items():
        for reading, times in READINGS:
            each = Measured(times * top.value, times * top.doubt, top.wall_time)
            rows.append(row(f"table2.power_{n}", each, f"power-{n}", reading))
    rows += [_ratio(n, tops) for n in LAYERS[1:] if n in tops and LAYERS[0] in tops]
    for n, top in tops.items():
        mass = given("cones") * n * given("layer_mass")
        for reading, times in READINGS:
            each = Measured(times * top.value / mass, times * top.doubt / mass, top.wall_time)
            rows.append(row(f"table2.specific_{n}", each, f"power-{n}", reading))
    words = [DEFINITION, _rests_on(lab, found)]
    if LAYERS[-1] in tops:
        more, said = _limit(lab, found[LAYERS[-1]])
        rows += more
        words.append(said)
    failures = [text for spectrum in found.values() for text in spectrum.failures]
    return Item("table2", "Table 2: power at resonance", words, rows, (), failures)


def _rests_on(lab: Lab, found: dict[int, Spectrum]) -> str:
    """What two and four layers depend on, and that their ratio hardly depends on any of it."""
    jobs = []
    for n in LAYERS[:2]:
        spectrum = found[n]
        peak = spectrum.peak(power)
        at = peak.at if peak is not None else float(number("figure8.resonance").value)
        jobs.append(spectrum.sweep.job(spectrum.nearest(at)))
    two, four = sensitivities(lab, jobs, power)
    apart = {name: four[name] - two[name] for name in two}
    return (
        f"What the power of two layers at its peak rests on, for 1 % more of each: {told(two)}. The"
        f" ratio of four layers to two: {told(apart)}. Every layer is alike here, so nothing of the"
        " film takes that ratio from near 2 to the 1.37 measured; the paper itself suspects bad"
        " connections in that stack."
    )


def _ratio(n: int, tops: dict[int, Measured]) -> Row:
    one, other = tops[n], tops[LAYERS[0]]
    ratio = one.value / other.value
    wrong = ratio * (one.doubt / one.value + other.doubt / other.value)
    found = Measured(ratio, wrong, one.wall_time + other.wall_time)
    return row(f"table2.ratio_{n}", found, f"power-{n}")


def _limit(lab: Lab, spectrum: Spectrum) -> tuple[list[Row], str]:
    """What the amplifier gives at the largest stack's peak, and what a limit of it would cost."""
    peak = spectrum.peak(power)
    assert peak is not None
    near = spectrum.nearest(peak.at)
    job, scene = spectrum.sweep.job(near), spectrum.sweep.scene
    names = ("amplifier.*.voltage", "amplifier.top_current", "amplifier.bottom_current")
    electric = replace(job, record=names, keep=names, per_cycle=240)
    rows = [
        row("table2.limit", lab.measured(electric, gross), scene, "gross, nothing taken back"),
        row("table2.limit", lab.measured(job, net), scene, "net, charge taken back"),
    ]
    most = float(number("table2.limit").value)
    limited = {
        f"{watts:g} W for each channel": replace(
            job, changes={**job.changes, "amplifier.power_limit": f"{watts} W"}
        )
        for watts in (most, 0.5 * most)
    }
    free, *kept = lab.answers([job, *limited.values()])
    told = "; ".join(
        f"with {name}: {100 * (power(answer) / power(free) - 1):+.1f} % of mechanical power"
        if answer.status == "done"
        else f"with {name}: {answer.reason}"
        for name, answer in zip(limited, kept, strict=True)
    )
    return rows, (
        "The paper's amplifier gives 1 W at most; the scenes set no limit, and what they draw on"
        " the mean stays below it. Held at every instant, as a supply without a reservoir would,"
        " it costs"
        f" more: at {near:g} Hz and {LAYERS[-1]} layers, {told}."
    )
