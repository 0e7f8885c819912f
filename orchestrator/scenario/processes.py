"""Which process each instance of a run is in."""

from __future__ import annotations

import os

from .plan import Plan

MASTERS = "the master's"
SHARED = "one for all FMUs"
OWN = "its own"


def process_of(plan: Plan, name: str) -> str:
    """The process of a component, as far as is known before it is loaded."""
    if is_guarded(plan):
        return SHARED
    return OWN if _is_foreign(plan, name) else MASTERS


def is_guarded(plan: Plan) -> bool:
    """Whether the whole run is in a process beside the master's, with all its instances.

    So it is where an FMU is foreign, not built on this machine, and not declared harmless by
    `isolate = false`. One that needs a process of its own keeps the run in the master's: stated
    by `isolate = true`, or where an FMU allows one instance in a process and has several.
    """
    if not hasattr(os, "killpg"):
        return False
    names = list(plan.interfaces)
    return any(_is_foreign(plan, n) for n in names) and not any(needs_own(plan, n) for n in names)


def shared_memory(plan: Plan) -> int:
    """What the process of a guarded run may allocate [byte]: the most that any instance may."""
    return max(limits.memory for limits in plan.limits.values())


def needs_own(plan: Plan, name: str) -> bool:
    """Whether an instance can share a process with no other."""
    isolate = plan.scenario.components[name].isolate
    interface = plan.interfaces[name]
    if isolate is None and interface.once:
        return sum(other.path == interface.path for other in plan.interfaces.values()) > 1
    return bool(isolate)


def _is_foreign(plan: Plan, name: str) -> bool:
    """Whether an FMU may not run in the master's process."""
    isolate = plan.scenario.components[name].isolate
    return needs_own(plan, name) or (isolate is None and not plan.interfaces[name].ours)
