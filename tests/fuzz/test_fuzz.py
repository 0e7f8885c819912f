"""Mutated inputs are accepted, or refused with a message that names their file; nothing else.

An input is made from its kind and a seed alone. One that falls is left in the folder of the test,
and made again by

    FUZZ_SEED=17 pytest tests/fuzz -k mutated_inputs-csv

Made as small as still shows it, it is kept in `kept/KIND`, which every run of the tests reads.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

from orchestrator.errors import ResilinError
from orchestrator.recording import binary_process

from .fork_server import ForkServer
from .kinds import Kind, kinds

NAMES = ("fmu", "scenario", "ssp", "csv", "matlab", "netcdf", "parquet", "result")
KEPT = Path(__file__).parent / "kept"


@pytest.fixture(scope="module")
def known(library: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Kind]:
    return kinds(library, tmp_path_factory.mktemp("good"))


@pytest.fixture(scope="module")
def server() -> Iterator[ForkServer]:
    with ForkServer() as made:
        yield made


@pytest.fixture(autouse=True)
def forking(server: ForkServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(binary_process, "_reader", server.reader)


def fault(kind: Kind, data: bytes, folder: Path) -> str:
    """What is wrong with how an input is treated; "" where it is accepted or refused well."""
    path = folder / f"{hashlib.sha256(data).hexdigest()[:12]}-{kind.file}"
    path.write_bytes(data)
    try:
        kind.read(path)
    except ResilinError as error:
        if path.name not in str(error):
            return f"{path}: the message does not name it: {error}"
    except Exception as error:
        return f"{path}: {type(error).__name__}: {error}"
    path.unlink()
    return ""


def faults(kind: Kind, seeds: Iterable[int], folder: Path) -> dict[int, str]:
    """The seeds of inputs that fall, and how."""
    found = {seed: fault(kind, kind.mutated(seed), folder) for seed in seeds}
    return {seed: text for seed, text in found.items() if text}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", NAMES)
def test_mutated_inputs(name: str, known: dict[str, Kind], tmp_path: Path) -> None:
    given = os.environ.get("FUZZ_SEED")
    seeds = range(known[name].usual) if given is None else [int(given)]
    assert faults(known[name], seeds, tmp_path) == {}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", NAMES)
def test_many_mutated_inputs(name: str, known: dict[str, Kind], tmp_path: Path) -> None:
    assert faults(known[name], range(known[name].most), tmp_path) == {}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "path", sorted(KEPT.glob("*/*")), ids=lambda path: f"{path.parent.name}-{path.name}"
)
def test_inputs_that_fell(path: Path, known: dict[str, Kind], tmp_path: Path) -> None:
    assert fault(known[path.parent.name], path.read_bytes(), tmp_path) == ""
