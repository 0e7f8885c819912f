"""SSP archives of others as scenarios: structure, parameters, units, and what is refused."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from orchestrator.cli import app
from orchestrator.errors import ScenarioError
from orchestrator.results.outcome import Outcome
from orchestrator.scenario.ssp.names import NAMESPACES
from orchestrator.simulation.load import load
from orchestrator.simulation.run import run

runner = CliRunner()
SPACES = " ".join(f'xmlns:{prefix}="{name}"' for prefix, name in NAMESPACES.items())
FMU = 'type="application/x-fmu-sharedlibrary"'


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, so that nothing is left of a test."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "resilin" / "ssp"


def described(system: str, head: str = "", tail: str = "", version: str = "1.0") -> str:
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<ssd:SystemStructureDescription {SPACES}'
        f' version="{version}" name="of others"{head}>{system}{tail}'
        "</ssd:SystemStructureDescription>"
    )


def packed(path: Path, description: str | bytes, **files: bytes | Path) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", description)
        for name, content in files.items():
            entry = name.replace("__", ".").replace("resources_", "resources/")
            data = content.read_bytes() if isinstance(content, Path) else content
            archive.writestr(entry, data)
    return path


def real(name: str, value: float, unit: str = "") -> str:
    told = f' unit="{unit}"' if unit else ""
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value!r}"{told}/></ssv:Parameter>'


def bound(*parameters: str, mapping: str = "", more: str = "") -> str:
    inner = f'<ssv:ParameterSet version="1.0" name="x"><ssv:Parameters>{"".join(parameters)}'
    inner += "</ssv:Parameters></ssv:ParameterSet>"
    return (
        f"<ssd:ParameterBindings><ssd:ParameterBinding{more}><ssd:ParameterValues>{inner}"
        f"</ssd:ParameterValues>{mapping}</ssd:ParameterBinding></ssd:ParameterBindings>"
    )


def connectors(**kinds: str) -> str:
    made = "".join(
        f'<ssd:Connector name="{n.replace("__", ".")}" kind="{k}"><ssc:Real/></ssd:Connector>'
        for n, k in kinds.items()
    )
    return f"<ssd:Connectors>{made}</ssd:Connectors>"


def component(name: str, source: str, inside: str = "") -> str:
    return f'<ssd:Component name="{name}" {FMU} source="{source}">{inside}</ssd:Component>'


def joined(start: str, end: str, inside: str = "", more: str = "") -> str:
    ends = []
    for prefix, text in (("start", start), ("end", end)):
        owner, _, name = text.partition(":")
        owner_told = f'{prefix}Element="{owner}" ' if owner else ""
        ends.append(f'{owner_told}{prefix}Connector="{name}"')
    return f"<ssd:Connection {' '.join(ends)}{more}>{inside}</ssd:Connection>"


PUSH = component(
    "payload", "resources/payload.fmu",
    connectors(force__value="input", displacement="output")
    + bound(real("mass", 2.0, "g"), real("force.value", 3.0, "mN")),
)  # fmt: skip
ALONE = f'<ssd:System name="top"><ssd:Elements>{PUSH}</ssd:Elements></ssd:System>'
SPAN = '<ssd:DefaultExperiment startTime="0" stopTime="0.5"/>'


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


def elements(inside: str, connections: str = "", bindings: str = "") -> str:
    told = f"<ssd:Connections>{connections}</ssd:Connections>" if connections else ""
    return (
        f'<ssd:System name="top">{bindings}<ssd:Elements>{inside}</ssd:Elements>{told}</ssd:System>'
    )


def two(*parameters: str, connections: str = "") -> str:
    inner = [
        component(name, "resources/payload.fmu",
                  connectors(force__value="input", displacement="output"))
        for name in ("one", "other")
    ]  # fmt: skip
    return elements("".join(inner), connections, bound(*parameters) if parameters else "")


BAD = {
    "doctype": ("<!DOCTYPE x [<!ENTITY a 'b'>]><x/>", "DOCTYPE: refused"),
    "not xml": ("<x", "is not XML"),
    "other root": ("<x/>", "is no system structure"),
    "old version": (described(ALONE, version="0.9"), "'0.9' is not known here"),
    "schema": (described(ALONE.replace('kind="input"', 'kind="inputt"')), "line 2"),
    "no fmu": (described(ALONE.replace("payload.fmu", "payloat.fmu")), "did you mean"),
    "outside": (described(ALONE.replace("resources/", "../")), "is not in the archive"),
    "address": (described(ALONE.replace("resources/", "https://x.org/")), "not in the archive"),
    "no such parameter": (described(ALONE.replace('"mass"', '"mas"')), "did you mean 'mass'"),
    "unit of parameter": (
        described(ALONE.replace('unit="g"', 'unit="m"')), "m is not convertible to kg",
    ),
    "text for number": (
        described(ALONE.replace('<ssv:Real value="2.0" unit="g"/>', '<ssv:String value="x"/>')),
        "is a String, the FMU wants a Real",
    ),
    "infinite": (described(ALONE.replace("2.0", "INF")), "no finite number"),
    "no such connector": (
        described(two(connections=joined("one:displacemant", "other:force.value"))),
        "did you mean 'displacement'",
    ),
    "no such element": (
        described(two(connections=joined("won:displacement", "other:force.value"))),
        "nothing feeds won.displacement",
    ),
    "wrong way": (
        described(two(connections=joined("one:force.value", "other:force.value"))),
        "is no output of its FMU",
    ),
    "fed twice": (
        described(two(connections=2 * joined("one:displacement", "other:force.value"))),
        "is fed twice",
    ),
    "units differ": (
        described(two(connections=joined("one:displacement", "other:force.value"))),
        "m is not convertible to N",
    ),
    "units differ, not converted": (
        described(two(connections=joined("one:displacement", "other:force.value",
                                         more=' suppressUnitConversion="true"'))),
        "units of another kind",
    ),
    "boolean mapping": (
        described(two(connections=joined(
            "one:displacement", "other:force.value",
            '<ssc:BooleanMappingTransformation><ssc:MapEntry source="true" target="false"/>'
            "</ssc:BooleanMappingTransformation>"))),
        "only linear ones",
    ),
    "parameter of nobody": (described(two(real("won.mass", 1.0))), "is of no component"),
    "same name twice": (
        described(elements(2 * component("a", "resources/payload.fmu"))), "two elements are called",
    ),
    "same name once flat": (
        described(elements(component("a.b", "resources/payload.fmu")
                           + component("a_b", "resources/payload.fmu"))),
        "would both be called a_b",
    ),
    "model exchange": (
        described(ALONE.replace(FMU, f'{FMU} implementation="ModelExchange"')),
        "for ModelExchange only",
    ),
    "no fmu at all": (
        described(ALONE.replace("x-fmu-sharedlibrary", "x-python")), "is of type",
    ),
    "dictionary": (
        described(elements('<ssd:SignalDictionaryReference name="d" dictionary="d"/>')),
        "is not supported",
    ),
    "empty binding": (
        described(elements(component(
            "a", "resources/payload.fmu",
            "<ssd:ParameterBindings><ssd:ParameterBinding/></ssd:ParameterBindings>"))),
        "neither a source nor",
    ),
    "foreign set": (
        described(elements(component(
            "a", "resources/payload.fmu",
            bound(real("mass", 1.0), more=' type="text/csv"')))),
        "type text/csv is not known",
    ),
    "no system": (described(""), "line 2"),
    "annotation": (
        described(ALONE, tail='<ssd:Annotations><ssc:Annotation type="org.resilin.scenario">'
                  "<x>{</x></ssc:Annotation></ssd:Annotations>"),
        "is no JSON",
    ),
    "stop before start": (
        described(ALONE, tail='<ssd:DefaultExperiment startTime="2" stopTime="1"/>'),
        "is not after time.start",
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", sorted(BAD))
def test_what_cannot_be_taken_over_is_said(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    monkeypatch.chdir(tmp_path)
    description, message = BAD[fault]
    packed(Path("a.ssp"), description, resources_payload__fmu=library / "payload.fmu")
    done = runner.invoke(app, ["run", "a.ssp"])
    assert done.exit_code == 2, done.stdout
    assert re.search(re.escape(message), done.stderr), done.stderr
    assert all(line.startswith("resilin: a.ssp") for line in done.stderr.strip().splitlines())
    assert not Path("results").exists()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not a zip archive"),
        (b"PK nothing", "not a zip archive"),
    ],
)
def test_files_that_are_no_archives(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "a.ssp"
    path.write_bytes(content)
    with pytest.raises(ScenarioError, match=message):
        load(str(path))


def test_hostile_entries_are_refused_before_anything_is_written(
    tmp_path: Path, cache: Path
) -> None:
    path = tmp_path / "a.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", described(ALONE))
        archive.writestr("../out.txt", b"x")
    with pytest.raises(ScenarioError, match="leaves its folder"):
        load(str(path))
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("resources/a.fmu", b"x")
    with pytest.raises(ScenarioError, match=r"not an SSP: no SystemStructure\.ssd"):
        load(str(path))
    assert not cache.exists()


def test_a_cache_that_is_not_writable(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = packed(
        tmp_path / "a.ssp", described(ALONE), resources_payload__fmu=library / "payload.fmu"
    )
    (tmp_path / "file").write_text("x")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with pytest.raises(ScenarioError, match="set XDG_CACHE_HOME"):
        load(str(path))


def test_suppressed_conversion_keeps_the_number(tmp_path: Path, native: Path) -> None:
    """A column in mm feeds an input in m: converted, or as the number stands."""
    import build_fmus

    (tmp_path / "x.csv").write_text("time,motion.displacement [m]\n0,2\n1,2\n")
    recording = build_fmus.open_recorded(tmp_path / "x.csv", "x", {})
    fmu = build_fmus.build("replay", alias="x", recording=recording, into=tmp_path).path
    with zipfile.ZipFile(fmu) as archive:
        names = {n: archive.read(n) for n in archive.namelist()}
    text = names["modelDescription.xml"].decode()
    text = text.replace('<Unit name="m">', '<Unit name="mm">').replace('unit="m"', 'unit="mm"')
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
