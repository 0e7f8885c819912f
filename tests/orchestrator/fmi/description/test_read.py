"""What a model description may not do to its reader, and what is read of it."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from orchestrator.errors import FmuError
from orchestrator.fmi.archive import DESCRIPTION, read_description
from orchestrator.fmi.description import read_interface
from tests.foreign.build import foreign

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
MASS = 'name="mass" valueReference="8"'
MASS_REAL = '<Real unit="kg" min="1e-09" start="0.000603"/>'
LAUGHS = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10 if k else "ha" * 10}">' for k in range(9))


@pytest.fixture(scope="session")
def description(python_parts: Path) -> str:
    """The model description of a real FMU."""
    return read_description(python_parts / "payload.fmu").decode()


def fmu(folder: Path, text: str | bytes) -> Path:
    """An archive with nothing but a model description."""
    path = folder / "bad.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(DESCRIPTION, text)
    return path


def replaced(text: str, old: str, new: str) -> str:
    """Text with one replacement of what must be in it."""
    assert old in text
    return text.replace(old, new, 1)


def refused(folder: Path, text: str | bytes) -> str:
    """The message that refuses a description."""
    path = fmu(folder, text)
    with pytest.raises(FmuError) as caught:
        read_interface(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert message.isprintable()
    assert len(message) < 1500
    return message


def test_real_description_is_read(library: Path) -> None:
    interface = read_interface(library / "payload.fmu")
    mass = interface.variables["mass"]
    assert (mass.unit, mass.start, mass.least, mass.causality) == ("kg", 6.03e-4, 1e-9, "parameter")
    assert [v.member for v in interface.port("force", "input")][:2] == ["value", "stiffness"]
    assert interface.warnings == ()


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
def test_encoding_is_read(encoding: str, description: str, tmp_path: Path) -> None:
    declared = encoding.removesuffix("-sig").removesuffix("-le").removesuffix("-be")
    text = replaced(description, "UTF-8", declared.upper().replace("LATIN-1", "ISO-8859-1"))
    text = replaced(text, "Mass on the spacer", "Mässe")
    assert "mass" in read_interface(fmu(tmp_path, text.encode(encoding))).variables


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-32", "utf-32-be", "utf-7", "hidden"])
@pytest.mark.parametrize(
    "subset",
    [
        "",
        '[<!ENTITY f SYSTEM "file:///etc/passwd">]',
        '[<!ENTITY f SYSTEM "http://127.0.0.1:9/x">]',
        'SYSTEM "http://127.0.0.1:9/x.dtd"',
        '[<!ENTITY % p SYSTEM "file:///etc/passwd"> %p;]',
        f"[{LAUGHS}]",
    ],
    ids=["bare", "file", "url", "external", "parameter", "laughs"],
)
def test_doctype_is_refused_in_any_encoding(
    subset: str, encoding: str, description: str, tmp_path: Path
) -> None:
    coding = "utf-7" if encoding == "hidden" else encoding
    text = replaced(description, "UTF-8", coding.removesuffix("-be").upper())
    text = replaced(text, "?>", f"?>\n<!DOCTYPE fmiModelDescription {subset}>")
    if "l8" in subset:
        text = replaced(text, "Mass on the spacer", "&l8;")
    data = text.encode(coding)
    if encoding == "hidden":
        data = data.replace(b"<!", b"+ADwAIQ-")
    message = refused(tmp_path, data)
    assert "DOCTYPE" in message or ("l8" in subset and "amplification" in message)


def test_undeclared_entity_is_refused(description: str, tmp_path: Path) -> None:
    text = replaced(description, "Mass on the spacer", "&boom;")
    assert "boom" in refused(tmp_path, text)


@pytest.mark.parametrize("depth", [65, 255, 100_000])
def test_deep_nesting_is_refused(depth: int, description: str, tmp_path: Path) -> None:
    nest = "<a>" * depth + "</a>" * depth
    text = replaced(
        description, "<ModelStructure>", f"<VendorAnnotations>{nest}</VendorAnnotations>"
    )
    refused(tmp_path, text)
    assert "nested" in refused(tmp_path, nest) or depth > 255


@pytest.mark.slow
def test_100000_variables_are_read(description: str, tmp_path: Path) -> None:
    scalar = (
        '<ScalarVariable name="p{0}" valueReference="{1}" causality="parameter"'
        ' variability="fixed" initial="exact"><Real unit="kg" start="1.0"/></ScalarVariable>'
    )
    scalars = "\n".join(scalar.format(k, k + 100) for k in range(100_000))
    path = fmu(tmp_path, replaced(description, "</ModelVariables>", f"{scalars}</ModelVariables>"))
    interface = read_interface(path)
    assert len(interface.variables) == 100_021
    assert interface.variables["p99999"].start == 1.0


def test_what_would_take_a_gigabyte_is_refused_at_once(description: str, tmp_path: Path) -> None:
    many = '<Unknown index="1"/>' * 400_001
    text = replaced(description, "</ModelVariables>", f"</ModelVariables>{many}")
    assert "elements; at most 400000 are read" in refused(tmp_path, text)
    long = replaced(description, "</ModelVariables>", f"{' ' * 2**25}</ModelVariables>")
    with pytest.raises(FmuError, match="at most 32 MiB are read"):
        read_interface(fmu(tmp_path, long))


def test_30000_bad_variables_are_refused(description: str, tmp_path: Path) -> None:
    scalar = '<ScalarVariable name="x" valueReference="y"><Real start="z"/></ScalarVariable>'
    scalars = scalar * 30_000
    path = fmu(tmp_path, replaced(description, "</ModelVariables>", f"{scalars}</ModelVariables>"))
    with pytest.raises(FmuError, match="valueReference"):
        read_interface(path)


@pytest.mark.parametrize(
    "identifier",
    [
        "../payload",
        "a/b",
        "a\\b",
        "/bin/sh",
        "C:x",
        "",
        "a" * 300,
        "a&#10;",
    ],
)
def test_identifier_with_a_path_is_refused(
    identifier: str, description: str, tmp_path: Path
) -> None:
    text = replaced(description, 'modelIdentifier="payload"', f'modelIdentifier="{identifier}"')
    assert "modelIdentifier" in refused(tmp_path, text)


@pytest.mark.parametrize(
    ("version", "reason"),
    [
        ("", "no fmiVersion"),
        ('fmiVersion=""', "not supported"),
        ('fmiVersion="1.0"', "'1.0' is not supported; use FMI 2.0, 3.0"),
        ('fmiVersion="3.0-beta"', "'3.0-beta' is not supported; use FMI 2.0, 3.0"),
        ('fmiVersion="2.0&#x202e;"', "not supported"),
        ('fmiVersion="latest"', "'latest' is not supported"),
    ],
)
def test_version_is_refused(version: str, reason: str, description: str, tmp_path: Path) -> None:
    assert reason in refused(tmp_path, replaced(description, 'fmiVersion="2.0"', version))


def test_what_an_fmu_is_for_is_read(description: str, tmp_path: Path) -> None:
    """For both it is taken for co-simulation; for neither it is refused."""
    text = replaced(description, "CoSimulation ", "ModelExchange ")
    assert read_interface(fmu(tmp_path, text)).model_exchange
    both = replaced(
        description, "<CoSimulation ", '<ModelExchange modelIdentifier="a"/><CoSimulation '
    )
    assert not read_interface(fmu(tmp_path, both)).model_exchange
    neither = replaced(description, "CoSimulation ", "ScheduledExecution ")
    assert "neither for co-simulation nor for model exchange" in refused(tmp_path, neither)


@pytest.mark.parametrize(
    ("old", "new", "reasons"),
    [
        (MASS, 'name="gravity" valueReference="8"', ["'gravity' is duplicated", "line "]),
        (MASS, 'name="" valueReference="8"', ["empty or unprintable name", "line "]),
        (MASS, 'valueReference="8"', ["name", "line "]),
        (MASS, 'name="m\u202ess" valueReference="8"', ["'m\\u202ess'", "unprintable name"]),
        (MASS, 'name="m\u2066ss" valueReference="8"', ["'m\\u2066ss'", "unprintable name"]),
        (MASS, 'name="m&#10;s" valueReference="8"', ["'m\\x0as'", "unprintable name"]),
        (MASS, 'name="m\u200bs" valueReference="8"', ["'m\\u200bs'", "unprintable name"]),
        (MASS, 'name="mass"', ["valueReference", "line "]),
        (MASS, 'name="mass" valueReference="-1"', ["-1", "line "]),
        (MASS, 'name="mass" valueReference="99999999999"', ["99999999999", "line "]),
        ('causality="parameter"', 'causality="boss"', ["'boss'", "line "]),
        ('variability="fixed"', 'variability="sometimes"', ["'sometimes'", "line "]),
        ('name="force" order="0"', 'name="force" order="first"', ["order", "line "]),
        ('name="force" order="0"', f'name="force" order="{"1" * 5000}"', ["order"]),
        ('name="force" order="0"', 'order="0"', ["port", "line "]),
        ("<ModelVariables>", "<ModelVariables><Other/>", ["Other", "line "]),
        ("</ModelStructure>", "", ["not XML"]),
        ('guid="', 'guid2="', ["guid", "line "]),
    ],
)
def test_fault_is_named_with_its_line(
    old: str, new: str, reasons: list[str], description: str, tmp_path: Path
) -> None:
    message = refused(tmp_path, replaced(description, old, new))
    assert all(reason in message for reason in reasons), message


@pytest.mark.parametrize(
    ("real", "reason"),
    [
        ('<Real unit="kg" start="NaN"/>', "start NaN, which is not finite"),
        ('<Real unit="kg" start="INF"/>', "start INF, which is not finite"),
        ('<Real unit="kg" start="1e400"/>', "start 1e400, which is not finite"),
        ('<Real unit="kg" start=""/>', "''"),
        ('<Real unit="kg" start="heavy"/>', "'heavy'"),
        ('<Real unit="kg" start="0x10"/>', "'0x10'"),
        ('<Real unit="kg" start="1,5"/>', "'1,5'"),
        ('<Real unit="\u202egk" start="1"/>', "unit '\\u202egk', which is unprintable"),
        ('<Integer start="1.5"/>', "1.5"),
        ('<Integer start="99999999999999999999"/>', "99999999999999999999"),
        ('<Boolean start="maybe"/>', "maybe"),
        ('<Enumeration start="1"/>', "declaredType"),
        ('<Real unit="kg" start="1"/><Real unit="kg" start="1"/>', "Real"),
        ("", "ScalarVariable"),
    ],
)
def test_bad_number_or_unit_is_named(
    real: str, reason: str, description: str, tmp_path: Path
) -> None:
    message = refused(tmp_path, replaced(description, MASS_REAL, real))
    assert reason in message
    assert "line " in message


def test_all_faults_are_counted(description: str, tmp_path: Path) -> None:
    text = replaced(description, 'name="gravity"', 'name=""')
    text = replaced(text, 'start="0.000603"', 'start="NaN"')
    assert "(and 1 more; resilin check lists all)" in refused(tmp_path, text)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        *(
            ('<Unknown index="14"', f'<Unknown index="{index}"', "ModelStructure")
            for index in ("99", "0", "-1", "\u00b2", "\u202e", "", "9" * 5000)
        ),
        ('<Unknown index="14"', "<Unknown", "ModelStructure"),
        ('dependencies=""', 'dependencies="1 99"', "ModelStructure"),
        ('dependencies=""', 'dependencies="x"', "ModelStructure"),
        ("<Tool name=", "<Tool nom=", "nom"),
        (MASS_REAL, '<Real unit="kg" min="2" max="1" start="1"/>', "min above max"),
        (MASS_REAL, '<Real unit="kg" min="NaN" start="1"/>', "min 'NaN', which is not finite"),
        (MASS_REAL, '<Real unit="kg" max="1e999" start="1"/>', "max '1e999', which is not finite"),
        (MASS_REAL, '<Real unit="stone" start="1"/>', "unit 'stone', which is not defined"),
        (MASS_REAL, '<Real declaredType="Nowhere" start="1"/>', "'Nowhere', which is not defined"),
    ],
)
def test_what_changes_no_number_is_a_warning_with_its_line(
    old: str, new: str, reason: str, description: str, tmp_path: Path
) -> None:
    interface = read_interface(fmu(tmp_path, replaced(description, old, new)))
    (found, *_) = [warning for warning in interface.warnings if reason in warning]
    assert found.startswith("line ")
    assert all(warning.isprintable() for warning in interface.warnings)
    assert interface.variables["mass"].start is not None
    assert interface.variables["mass"].least in {None, 1e-9}


def test_findings_of_one_kind_are_counted(description: str, tmp_path: Path) -> None:
    text = description.replace('unit="m"', 'unit="stone"')
    (warning,) = read_interface(fmu(tmp_path, text)).warnings
    assert "unit 'stone'" in warning
    assert "more like it)" in warning


def test_two_parameters_under_one_reference_are_a_warning(description: str, tmp_path: Path) -> None:
    twin = (
        '<ScalarVariable name="twin" valueReference="8" causality="parameter" variability="fixed">'
        '<Real start="1"/></ScalarVariable>'
    )
    text = replaced(description, "</ModelVariables>", f"{twin}</ModelVariables>")
    (warning,) = read_interface(fmu(tmp_path, text)).warnings
    assert "variable 'twin' is set with variable 'mass'" in warning
    assert warning.startswith("line ")


def test_an_alias_that_nobody_sets_is_none(description: str, tmp_path: Path) -> None:
    text = replaced(
        description, 'name="velocity" valueReference="17"', 'name="velocity" valueReference="14"'
    )
    assert read_interface(fmu(tmp_path, text)).warnings == ()


def test_same_reference_of_another_type_is_not_an_alias(description: str, tmp_path: Path) -> None:
    extra = (
        '<ScalarVariable name="count" valueReference="8" causality="parameter"'
        ' variability="fixed" initial="exact"><Integer start="1"/></ScalarVariable>'
    )
    text = replaced(description, "</ModelVariables>", f"{extra}</ModelVariables>")
    assert read_interface(fmu(tmp_path, text)).warnings == ()


def test_bounds_and_unit_of_a_declared_type_hold(description: str, tmp_path: Path) -> None:
    types = (
        '<TypeDefinitions><SimpleType name="Mass"><Real unit="kg" min="1" max="2"/>'
        "</SimpleType></TypeDefinitions>"
    )
    text = replaced(description, "<LogCategories>", f"{types}<LogCategories>")
    text = replaced(text, MASS_REAL, '<Real declaredType="Mass" start="1.5"/>')
    mass = read_interface(fmu(tmp_path, text)).variables["mass"]
    assert (mass.unit, mass.least, mass.most) == ("kg", 1.0, 2.0)


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"\x00" * 100,
        b"\xff\xfe",
        b"not XML at all",
        b"<fmiModelDescription",
        HEAD.encode() + b'<fmiModelDescription modelName="\xff\xfe\xfd"/>',
        HEAD.replace("UTF-8", "UTF-16").encode() + b"<fmiModelDescription/>",
        HEAD.replace("UTF-8", "klingon").encode() + b"<fmiModelDescription/>",
        HEAD.encode() + b'<fmiModelDescription modelName="&#0;"/>',
        HEAD.encode() + b'<fmiModelDescription modelName="\x1b[31m"/>',
        HEAD.encode() + b"<html/>",
        HEAD.encode() + b'<x:fmiModelDescription xmlns:x="urn:x" fmiVersion="2.0"/>',
        HEAD.encode() + b'<fmiModelDescription fmiVersion="2.0"><CoSimulation'
        b' modelIdentifier="a"/></fmiModelDescription>',
    ],
)
def test_what_is_not_a_description_is_refused(text: bytes, tmp_path: Path) -> None:
    assert DESCRIPTION in refused(tmp_path, text) or b"CoSimulation" not in text


@pytest.mark.parametrize("cut", [10, 500, 3000, 7000])
def test_cut_description_is_refused(cut: int, description: str, tmp_path: Path) -> None:
    assert "not XML" in refused(tmp_path, description[:cut])


@pytest.fixture(scope="module")
def third(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The model description of an FMU of FMI 3, with arrays."""
    return read_description(foreign("TYPES", tmp_path_factory.mktemp("third"), version=3)).decode()


SIZE = '<Dimension start="3" />'
SIZED = """<UInt64 name="size" valueReference="90" causality="structuralParameter"
 variability="fixed" start="3"/><Float64 name="in_array\""""


def test_size_by_a_structural_parameter_is_that_of_its_start(third: str, tmp_path: Path) -> None:
    """Nothing changes a structural parameter: that takes a mode that no instance enters."""
    text = replaced(third, '<Float64 name="in_array"', SIZED)
    text = replaced(text, SIZE, '<Dimension valueReference="90"/>')
    interface = read_interface(fmu(tmp_path, text))
    assert [v.name for v in interface.port("in_array", "input")] == [
        f"in_array[{k}]" for k in (1, 2, 3)
    ]
    assert interface.variables["size"].causality == "structuralParameter"


@pytest.mark.parametrize(
    "size",
    [
        "<Dimension/>",
        '<Dimension valueReference="999"/>',
        '<Dimension valueReference="41"/>',
        '<Dimension valueReference="39"/>',
    ],
    ids=["none", "nowhere", "matrix", "itself"],
)
def test_dimension_without_a_size_is_refused(size: str, third: str, tmp_path: Path) -> None:
    message = refused(tmp_path, replaced(third, SIZE, size))
    assert "the dimension has no size, nor a variable that gives it" in message
    assert "line " in message


def test_endless_arrays_are_refused_before_they_are_made(third: str, tmp_path: Path) -> None:
    text = third.replace(SIZE, '<Dimension start="300000" />').replace('start="0.0 0.0 0.0"', "")
    text = replaced(text, 'variability="continuous" >', 'variability="continuous" start="0">')
    message = refused(tmp_path, text)
    assert "variables and elements; at most 500000 are read" in message


def test_clocks_are_left_out(third: str, tmp_path: Path) -> None:
    clock = (
        '<Clock name="tick" valueReference="90" causality="input" variability="discrete"'
        ' intervalVariability="triggered"/>'
    )
    text = replaced(third, "</ModelVariables>", f"{clock}</ModelVariables>")
    assert "tick" not in read_interface(fmu(tmp_path, text)).variables
