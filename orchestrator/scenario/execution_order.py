"""Execution order: the order in which a sequential master steps the components."""

from __future__ import annotations

from ..errors import Problems, nearest
from ..fmi.description import EVENT, Interface
from .connections import Connection
from .schema import Scenario


def order_of(
    scenario: Scenario,
    connections: list[Connection],
    interfaces: dict[str, Interface],
    problems: Problems,
) -> list[str]:
    """Execution order as the scenario gives it, else from its wires.

    A component comes after those that feed it, otherwise in the scenario's order. Components of a
    loop keep the scenario's order among themselves: the scenario decides which end of a loop is
    extrapolated. Only `deciders` come last, so that what they decide by is of the same step.
    """
    listed = list(scenario.components)
    given = scenario.master.order
    if not given:
        last = deciders(connections, interfaces)
        return _derived(sorted(listed, key=lambda name: name in last), connections)
    for name in given:
        if name not in listed:
            problems.add("master.order", f"no component {name!r}; {nearest(name, listed)}")
    unknown = set(given) - set(listed)
    if len(set(given)) != len(given):
        problems.add("master.order", "a component appears twice")
    elif not unknown and (missing := [name for name in listed if name not in given]):
        problems.add("master.order", f"{', '.join(missing)} is missing")
    return list(given)


def deciders(connections: list[Connection], interfaces: dict[str, Interface]) -> set[str]:
    """Components whose wires carry nothing but what jumps: switches, choices, whole numbers.

    A discrete real number counts where its component announces when it will jump.
    """
    continuous = {
        c.source
        for c in connections
        if c.output.real
        and not (c.output.variability == "discrete" and EVENT in interfaces[c.source].variables)
    }
    return {c.source for c in connections} - continuous


def _derived(listed: list[str], connections: list[Connection]) -> list[str]:
    """Listed components, sources first; those of a loop count as one."""
    reach = reachable(listed, [(c.source, c.target) for c in connections])
    before = {
        name: {other for other in listed if name in reach[other] and other not in reach[name]}
        for name in listed
    }
    order: list[str] = []
    while len(order) < len(listed):
        order.append(next(n for n in listed if n not in order and before[n] <= set(order)))
    return order


def reachable(nodes: list[str], edges: list[tuple[str, str]]) -> dict[str, set[str]]:
    """Nodes that can be reached from each node along one edge or more."""
    following: dict[str, set[str]] = {node: set() for node in nodes}
    for source, target in edges:
        following[source].add(target)
    reach: dict[str, set[str]] = {}
    for node in nodes:
        found: set[str] = set()
        waiting = list(following[node])
        while waiting:
            one = waiting.pop()
            if one not in found:
                found.add(one)
                waiting += following[one]
        reach[node] = found
    return reach
