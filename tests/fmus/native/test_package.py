"""The archive of a native FMU, and what the builder refuses."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fmpy import extract
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu
from typer import Typer
from typer.testing import CliRunner

import build_fmus
from fmus.native import link
from tests.fmus.native.pair import Library, Pair
from tests.fmus.native.wander import wander

PARTS = build_fmus.compilable()
QUICK = {"payload", "table"}
DIFFERENT = {"guid", "generationTool", "needsExecutionTool", "providesDirectionalDerivative"}
SOURCES = {"SourceFiles", "File"}


def described(fmu: Path) -> list[tuple[str, dict[str, str]]]:
    """Elements of a modelDescription in order, without what has to differ."""
    with zipfile.ZipFile(fmu) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    return [
        (element.tag, {k: v for k, v in element.attrib.items() if k not in DIFFERENT})
        for element in root.iter()
        if element.tag not in SOURCES
    ]


@pytest.mark.parametrize("name", PARTS)
def test_the_description_is_that_of_the_python_fmu(library: Path, native: Path, name: str) -> None:
    assert described(native / f"{name}.fmu") == described(library / f"{name}.fmu")
    assert validate_fmu(str(native / f"{name}.fmu")) == []
    with zipfile.ZipFile(native / f"{name}.fmu") as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        names = set(archive.namelist())
    fixed = {"fmi2.c", "fmi2.h", "instance.h", "dual.h", "semantics.h"}
    files = {*fixed, "words.h", "part.h", f"{name}.c", f"{name}.h"}
    assert names == {
        f"binaries/{link.own_platform()}/{name}{link.PLATFORMS[link.own_platform()].suffix}",
        "modelDescription.xml",
        "documentation/index.html",
        "model.png",
        *(f"sources/{file}" for file in files),
    }
    slave = root.find("CoSimulation")
    assert slave is not None
    assert slave.get("needsExecutionTool") == "false"
    assert slave.get("providesDirectionalDerivative") == "true"
    assert [file.get("name") for file in slave.findall("SourceFiles/File")] == [
        "fmi2.c", f"{name}.c"
    ]  # fmt: skip


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[] if name in QUICK else [pytest.mark.slow]) for name in PARTS],
)
def test_another_tool_builds_it_from_its_sources(native: Path, tmp_path: Path, name: str) -> None:
    """fmpy and CMake, with options of their own: the same bits as from our library."""
    extract(str(native / f"{name}.fmu"), str(tmp_path / "fmu"))
    binaries = tmp_path / "fmu" / "binaries"
    shutil.rmtree(binaries)
    (tmp_path / "cmake").mkdir()
    build_platform_binary(tmp_path / "fmu", tmp_path / "cmake")
    assert [path.stem for path in binaries.rglob("*.*")] == [name]
    packed = tmp_path / f"{name}.fmu"
    with zipfile.ZipFile(packed, "w") as archive:
        for path in (tmp_path / "fmu").rglob("*.*"):
            archive.write(path, path.relative_to(tmp_path / "fmu"))
    (tmp_path / "own").mkdir()
    wander(name, Library(packed, tmp_path / "own"), 300, seed=5)


def test_sources_compile_without_a_warning(native: Path, tmp_path: Path) -> None:
    command = link.compiler(link.PLATFORMS[link.own_platform()].targets[0], own=True)
    for name in PARTS:
        with zipfile.ZipFile(native / f"{name}.fmu") as archive:
            archive.extractall(tmp_path / name)
        files = [tmp_path / name / "sources" / file for file in ("fmi2.c", f"{name}.c")]
        strict = [*command, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wno-unknown-pragmas"]
        link.compiled(files, tmp_path / name / "library", strict)


def test_several_parts_in_one_program(native: Path, tmp_path: Path) -> None:
    """With a prefix for each, as FMI has it for sources that are linked statically."""
    command = link.compiler(link.PLATFORMS[link.own_platform()].targets[0], own=True)
    objects = []
    for name in ("spring", "payload"):
        with zipfile.ZipFile(native / f"{name}.fmu") as archive:
            archive.extractall(tmp_path / name)
        for file in ("fmi2.c", f"{name}.c"):
            made = tmp_path / f"{name}-{file}.o"
            source = tmp_path / name / "sources" / file
            prefix = f"-DFMI2_FUNCTION_PREFIX={name}_"
            subprocess.run(
                [*command, "-c", "-fPIC", prefix, str(source), "-o", str(made)], check=True
            )
            objects.append(made)
    program = tmp_path / "program.c"
    program.write_text(
        "#include <stdio.h>\n"
        "const char *spring_fmi2GetVersion(void), *payload_fmi2GetVersion(void);\n"
        'int main(void) { printf("%s %s", spring_fmi2GetVersion(), payload_fmi2GetVersion()); }\n',
        encoding="utf-8",
    )
    words = [*command, str(program), *map(str, objects), "-lm", "-o", str(tmp_path / "program")]
    subprocess.run(words, check=True)
    said = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True)
    assert said.stdout == "2.0 2.0"


def test_the_same_sources_give_the_same_file(native: Path, tmp_path: Path) -> None:
    again = build_fmus.build("payload", native=True, into=tmp_path)
    assert again.fresh
    assert again.path.read_bytes() == (native / "payload.fmu").read_bytes()
    assert not build_fmus.build("payload", native=True, into=tmp_path).fresh
    assert [path.name for path in tmp_path.iterdir()] == ["payload.fmu"]


def test_a_variant_carries_its_start_values(native: Path, tmp_path: Path) -> None:
    build_fmus.build(
        "payload", alias="heavy", changes={"mass": "1.206 g"}, native=True, into=tmp_path
    )
    finals = []
    for fmu in (native / "payload.fmu", tmp_path / "heavy.fmu"):
        (tmp_path / fmu.stem).mkdir()
        pair = Pair("payload", Library(fmu, tmp_path / fmu.stem))
        place = next(k for k, v in enumerate(pair.variables) if v.name == "mass")
        pair.slave._values[place] *= 2.0 if fmu.stem == "heavy" else 1.0
        pair.set([0], pair.get([0]) + 0.01)
        assert pair.initialise(0.0)
        assert pair.step(0.0, 1e-4)
        finals.append(float(pair.get(pair.outputs)[1]))
        pair.close()
    assert finals[0] == pytest.approx(2.0 * finals[1])


def refusal(*arguments: str) -> str:
    """What the builder says, on one line and without a traceback."""
    app = Typer(pretty_exceptions_enable=False)
    app.command()(build_fmus.build_command)
    result = CliRunner().invoke(app, list(arguments))
    assert result.exit_code == 2
    assert "Traceback" not in result.output
    return result.output


def test_what_cannot_be_built(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    assert "monolith needs scipy" in refusal("--native", "monolith")
    assert "there is linux64, win64, darwin64" in refusal(
        "--native", "payload", "--platform", "linus"
    )
    assert "goes with --native" in refusal("payload", "--platform", "linux64")
    monkeypatch.setenv("CC", "no-such-compiler -O9")
    assert "there is no such command" in refusal("--native", "payload")
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert "pip install 'resilin[native]'" in refusal("--native", "payload")
    assert not list(tmp_path.iterdir())


def test_a_linker_that_fails_leaves_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(link, "FLAGS", (*link.FLAGS, "-no-such-option"))
    with pytest.raises(build_fmus.BuildError, match=r"payload: .*compiling failed"):
        build_fmus.build("payload", native=True, into=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_which_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    """For this machine CC, then cc, then ziglang; for others ziglang."""
    monkeypatch.setattr(link, "own_platform", lambda: "linux64")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(link.shutil, "which", lambda name: f"/usr/bin/{name}")  # type: ignore[attr-defined]
    monkeypatch.setenv("CC", "ccache gcc")
    assert link.compiler("x86_64-linux-gnu", own=True) == ["ccache", "gcc"]
    monkeypatch.delenv("CC")
    assert link.compiler("x86_64-linux-gnu", own=True) == ["cc"]
    with pytest.raises(link.NativeError, match=r"no C compiler for x86_64-windows.*pip install"):
        link.compiler("x86_64-windows-gnu", own=False)
    monkeypatch.setattr(link.shutil, "which", lambda name: None)  # type: ignore[attr-defined]
    with pytest.raises(link.NativeError, match="install a C compiler"):
        link.compiler("x86_64-linux-gnu", own=True)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    assert link.compiler("x86_64-linux-gnu", own=True)[1:] == [
        "-m",
        "ziglang",
        "cc",
        "-target",
        "x86_64-linux-gnu",
    ]
