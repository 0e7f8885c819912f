"""What hovering would take: equation 6 turned round, by runs over drive, layers and wings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ....report.plot import Axis, Curve, Figure, Plot
from ....report.table import Column, Table, quantity
from ....scenario.plan import Plan
from ..cached_runs import CachedRuns
from ..comparison import Comparison
from ..equation6 import GRAVITY, mass
from ..frequency_sweep import FrequencySweep, Sweep, frequency_sweeps
from ..job import Job, plan_of, start_of
from ..metrics import lift, net, stroke
from ..published_values import given

PROTOTYPE = "flapping-full-wings"
TITLE = "Beyond: what hovering would take"
LAYERS = (8, 16, 32, 64)
LENGTHS = (40.0e-3, 60.0e-3, 80.0e-3)
SHARES = (0.55, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25)

FILM = 25.35e-6
"""What each more layer adds that moves [kg]: half of what `power-2` has for two."""

ADDED = 6.4e-9
"""Inertia of the air that wings of 40 mm move [kg m^2]: for the first guess of a frequency."""

STOPS = math.radians(118.0)
"""Stroke between the stops [rad]."""

LEVER = 425.0
"""Flap angle over displacement at rest [rad/m]."""

KEPT = ("amplifier.supplied_energy",)


@dataclass(frozen=True)
class Case:
    """Voltage [V], and how much of the linkage's dry friction is left."""

    voltage: float
    friction: float

    @property
    def words(self) -> str:
        """For a legend."""
        return f"{self.voltage:g} V{'' if self.friction else ', no dry friction'}"


CASES = (Case(1380.0, 1.0), Case(1920.0, 1.0), Case(1920.0, 0.0))


@dataclass(frozen=True)
class Vehicle:
    """One of those swept: its case, layers of a cone, length of a wing [m]."""

    case: Case
    layers: int
    length: float

    @property
    def actuator(self) -> float:
        """Mass of both cones, by the paper's 0.12 g of a layer [kg]."""
        return float(given("cones")) * self.layers * float(given("layer_mass"))

    def sweep(self, prototype: Plan) -> Sweep:
        """Frequencies about the resonance that a linear spring for each layer would have."""
        wings = (self.length / LENGTHS[0]) ** 4
        slider = start_of(prototype, "linkage.slider_mass") + FILM * (self.layers - LAYERS[0])
        own = start_of(prototype, "linkage.wing_inertia")
        lighter = _moving(slider, wings * own, wings) / _moving(
            start_of(prototype, "linkage.slider_mass"), own, 1.0
        )
        middle = start_of(prototype, "amplifier.frequency") * math.sqrt(
            self.layers / LAYERS[0] / lighter
        )
        friction = self.case.friction * start_of(prototype, "linkage.coulomb_friction")
        changes = {
            "amplifier.amplitude": self.case.voltage,
            "actuator.layers": float(self.layers),
            "linkage.slider_mass": slider,
            "linkage.coulomb_friction": friction,
            "linkage.wing_inertia": wings * own,
            "aero.wing_length": self.length,
        }
        places = [round(share * middle, 3) for share in SHARES]
        parameters = {key: repr(value) for key, value in changes.items()}
        return Sweep("hovering", places, parameters, keep=KEPT, settle=1.2, cycles=5)


def _moving(slider: float, inertia: float, wings: float) -> float:
    """All that moves, seen at the slider [kg]; the air's inertia is `wings` times that of 40 mm."""
    return slider + (inertia + wings * ADDED) * LEVER**2


@dataclass(frozen=True)
class Found:
    """Where the lift of one is largest."""

    vehicle: Vehicle
    frequency: float
    lift: float
    stroke: float
    power: float

    @property
    def share(self) -> float:
        """Lift over the weight of the actuator alone."""
        return self.lift / (GRAVITY * self.vehicle.actuator)

    @property
    def equation(self) -> float:
        """Mass that equation 6 gives for this stroke and frequency with C_L = 2 [kg]."""
        ratio = float(given("aspect_ratio"))
        return mass(2.0, self.stroke, self.frequency, self.vehicle.length, ratio)

    @property
    def asked(self) -> float:
        """Frequency at which equation 6 lifts the cones, at the stops and with C_L = 2 [Hz]."""
        ratio = float(given("aspect_ratio"))
        each = mass(2.0, STOPS, 1.0, self.vehicle.length, ratio)
        return math.sqrt(self.vehicle.actuator / each)


def hovering(cached_runs: CachedRuns) -> Comparison:
    """Sweeps of all vehicles at once; the largest lift of each."""
    every = [Vehicle(c, n, r) for r in LENGTHS for n in LAYERS for c in CASES]
    prototype = plan_of(Job(PROTOTYPE), cached_runs.library)
    swept = frequency_sweeps(cached_runs, [vehicle.sweep(prototype) for vehicle in every], lift)
    found = [f for v, s in zip(every, swept, strict=True) if (f := _best(v, s)) is not None]
    failures = [text for frequency_sweep in swept for text in frequency_sweep.failures]
    rubbing = [f for f in found if f.vehicle.case.friction]
    free = [f for f in found if not f.vehicle.case.friction]
    if not rubbing or not free:
        return Comparison("hovering", TITLE, (), (), (), failures)
    best, most = (max(each, key=lambda f: f.share) for each in (rubbing, free))
    words = (
        "The vehicle of figure 11 on its film, with more layers, longer wings, less voltage, and"
        " without dry friction: the wings' inertia to the fourth power of their length, 25.35 mg"
        " for each layer that the slider moves, the mechanism as it is. The lift is that of the"
        " assumed quasi-steady coefficients at the frequency where it is largest. It is held"
        " against the weight of the two cones alone, 0.12 g a layer as the paper has it: frame,"
        " gear, amplifier and battery come on top.",
        f"With the mechanism's friction the best of these lifts {100 * best.share:.0f} % of its own"
        f" cones: {_said(best)}. Without dry friction {100 * most.share:.0f} %: {_said(most)}. The"
        " prototype's friction takes most of the force of eight layers and less of the force of"
        " sixteen, which is why the first doubling helps so much; from there on the stops limit the"
        " stroke.",
        "Equation 6 turned round: at the stops' 118 degrees and with C_L = 2 the cones alone ask"
        " for the frequency in the table's last column but one. More layers do not close the gap,"
        " as force, stiffness and weight grow together. Longer wings do not either: the frequency"
        " falls with the square of their length. Nor do thinner films or a higher permittivity by"
        " themselves: a film pulls in at a given eps V^2/(mu T^2), so its largest force for a given"
        " weight goes with its modulus alone. The feathering is that assumed for wings of 40 mm;"
        " long and slow ones would need it softer.",
    )
    return Comparison(
        key="hovering",
        title=TITLE,
        words=words,
        rows=(),
        figures=[_drawn(found)],
        failures=failures,
        extras=[_table(found)],
    )


def _best(vehicle: Vehicle, frequency_sweep: FrequencySweep) -> Found | None:
    peak = frequency_sweep.peak(lift)
    if peak is None:
        return None
    answer = frequency_sweep.answers[frequency_sweep.nearest(peak.at)]
    return Found(vehicle, peak.at, peak.value, stroke(answer), net(answer))


def _said(found: Found) -> str:
    v = found.vehicle
    return (
        f"{v.case.voltage:g} V, {v.layers} layers, wings of {1e3 * v.length:g} mm,"
        f" {math.degrees(found.stroke):.0f} degrees at {found.frequency:.1f} Hz"
    )


def _drawn(found: Sequence[Found]) -> Figure:
    plots = []
    for length in LENGTHS:
        curves = []
        for case in CASES:
            mine = [f for f in found if (f.vehicle.length, f.vehicle.case) == (length, case)]
            layers = [float(f.vehicle.layers) for f in mine]
            shares = [100 * f.share for f in mine]
            curves.append(Curve(case.words, layers, shares, "line-points"))
        title = f"Wings of {1e3 * length:g} mm"
        axes = (Axis("layers of a cone", log=True), Axis("lift over weight of the cones (%)"))
        plots.append(Plot(title, *axes, curves))
    return Figure(
        "hovering", "Lift over the weight of the actuator",
        "At the frequency of largest lift; 100 % would carry the cones and nothing else.", plots,
    )  # fmt: skip


def _table(found: Sequence[Found]) -> Table:
    columns = [
        Column("Wing", number=True), Column("Layers", number=True), Column("Drive", number=True),
        Column("Dry friction", number=True),
        Column("Frequency", number=True), Column("Stroke", number=True),
        Column("Lift", number=True), Column("Equation 6, C_L = 2", number=True),
        Column("Cones", number=True), Column("Lift over cones", number=True),
        Column("Frequency asked for", number=True), Column("Electrical power", number=True),
    ]  # fmt: skip
    rows = [
        [
            quantity(f.vehicle.length, f"{1e3 * f.vehicle.length:g} mm"),
            quantity(f.vehicle.layers, f"{f.vehicle.layers}"),
            quantity(f.vehicle.case.voltage, f"{f.vehicle.case.voltage:g} V"),
            quantity(f.vehicle.case.friction, "as fitted" if f.vehicle.case.friction else "none"),
            quantity(f.frequency, f"{f.frequency:.1f} Hz"),
            quantity(f.stroke, f"{math.degrees(f.stroke):.0f} deg"),
            quantity(f.lift, f"{1e6 * f.lift / GRAVITY:.0f} mg"),
            quantity(f.equation, f"{1e6 * f.equation:.0f} mg"),
            quantity(f.vehicle.actuator, f"{1e3 * f.vehicle.actuator:.2f} g"),
            quantity(f.share, f"{100 * f.share:.1f} %"),
            quantity(f.asked, f"{f.asked:.0f} Hz"),
            quantity(f.power, f"{1e3 * f.power:.0f} mW"),
        ]
        for f in found
    ]
    return Table("Largest lift of each; scenario hovering", columns, rows)
