"""SSP archives that are refused, each in a line that names the place."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import pytest

from orchestrator.cli import app
from orchestrator.errors import ScenarioError
from orchestrator.simulation.load import load
from tests.orchestrator.scenario.ssp.archives import (
    ALONE,
    FMU,
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
    "other root": ("<x/>", "is not a system structure"),
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
        "is a String, the FMU takes a Real",
    ),
    "infinite": (described(ALONE.replace("2.0", "INF")), "not a finite number"),
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
        "is not an output of its FMU",
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
    "parameter of no component": (
        described(two(real("won.mass", 1.0))), "does not belong to a component",
    ),
    "same name twice": (
        described(elements(2 * component("a", "resources/payload.fmu"))), "two elements are called",
    ),
    "same name once flat": (
        described(elements(component("a.b", "resources/payload.fmu")
                           + component("a_b", "resources/payload.fmu"))),
        "would both be called a_b",
    ),
    "scheduled execution": (
        described(ALONE.replace(FMU, f'{FMU} implementation="ScheduledExecution"')),
        "The value 'ScheduledExecution'",
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
        "is not JSON",
    ),
    "stop before start": (
        described(ALONE, tail='<ssd:DefaultExperiment startTime="2" stopTime="1"/>'),
        "is not after time.start",
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", sorted(BAD))
def test_what_cannot_be_taken_over_is_refused(
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
def test_files_that_are_not_archives(tmp_path: Path, content: bytes, message: str) -> None:
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
