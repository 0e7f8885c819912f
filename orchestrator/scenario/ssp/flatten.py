"""A system of systems as one: components by path, connections traced to where they come from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ...errors import Problems, ScenarioError, printable
from .document import Component, Connection, System, Value

Path = tuple[str, ...]
Node = tuple[Path, str]
"""A connector: the path of its element, and its name."""


@dataclass(frozen=True)
class Joint:
    """What feeds an input of a component: an output of another, scaled on the way."""

    source: Node
    target: Node
    gain: float
    offset: float
    converts: bool


@dataclass(frozen=True)
class Flat:
    """All components by their paths, what joins them, and parameters by component and name.

    `outputs` are the outputs of components that the outermost system gives as its own.
    """

    components: dict[Path, Component]
    joints: list[Joint]
    values: dict[Path, dict[str, Value]]
    outputs: list[Node]


def flattened(where: str, system: System) -> Flat:
    """Resolve a system; `ScenarioError` where a connection leads nowhere or in a circle."""
    components = dict(_components(system, ()))
    feeding: dict[Node, tuple[Node, Connection]] = {}
    problems = Problems(where)
    for start, end, connection in _connections(system, ()):
        if end in feeding:
            problems.add(_shown(end), "is fed twice")
        feeding[end] = (start, connection)
    joints = []
    for node in feeding:
        if node[0] in components:
            joint = _traced(node, feeding, components, problems)
            if joint is not None:
                joints.append(joint)
    outputs = []
    for name in system.outputs:
        joint = _traced(((), name), feeding, components, problems)
        if joint is not None:
            outputs.append(joint.source)
    problems.check()
    return Flat(components, joints, dict(_values(system, components, where)), outputs)


def _components(system: System, path: Path) -> Iterator[tuple[Path, Component]]:
    for component in system.components:
        yield (*path, component.name), component
    for inner in system.systems:
        yield from _components(inner, (*path, inner.name))


def _connections(system: System, path: Path) -> Iterator[tuple[Node, Node, Connection]]:
    for connection in system.connections:
        ends = [
            ((*path, element) if element else path, name)
            for element, name in (connection.start, connection.end)
        ]
        yield ends[0], ends[1], connection
    for inner in system.systems:
        yield from _connections(inner, (*path, inner.name))


def _traced(
    node: Node,
    feeding: dict[Node, tuple[Node, Connection]],
    components: dict[Path, Component],
    problems: Problems,
) -> Joint | None:
    """The joint that ends at a node; None where an input of the outermost system feeds it."""
    gain, offset, converts = 1.0, 0.0, True
    here = node
    seen = {node}
    while here in feeding:
        start, connection = feeding[here]
        # y = g (g' x + o') + o, the step that is nearer to the component last
        gain, offset = gain * connection.gain, gain * connection.offset + offset
        converts = converts and connection.converts
        if start[0] in components:
            return Joint(start, node, gain, offset, converts)
        if start in seen:
            problems.add(_shown(node), "is fed by itself")
            return None
        seen.add(start)
        here = start
    if here[0]:
        problems.add(_shown(node), f"nothing feeds {_shown(here)}, which it comes from")
    return None


def _values(
    system: System, components: dict[Path, Component], where: str
) -> Iterator[tuple[Path, dict[str, Value]]]:
    """Parameters of each component: its own, then those of systems around it, which override."""
    found: dict[Path, dict[str, Value]] = {path: {} for path in components}
    for path, component in components.items():
        found[path].update({value.name: value for value in component.values})
    for path, around in sorted(_systems(system, ()), key=lambda pair: -len(pair[0])):
        for value in around.values:
            inner = tuple(value.name.split("."))
            target = next(
                (
                    (*path, *inner[:k])
                    for k in range(len(inner) - 1, 0, -1)
                    if (*path, *inner[:k]) in components
                ),
                None,
            )
            if target is None:
                if value.name in around.inputs:
                    continue
                raise ScenarioError(
                    f"{where}: parameter {printable(value.name)!r} does not belong to a"
                    f" component of {printable(around.name)!r}"
                )
            name = ".".join(inner[len(target) - len(path) :])
            found[target][name] = Value(name, value.value, value.kind, value.unit)
    yield from found.items()


def _systems(system: System, path: Path) -> Iterator[tuple[Path, System]]:
    yield path, system
    for inner in system.systems:
        yield from _systems(inner, (*path, inner.name))


def _shown(node: Node) -> str:
    return printable(".".join([*node[0], node[1]]))
