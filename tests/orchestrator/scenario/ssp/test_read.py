"""SSP archives of others as scenarios: structure, parameters, units."""

from __future__ import annotations

import os
import re
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from orchestrator.cli import app
from orchestrator.errors import ScenarioError
from orchestrator.results.outcome import Outcome
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run
from tests.foreign.rewritten import rewritten
from tests.foreign.scenarios import Shelf
from tests.orchestrator.scenario.ssp.archives import (
    ALONE,
    SPACES,
    SPAN,
    bound,
    component,
    connectors,
    described,
    elements,
    joined,
    packed,
    real,
    runner,
)


def test_a_component_with_parameters_and_an_input_that_nothing_feeds(
    library: Path, tmp_path: Path
) -> None:
    """Units of the set are converted; x = F t^2 / 2 m."""
    path = packed(
        tmp_path / "a.ssp", described(ALONE, tail=SPAN),
        resources_payload__fmu=library / "payload.fmu",
    )  # fmt: skip
    plan = load(str(path))
    assert plan.held["payload.force.value"] == pytest.approx(3e-3)
    assert plan.grid.step == pytest.approx(1e-4)
    outcome = run(plan)
    assert outcome.failure is None
    expected = 0.5 * 3e-3 / 2e-3 * outcome.times**2
    assert np.abs(outcome.series("payload.displacement") - expected).max() < 1e-12


@pytest.mark.parametrize("place", ["ssd", "ssv"])
def test_units_mean_what_the_archive_declares(place: str, library: Path, tmp_path: Path) -> None:
    """`lb` of 2 g and `Nm` of 1 mN are those of the archive, not those of their names."""
    made = "".join(
        f'<ssc:Unit name="{name}"><ssc:BaseUnit {base}/></ssc:Unit>'
        for name, base in (
            ("lb", 'kg="1" factor="0.002"'), ("Nm", 'kg="1" m="1" s="-2" factor="0.001"'),
        )
    )  # fmt: skip
    units = f"<{place}:Units>{made}</{place}:Units>"
    system = ALONE.replace('unit="g"', 'unit="lb"').replace('unit="mN"', 'unit="Nm"')
    if place == "ssv":
        system = system.replace("</ssv:Parameters>", f"</ssv:Parameters>{units}")
    tail = units + SPAN if place == "ssd" else SPAN
    path = packed(
        tmp_path / "a.ssp", described(system, tail=tail),
        resources_payload__fmu=library / "payload.fmu",
    )  # fmt: skip
    plan = load(str(path))
    assert plan.starts["payload"]["mass"] == pytest.approx(2.0 * 0.002)
    assert plan.held["payload.force.value"] == pytest.approx(3e-3)


NESTED = f"""
<ssd:System name="top">
 {connectors(moved="output")}
 {bound(real("bench.load.mass", 4.0, "g"))}
 <ssd:Elements>
  {component("drive", "resources/replay.fmu", connectors(top__voltage="output"))}
  <ssd:System name="bench">
   {connectors(pull="input", moved="output")}
   {bound(real("load.mass", 1.0, "kg"), real("load.gravity", 0.0))}
   <ssd:Elements>
    {
    component(
        "load",
        "resources/payload.fmu",
        connectors(force__value="input", displacement="output")
        + bound(real("mass", 7.0, "kg"), real("start_displacement", 1.0, "mm")),
    )
}
   </ssd:Elements>
   <ssd:Connections>
    {joined(":pull", "load:force.value", '<ssc:LinearTransformation factor="0.5" offset="1.0"/>')}
    {joined("load:displacement", ":moved")}
   </ssd:Connections>
  </ssd:System>
 </ssd:Elements>
 <ssd:Connections>
  {
    joined(
        "drive:top.voltage", "bench:pull", '<ssc:LinearTransformation factor="0.001" offset="2.0"/>'
    )
}
  {joined("bench:moved", ":moved")}
 </ssd:Connections>
</ssd:System>"""


def test_systems_in_systems_become_one(tmp_path: Path, native: Path) -> None:
    """Connections are traced through, their transformations composed; outer parameters override.

    A gain from volts to newtons is refused: units of another kind cannot be connected.
    """
    path = packed(
        tmp_path / "n.ssp", described(NESTED, tail=SPAN),
        resources_replay__fmu=native / "replay.fmu", resources_payload__fmu=native / "payload.fmu",
    )  # fmt: skip
    with pytest.raises(ScenarioError, match="V is not convertible to N"):
        load(str(path))
    twice = NESTED.replace("drive", "source").replace("resources/replay.fmu", "resources/push.fmu")
    twice = twice.replace("top.voltage", "force")
    (tmp_path / "push.csv").write_text("time,force [N]\n0,1000\n1,1000\n")
    import build_fmus

    recording = build_fmus.open_recorded(tmp_path / "push.csv", "push", {})
    push = build_fmus.build("replay", alias="push", recording=recording, into=tmp_path).path
    path = packed(
        tmp_path / "m.ssp", described(twice, tail=SPAN),
        resources_push__fmu=push, resources_payload__fmu=native / "payload.fmu",
    )  # fmt: skip
    plan = load(str(path))
    assert set(plan.interfaces) == {"source", "bench_load"}
    (wire,) = plan.connections
    assert (wire.gain, wire.offset) == (pytest.approx(0.5e-3), pytest.approx(2.0))
    assert plan.starts["bench_load"]["mass"] == pytest.approx(4e-3)
    assert plan.starts["bench_load"]["start_displacement"] == pytest.approx(1e-3)
    assert [f"{c}.{v.name}" for c, v in plan.records] == ["bench_load.displacement"]
    outcome = run(plan)
    expected = 1e-3 + 0.5 * 2.5 / 4e-3 * outcome.times**2
    assert outcome.series("bench_load.displacement") == pytest.approx(expected)


CONNECTED = f"""
<ssd:System name="top">
 {connectors(heavy="parameter", push="input")}
 {bound(real("heavy", 4.0), real("push", 6.0, "mN"), real("bench.start", 2.0))}
 <ssd:Elements>
  <ssd:System name="bench">
   {connectors(weight="parameter", pull="input", start="parameter", unused="parameter")}
   {bound(real("pull", 1.0, "N"), real("start", 9.0))}
   <ssd:Elements>
    {component("load", "resources/payload.fmu", connectors(force__value="input"))}
   </ssd:Elements>
   <ssd:Connections>
    {joined(":weight", "load:mass", '<ssc:LinearTransformation factor="0.5"/>')}
    {joined(":pull", "load:force.value")}
    {joined(":start", "load:start_displacement")}
    {joined(":unused", "load:gravity")}
   </ssd:Connections>
  </ssd:System>
 </ssd:Elements>
 <ssd:Connections>
  {joined(":heavy", "bench:weight")}
  {joined(":push", "bench:pull")}
 </ssd:Connections>
</ssd:System>""".replace(
    '<ssd:Connector name="heavy" kind="parameter"><ssc:Real/>',
    '<ssd:Connector name="heavy" kind="parameter"><ssc:Real unit="g"/>',
)


def test_values_of_a_systems_connectors_go_where_they_lead(
    library: Path, tmp_path: Path, cache: Path
) -> None:
    """Nested, scaled on the way, in the connector's unit; what feeds a connector comes first."""
    units = (
        '<ssd:Units><ssc:Unit name="g"><ssc:BaseUnit kg="1" factor="0.001"/></ssc:Unit></ssd:Units>'
    )
    path = packed(
        tmp_path / "c.ssp", described(CONNECTED, tail=units + SPAN),
        resources_payload__fmu=library / "payload.fmu",
        resources_other__ssv=f'''<?xml version="1.0"?><ssv:ParameterSet {SPACES} version="1.0"
            name="o"><ssv:Parameters>{real("push", 1.0, "mN")}{real("heavy", 8.0)}
            </ssv:Parameters></ssv:ParameterSet>'''.encode(),
    )  # fmt: skip
    plan = load(str(path))
    assert plan.starts["bench_load"]["mass"] == pytest.approx(0.5 * 4e-3)
    assert plan.starts["bench_load"]["start_displacement"] == pytest.approx(2.0)
    assert plan.held["bench_load.force.value"] == pytest.approx(6e-3)
    assert "gravity" not in plan.starts["bench_load"]
    other = load(f"{path}:other")
    assert other.held["bench_load.force.value"] == pytest.approx(1e-3)
    assert other.starts["bench_load"]["mass"] == pytest.approx(0.5 * 8e-3)
    wrong = CONNECTED.replace('name="heavy"><ssv', 'name="heave"><ssv')
    packed(path, described(wrong, tail=units + SPAN),
           resources_payload__fmu=library / "payload.fmu")  # fmt: skip
    with pytest.raises(ScenarioError, match="parameter 'heave' does not belong to a component"):
        load(str(path))


def test_a_parameter_set_in_a_file_with_a_mapping_and_a_prefix(
    library: Path, tmp_path: Path
) -> None:
    values = (
        f'<ssv:ParameterSet {SPACES} version="1.0" name="s"><ssv:Parameters>'
        f"{real('m', 3.0)}{real('unused', 1.0)}</ssv:Parameters></ssv:ParameterSet>"
    )
    mapping = (
        f'<ssm:ParameterMapping {SPACES} version="1.0"><ssm:MappingEntry source="m" target="mass">'
        '<ssc:LinearTransformation factor="0.001"/></ssm:MappingEntry></ssm:ParameterMapping>'
    )
    binding = (
        "<ssd:ParameterBindings>"
        '<ssd:ParameterBinding source="resources/s.ssv" prefix="payload.">'
        '<ssd:ParameterMapping source="resources/s.ssm"/></ssd:ParameterBinding>'
        "</ssd:ParameterBindings>"
    )
    inner = component("payload", "resources/payload.fmu", connectors(displacement="output"))
    system = f'<ssd:System name="top">{binding}<ssd:Elements>{inner}</ssd:Elements></ssd:System>'
    path = packed(
        tmp_path / "a.ssp", described(system), resources_payload__fmu=library / "payload.fmu",
        resources_s__ssv=values.encode(), resources_s__ssm=mapping.encode(),
    )  # fmt: skip
    plan = load(str(path))
    assert plan.starts["payload"] == {"mass": pytest.approx(3e-3)}
    assert plan.grid.stop == 1.0


def test_variants_and_parameter_sets_are_chosen_by_name(library: Path, tmp_path: Path) -> None:
    heavy = (
        f'<ssv:ParameterSet {SPACES} version="1.0" name="heavy"><ssv:Parameters>'
        f"{real('payload.mass', 9.0, 'g')}</ssv:Parameters></ssv:ParameterSet>"
    )
    other = described(ALONE.replace("2.0", "5.0"), tail=SPAN)
    path = packed(
        tmp_path / "a.ssp", described(ALONE, tail=SPAN), other__ssd=other.encode(),
        resources_heavy__ssv=heavy.encode(), resources_payload__fmu=library / "payload.fmu",
    )  # fmt: skip

    def mass(name: str) -> float:
        return float(load(f"{path}{name}").starts["payload"]["mass"])

    assert mass("") == pytest.approx(2e-3)
    assert mass(":heavy") == pytest.approx(9e-3)
    assert mass(":other") == pytest.approx(5e-3)
    with pytest.raises(ScenarioError, match=r"'heavi'; did you mean 'heavy'"):
        load(f"{path}:heavi")


def test_a_scenario_extends_an_archive(library: Path, tmp_path: Path) -> None:
    packed(
        tmp_path / "a.ssp", described(ALONE, tail=SPAN),
        resources_payload__fmu=library / "payload.fmu",
    )  # fmt: skip
    scenario = tmp_path / "mine.toml"
    scenario.write_text('extends = "a.ssp"\n[components.payload]\nstart = { mass = "6 g" }\n')
    plan = load(scenario)
    assert plan.starts["payload"]["mass"] == pytest.approx(6e-3)
    assert plan.held["payload.force.value"] == pytest.approx(3e-3)


def test_the_archive_is_unpacked_once(library: Path, tmp_path: Path, cache: Path) -> None:
    path = packed(
        tmp_path / "a.ssp", described(ALONE, tail=SPAN),
        resources_payload__fmu=library / "payload.fmu",
    )  # fmt: skip
    load(str(path))
    (folder,) = cache.iterdir()
    stamp = (folder / "resources" / "payload.fmu").stat().st_mtime_ns
    load(str(path))
    assert [folder] == list(cache.iterdir())
    assert (folder / "resources" / "payload.fmu").stat().st_mtime_ns == stamp


def test_what_nothing_has_read_for_a_month_is_removed(
    library: Path, tmp_path: Path, cache: Path
) -> None:
    """And what killed runs have left; an archive that is read now, or was yesterday, stays."""
    days = {"old": 31, "recent": 29, ".killed": 1, ".unpacking": 0}
    for name, age in days.items():
        (cache / name).mkdir(parents=True)
        os.utime(cache / name, times=(time.time() - 86400 * age,) * 2)
    path = packed(
        tmp_path / "a.ssp", described(ALONE, tail=SPAN),
        resources_payload__fmu=library / "payload.fmu",
    )  # fmt: skip
    load(str(path))
    left = {folder.name for folder in cache.iterdir()}
    assert left >= {"recent", ".unpacking"}
    assert not left & {"old", ".killed"}
    (own,) = left - {"recent", ".unpacking"}
    os.utime(cache / own, times=(1e9, 1e9))
    load(str(path))
    assert (cache / own).stat().st_mtime > 1.7e9


def test_commands_take_archives(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    packed(
        Path("a.ssp"), described(ALONE, tail=SPAN), resources_payload__fmu=library / "payload.fmu"
    )
    done = runner.invoke(app, ["run", "a.ssp", "--set", "payload.mass=8 g", "--json"])
    assert done.exit_code == 0, done.stderr
    assert Path("results/a.nc").is_file()
    assert runner.invoke(app, ["inspect", "a.ssp"]).exit_code == 0
    done = runner.invoke(app, ["run", "b.ssp"])
    assert done.exit_code == 2
    assert "b.ssp: no such SSP file" in done.stderr


def test_version_2_is_read_too(library: Path, tmp_path: Path) -> None:
    text = described(ALONE.replace("ssc:Real", "ssc:Float64"), tail=SPAN, version="2.0")
    path = packed(tmp_path / "a.ssp", text, resources_payload__fmu=library / "payload.fmu")
    assert load(str(path)).starts["payload"]["mass"] == pytest.approx(2e-3)


def test_suppressed_conversion_keeps_the_number(tmp_path: Path, native: Path) -> None:
    """A column in mm feeds an input in m: converted, or as the number stands."""
    import build_fmus

    (tmp_path / "x.csv").write_text("time,motion.displacement [m]\n0,2\n1,2\n")
    recording = build_fmus.open_recorded(tmp_path / "x.csv", "x", {})
    fmu = build_fmus.build("replay", alias="x", recording=recording, into=tmp_path).path
    with zipfile.ZipFile(fmu) as archive:
        names = {n: archive.read(n) for n in archive.namelist()}
    text = names["modelDescription.xml"].decode()
    unit = r'<Unit name="m">(\s*)<BaseUnit m="1"'
    text = re.sub(unit, r'<Unit name="mm">\1<BaseUnit m="1" factor="0.001"', text)
    text = text.replace('unit="m"', 'unit="mm"')
    with zipfile.ZipFile(tmp_path / "mm.fmu", "w") as archive:
        for name, data in names.items():
            archive.writestr(name, text if name == "modelDescription.xml" else data)
    gains = []
    for more in ("", ' suppressUnitConversion="true"'):
        inside = component("x", "resources/x.fmu") + component("s", "resources/s.fmu")
        wire = joined("x:motion.displacement", "s:motion.displacement", more=more)
        path = packed(
            tmp_path / "a.ssp", described(elements(inside, wire)),
            resources_x__fmu=tmp_path / "mm.fmu", resources_s__fmu=native / "spring.fmu",
        )  # fmt: skip
        (wired,) = load(str(path)).connections
        gains.append(wired.gain)
    assert gains == [pytest.approx(1e-3), pytest.approx(1.0)]


def test_another_tool_writes_and_ours_runs(native: Path, tmp_path: Path) -> None:
    """The vehicle's bench, written by pyssp-standard from our scenario's FMUs and wires."""
    written = by_pyssp(native, tmp_path)
    ours = run(load("oscillator-1", None, native, time={"stop": 0.2, "step": 2e-4}))
    plan = load(str(written), time={"step": 2e-4})
    assert plan.grid.stop == pytest.approx(0.2)
    theirs: Outcome = run(plan)
    assert theirs.failure is None
    name = "payload.displacement"
    x, y = ours.series(name), theirs.series(name)
    assert np.abs(x).max() > 5e-3
    assert np.abs(x - y).max() <= 1e-12 * np.abs(x).max()


def by_pyssp(native: Path, folder: Path) -> Path:
    from pyssp_standard.common_content_ssc import TypeReal
    from pyssp_standard.ssd import Component, Connection, Connector, DefaultExperiment, System
    from pyssp_standard.ssp import SSP
    from pyssp_standard.ssv import SSV

    plan = load("oscillator-1", None, native)
    target = folder / "theirs.ssp"
    with SSP(target, mode="w") as archive:
        for name in plan.interfaces:
            archive.add_resource(native / f"{name}.fmu")
        with archive.system_structure as ssd:
            ssd.name, ssd.version = "bench", "1.0"
            ssd.system = System(None, "bench")
            for name in plan.interfaces:
                part = Component()
                part.name, part.source = name, f"resources/{name}.fmu"
                part.component_type = "application/x-fmu-sharedlibrary"
                wired = {(c.output.name, "output") for c in plan.connections if c.source == name}
                wired |= {(c.input.name, "input") for c in plan.connections if c.target == name}
                for variable, kind in sorted(wired):
                    part.connectors.append(Connector(None, variable, kind, TypeReal(None)))
                ssd.system.elements.append(part)
            for c in plan.connections:
                ssd.add_connection(
                    Connection(
                        start_element=c.source, start_connector=c.output.name,
                        end_element=c.target, end_connector=c.input.name,
                    )
                )  # fmt: skip
            ssd.default_experiment = DefaultExperiment()
            ssd.default_experiment.start_time = 0.0
            ssd.default_experiment.stop_time = 0.2
        values = folder / "bench.ssv"
        with SSV(values, mode="w") as ssv:
            for name, starts in plan.starts.items():
                for key, value in starts.items():
                    known = plan.interfaces[name].variables[key]
                    if known.choices:
                        choice = known.choices[known.codes.index(int(value))]
                        ssv.add_parameter(f"{name}.{key}", "Enumeration", value=choice, name="w")
                    else:
                        ssv.add_parameter(f"{name}.{key}", value=value, unit=known.unit)
        archive.add_resource(values)
    renamed = folder / "bench.ssp"
    target.rename(renamed)
    return Path(f"{renamed}:bench")


UNITS = """<ssd:Units><ssc:Unit name="g"><ssc:BaseUnit kg="1" factor="0.001"/></ssc:Unit>
<ssc:Unit name="mm"><ssc:BaseUnit m="1" factor="0.001"/></ssc:Unit>
<ssc:Unit name="mN"><ssc:BaseUnit kg="1" m="1" s="-2" factor="0.001"/></ssc:Unit></ssd:Units>"""


def measured(**units: str) -> str:
    """Connectors of a component in units of their own."""
    kinds = {"displacement": "output", "y": "output", "mass": "parameter"}
    made = "".join(
        f'<ssd:Connector name="{n.replace("__", ".")}" kind="{kinds.get(n, "input")}">'
        f'<ssc:Real unit="{unit}"/></ssd:Connector>'
        for n, unit in units.items()
    )
    return f"<ssd:Connectors>{made}</ssd:Connectors>"


def test_values_are_in_the_unit_that_the_connector_declares(library: Path, tmp_path: Path) -> None:
    """2 at a connector in grams is 2 g; a value with a unit of its own is in that."""
    inside = measured(mass="g", force__value="mN")
    values = bound(real("mass", 2.0), real("force.value", 3.0, "N"))
    path = packed(
        tmp_path / "a.ssp",
        described(elements(component("p", "resources/p.fmu", inside + values)), tail=UNITS),
        resources_p__fmu=library / "payload.fmu",
    )
    plan = load(str(path))
    assert plan.starts["p"]["mass"] == pytest.approx(2e-3)
    assert plan.held["p.force.value"] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("leaving", "arriving", "more", "gain", "offset"),
    [
        ("mm", "m", "", 5.0, 7.0),
        ("m", "mm", "", 5.0, 7e-3),
        ("mm", "mm", "", 5.0, 7e-3),
        ("mm", "m", ' suppressUnitConversion="true"', 5000.0, 7.0),
        ("m", "mm", ' suppressUnitConversion="true"', 5e-3, 7e-3),
    ],
)
def test_a_connection_is_between_the_units_of_its_connectors(
    native: Path, tmp_path: Path, leaving: str, arriving: str, more: str, gain: float, offset: float
) -> None:
    """Both FMUs are in metres: what passes is 5 x + 7, the 7 in the unit of the target."""
    inside = component("p", "resources/p.fmu", measured(displacement=leaving))
    inside += component("s", "resources/s.fmu", measured(motion__displacement=arriving))
    scaled = '<ssc:LinearTransformation factor="5" offset="7"/>'
    wire = joined("p:displacement", "s:motion.displacement", scaled, more)
    path = packed(
        tmp_path / "a.ssp", described(elements(inside, wire), tail=UNITS),
        resources_p__fmu=native / "payload.fmu", resources_s__fmu=native / "spring.fmu",
    )  # fmt: skip
    (wired,) = load(str(path)).connections
    assert (wired.gain, wired.offset) == (pytest.approx(gain), pytest.approx(offset))


@pytest.mark.parametrize(("leaving", "gain"), [("mm", 1e-3), ("m", 1.0)])
def test_a_connector_gives_an_fmu_without_units_its_unit(
    native: Path, tmp_path: Path, shelf: Shelf, leaving: str, gain: float
) -> None:
    """The FMU gives a bare number, which its connector says is in millimetres."""
    bare = rewritten(shelf("GAIN", 2), tmp_path / "bare.fmu", (' unit="1"', ""))
    inside = component("g", "resources/g.fmu", measured(y=leaving))
    inside += component("s", "resources/s.fmu", measured(motion__displacement="m"))
    path = packed(
        tmp_path / "a.ssp",
        described(elements(inside, joined("g:y", "s:motion.displacement")), tail=UNITS),
        resources_g__fmu=bare, resources_s__fmu=native / "spring.fmu",
    )  # fmt: skip
    (wired,) = load(str(path)).connections
    assert wired.gain == pytest.approx(gain)


def test_a_connector_in_a_unit_of_another_kind_is_refused(library: Path, tmp_path: Path) -> None:
    inside = component("p", "resources/p.fmu", measured(mass="mN") + bound(real("mass", 2.0)))
    path = packed(
        tmp_path / "a.ssp", described(elements(inside), tail=UNITS),
        resources_p__fmu=library / "payload.fmu",
    )  # fmt: skip
    with pytest.raises(ScenarioError, match=r"parameter p\.mass: .*mN.* is not convertible to kg"):
        load(str(path))
