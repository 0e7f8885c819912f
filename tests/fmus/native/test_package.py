"""The archive of a native FMU, and what the builder refuses."""

from __future__ import annotations

import importlib.util
import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from fmpy.validation import validate_fmu
from typer import Typer
from typer.testing import CliRunner

import build_fmus
from fmus.native import link
from tests.fmus.native.pair import Library, Pair

PARTS = build_fmus.compilable()
DIFFERENT = {"guid", "generationTool", "needsExecutionTool"}


def described(fmu: Path) -> list[tuple[str, dict[str, str]]]:
    """Elements of a modelDescription in order, without what has to differ."""
    with zipfile.ZipFile(fmu) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    return [
        (element.tag, {k: v for k, v in element.attrib.items() if k not in DIFFERENT})
        for element in root.iter()
    ]


@pytest.mark.parametrize("name", PARTS)
def test_the_description_is_that_of_the_python_fmu(library: Path, native: Path, name: str) -> None:
    assert described(native / f"{name}.fmu") == described(library / f"{name}.fmu")
    assert validate_fmu(str(native / f"{name}.fmu")) == []
    with zipfile.ZipFile(native / f"{name}.fmu") as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        assert archive.namelist() == [
            f"binaries/{link.own_platform()}/{name}.so",
            "modelDescription.xml",
        ]
    slave = root.find("CoSimulation")
    assert slave is not None
    assert slave.get("needsExecutionTool") == "false"
    assert "numba" in root.get("generationTool", "")


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
    find = importlib.util.find_spec
    hidden: set[str] = {"numba"}

    def found(name: str, package: str | None = None) -> Any:
        return None if name in hidden else find(name, package)

    monkeypatch.setattr(importlib.util, "find_spec", found)
    assert "pip install" in refusal("--native", "payload")
    assert not list(tmp_path.iterdir())


def test_a_linker_that_fails_leaves_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(link, "FLAGS", (*link.FLAGS, "-no-such-option"))
    with pytest.raises(build_fmus.BuildError, match=r"payload: .*linking failed"):
        build_fmus.build("payload", native=True, into=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_without_ziglang_only_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(link.shutil, "which", lambda name: f"/usr/bin/{name}")  # type: ignore[attr-defined]
    assert link._compiler("x86_64-linux-gnu", own=True) == ["cc"]
    with pytest.raises(link.NativeError, match="ziglang is not installed"):
        link._compiler("x86_64-windows-gnu", own=False)
