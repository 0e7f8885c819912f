"""What a native part says to calls that are wrong, and that its instances are strangers."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import build_fmus
from tests.fmus.native.pair import COUNT, DISCARD, DOUBLE, ERROR, OK, POINTER, Library, Pair, same

PARTS = build_fmus.compilable()


@pytest.fixture(params=PARTS)
def library(request: pytest.FixtureRequest, native: Path, tmp_path: Path) -> Library:
    return Library(native / f"{request.param}.fmu", tmp_path)


@pytest.fixture
def linkage(native: Path, tmp_path: Path) -> Iterator[tuple[Library, int]]:
    library = Library(native / "linkage.fmu", tmp_path)
    unit = library.instantiate("unit")
    assert unit is not None
    yield library, unit
    library.free(unit)


def begin(library: Library, unit: int) -> None:
    call = library.call
    assert call(unit, "SetupExperiment", 0, DOUBLE(0.0), DOUBLE(0.0), 0, DOUBLE(0.0)) == OK
    assert call(unit, "EnterInitializationMode") == OK
    assert call(unit, "ExitInitializationMode") == OK


def test_the_wrong_guid_and_model_exchange_are_refused(library: Library) -> None:
    assert library.instantiate("unit", guid="{other}") is None
    assert "unpack the FMU again" in library.messages[-1][2]
    assert library.instantiate("unit", kind=0) is None
    assert "co-simulation only" in library.messages[-1][2]


def test_five_hundred_lives_in_one_process(library: Library) -> None:
    for _ in range(500):
        unit = library.instantiate("unit")
        assert unit is not None
        begin(library, unit)
        assert library.call(unit, "DoStep", DOUBLE(0.0), DOUBLE(1e-4), 1) == OK
        assert library.call(unit, "Terminate") == OK
        library.free(unit)
    assert library.messages == []


def test_a_step_before_initialisation_is_discarded(library: Library) -> None:
    unit = library.instantiate("unit")
    assert unit is not None
    assert library.call(unit, "DoStep", DOUBLE(0.0), DOUBLE(1e-4), 1) == DISCARD
    status, category, words = library.messages[-1]
    assert (status, category) == (ERROR, "logStatusError")
    assert words == "unit: step at t = 0 s: the instance is not initialised"
    library.free(unit)


def test_what_is_not_there(linkage: tuple[Library, int]) -> None:
    library, unit = linkage
    reference = (ctypes.c_uint * 1)(9999)
    value = (ctypes.c_double * 1)(1.0)
    for name in ("GetReal", "SetReal", "GetInteger", "SetInteger"):
        assert library.call(unit, name, reference, COUNT(1), value) == ERROR
        assert "no variable has the value reference 9999" in library.messages[-1][2]
    for name in ("GetBoolean", "SetBoolean", "GetString", "SetString"):
        assert library.call(unit, name, reference, COUNT(1), value) == ERROR
        assert library.call(unit, name, reference, COUNT(0), value) == OK
    none = COUNT(0)
    for name, arguments in {
        "SetRealInputDerivatives": (None, none, None, None),
        "GetRealOutputDerivatives": (None, none, None, None),
        "CancelStep": (),
        "GetStatus": (0, None),
        "GetRealStatus": (0, None),
        "GetIntegerStatus": (0, None),
        "GetBooleanStatus": (3, None),
        "GetStringStatus": (0, None),
    }.items():
        before = len(library.messages)
        assert library.call(unit, name, *arguments) == ERROR, name
        assert len(library.messages) == before + 1, name


def test_bytes_of_another_part_are_no_state(native: Path, tmp_path: Path) -> None:
    states = []
    for name in ("spring", "payload"):
        (tmp_path / name).mkdir()
        library = Library(native / f"{name}.fmu", tmp_path / name)
        unit = library.instantiate("unit")
        assert unit is not None
        begin(library, unit)
        state = POINTER()
        size = COUNT()
        call = library.call
        assert call(unit, "GetFMUstate", ctypes.byref(state)) == OK
        assert call(unit, "SerializedFMUstateSize", state, ctypes.byref(size)) == OK
        buffer = ctypes.create_string_buffer(size.value)
        assert call(unit, "SerializeFMUstate", state, buffer, COUNT(size.value - 1)) == ERROR
        assert call(unit, "SerializeFMUstate", state, buffer, size) == OK
        states.append((buffer, size))
        for given, length in states[:-1]:
            other = POINTER()
            status = call(unit, "DeSerializeFMUstate", given, length, ctypes.byref(other))
            assert status == ERROR
            assert other.value is None
        assert call(unit, "FreeFMUstate", ctypes.byref(state)) == OK
        assert state.value is None
        library.free(unit)


def test_messages_by_category_and_not_at_all(native: Path, tmp_path: Path) -> None:
    library = Library(native / "payload.fmu", tmp_path)
    unit = library.instantiate("a%nb", logging=0)
    assert unit is not None

    def failed_step() -> list[Any]:
        library.messages.clear()
        assert library.call(unit, "DoStep", DOUBLE(0.0), DOUBLE(1e-4), 1) == DISCARD
        return list(library.messages)

    def wish(logging: int, *categories: bytes) -> None:
        listed = (ctypes.c_char_p * len(categories))(*categories)
        status = library.call(unit, "SetDebugLogging", logging, COUNT(len(categories)), listed)
        assert status == OK

    assert failed_step() == []
    wish(1)
    assert failed_step()[0][2].startswith("a_nb: step")
    wish(1, b"logStatusWarning")
    assert failed_step() == []
    wish(1, b"logStatusWarning", b"logStatusError")
    assert len(failed_step()) == 1
    library.free(unit)


@pytest.mark.parametrize("name", PARTS)
def test_threads_do_not_disturb_each_other(native: Path, tmp_path: Path, name: str) -> None:
    """Four instances stepped at once give what one gives alone."""
    library = Library(native / f"{name}.fmu", tmp_path)
    pair = Pair(name, library)
    references = (ctypes.c_uint * len(pair.outputs))(*pair.outputs)
    rows: dict[int, Any] = {}

    def live(number: int) -> None:
        unit = library.instantiate(f"unit{number}")
        assert unit is not None
        begin(library, unit)
        values = np.empty(len(pair.outputs))
        for k in range(300):
            library.call(unit, "DoStep", DOUBLE(k * 1e-4), DOUBLE(1e-4), 1)
        library.call(
            unit, "GetReal", references, COUNT(len(values)), values.ctypes.data_as(POINTER)
        )
        rows[number] = values
        library.free(unit)

    live(0)
    threads = [threading.Thread(target=live, args=(k,)) for k in range(1, 5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(rows) == 5
    assert all(same(rows[0], row) for row in rows.values())
    pair.close()
