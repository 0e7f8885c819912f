"""A system of systems as one: components by path, connections traced to where they come from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

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

    `outputs` are the outputs of components that the outermost system gives as its own. `settable`
    are the inputs and parameters of systems with their units, `reached` what each of them that
    nothing feeds gives its value to: joints whose source is the system's connector. `bound` are
    the connectors that a value was put on.
    """

    components: dict[Path, Component]
    joints: list[Joint]
    values: dict[Path, dict[str, Value]]
    outputs: list[Node]
    settable: dict[Node, str]
    reached: dict[Node, list[Joint]]
    bound: set[Node] = field(default_factory=set)

    def put(self, path: Path, value: Value) -> bool:
        """Set what a value names, seen from a system; whether there is such a thing.

        A component's variable, or a connector of a system, whose value goes where it leads.
        """
        inner = tuple(value.name.split("."))
        for k in range(len(inner) - 1, 0, -1):
            target = (*path, *inner[:k])
            if target in self.values:
                name = ".".join(inner[k:])
                self.values[target][name] = Value(name, value.value, value.kind, value.unit)
                return True
        node = ((*path, *inner[:-1]), inner[-1])
        if node not in self.settable:
            return False
        self.bound.add(node)
        for joint in self.reached.get(node, []):
            owner, name = joint.target
            self.values[owner][name] = _passed(value, self.settable[node], joint)
        return True


def flattened(where: str, system: System) -> Flat:
    """Resolve a system; `ScenarioError` where a connection leads nowhere or in a circle."""
    components = dict(_components(system, ()))
    feeding: dict[Node, tuple[Node, Connection]] = {}
    problems = Problems(where)
    for start, end, connection in _connections(system, ()):
        if end in feeding:
            problems.add(_shown(end), "is fed twice")
        feeding[end] = (start, connection)
    settable = {
        (path, name): unit
        for path, inner in _systems(system, ())
        for name, unit in inner.settable.items()
    }
    joints: list[Joint] = []
    reached: dict[Node, list[Joint]] = {}
    for node in feeding:
        if node[0] in components:
            joint = _traced(node, feeding, components, problems)
            if joint is None:
                continue
            if joint.source[0] in components:
                joints.append(joint)
            else:
                reached.setdefault(joint.source, []).append(joint)
    outputs = []
    for name in system.outputs:
        joint = _traced(((), name), feeding, components, problems)
        if joint is None:
            continue
        if joint.source[0] in components:
            outputs.append(joint.source)
        elif joint.source[0]:
            _add_unfed(problems, joint)
    values: dict[Path, dict[str, Value]] = {
        path: {value.name: value for value in component.values}
        for path, component in components.items()
    }
    flat = Flat(components, joints, values, outputs, settable, reached)
    _put_all(flat, system, where)
    inputs = {(path, name) for path, inner in _systems(system, ()) for name in inner.inputs}
    for node, each in reached.items():
        optional = node in flat.bound or (node in settable and node not in inputs)
        if node[0] and not optional:
            for joint in each:
                _add_unfed(problems, joint)
    problems.check()
    return flat


def _add_unfed(problems: Problems, joint: Joint) -> None:
    shown = f"nothing feeds {_shown(joint.source)}, which it comes from"
    problems.add(_shown(joint.target), shown)


def _put_all(flat: Flat, system: System, where: str) -> None:
    """Values of systems over those of components, the outer ones last: they override."""
    for path, around in sorted(_systems(system, ()), key=lambda pair: -len(pair[0])):
        for value in around.values:
            if not flat.put(path, value):
                raise ScenarioError(
                    f"{where}: parameter {printable(value.name)!r} does not belong to a"
                    f" component of {printable(around.name)!r}"
                )


def _passed(value: Value, unit: str, joint: Joint) -> Value:
    """A connector's value as it arrives: in the connector's unit where it has none of its own."""
    new = value.value
    if not isinstance(new, bool | str):
        new = joint.gain * new + joint.offset
    elif (joint.gain, joint.offset) != (1.0, 0.0):
        raise ScenarioError(
            f"{_shown(joint.target)}: {printable(value.name)} is no number to scale"
        )
    kept = (value.unit or unit) if joint.converts else ""
    return Value(joint.target[1], new, value.kind, kept)


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
    """The joint that ends at a node, from an output or a system's connector that nothing feeds."""
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
    return None if here == node else Joint(here, node, gain, offset, converts)


def _systems(system: System, path: Path) -> Iterator[tuple[Path, System]]:
    yield path, system
    for inner in system.systems:
        yield from _systems(inner, (*path, inner.name))


def _shown(node: Node) -> str:
    return printable(".".join([*node[0], node[1]]))
