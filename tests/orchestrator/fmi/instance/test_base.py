"""One instance outside any scenario: values by name, messages, closing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from orchestrator.errors import SimulationError
from orchestrator.fmi.archive import extract
from orchestrator.fmi.description import read_interface
from orchestrator.fmi.instance import Instance, open_instance
from orchestrator.fmi.instance.message_log import MOST_MESSAGES
from tests.foreign.scenarios import Shelf, each_version

pytestmark = pytest.mark.usefixtures("mark")


@pytest.fixture
def alone(shelf: Shelf, tmp_path: Path) -> Iterator[Callable[..., Instance]]:
    """An instance of TYPES outside any scenario."""
    instances: list[Instance] = []

    def opened(version: int, isolate: bool) -> Instance:
        path = shelf("TYPES", version)
        extract(path, tmp_path / "unpacked")
        interface = read_interface(path)
        instances.append(open_instance("types", interface, tmp_path / "unpacked", isolate))
        return instances[-1]

    yield opened
    for instance in instances:
        instance.close()
        instance.close()


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
@each_version
def test_values_set_by_name_stay(
    version: int, isolate: bool, alone: Callable[..., Instance]
) -> None:
    """Setting one element of an array, then another, keeps the first; closing twice is safe."""
    instance = alone(version, isolate)
    names = ["out_boolean", "out_enumeration"]
    names += [f"out_matrix[{i},{j}]" for i in (1, 2) for j in (1, 2)] if version == 3 else []
    values = np.zeros(len(names))
    instance.connect([], np.zeros(0), [[instance.interface.variables[n] for n in names]], values)
    instance.prepare({"in_boolean": 1.0, "in_enumeration": 2.0}, 0.0, 1.0, None)
    if version == 3:
        instance.set({"in_matrix[1,1]": 9.0})
        instance.set({"in_matrix[2,1]": 8.0})
    instance.enter_initialisation()
    instance.receive()
    assert values.tolist() == [0.0, 2.0, 9.0, 8.0, 2.0, 4.0][: len(names)]


@pytest.mark.parametrize("isolate", [True, False], ids=["isolated", "in process"])
def test_closed_instance_can_only_be_closed(isolate: bool, alone: Callable[..., Instance]) -> None:
    instance = alone(2, isolate)
    instance.close()
    instance.close()
    if isolate:
        with pytest.raises(SimulationError, match="its process has been given up"):
            instance.step(0.0, 0.1)


def test_last_of_many_messages_is_kept(alone: Callable[..., Instance]) -> None:
    instance = alone(2, False)
    for k in range(3 * MOST_MESSAGES):
        instance.log(1, f"types: message {k}")
    assert len(instance.messages) == MOST_MESSAGES
    assert instance.messages[0] == "message 0"
    assert instance.last_message() == f": message {3 * MOST_MESSAGES - 1}"
