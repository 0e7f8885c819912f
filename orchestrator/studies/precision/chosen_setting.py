"""The cheapest setting of a precision study as a scenario that extends the studied one."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from ...errors import InputError, OutputError, ScenarioError
from ...report.files import check_place, written_whole
from ...scenario.files import as_base
from ...scenario.library import LIBRARY
from ...simulation.load import unloaded
from .study import Study


def setting_path(scenario: str, target: float) -> Path:
    """The file in the current folder, named after the scenario and the target."""
    return Path(f"{Path(scenario).stem}-{target:g}.toml")


def check_setting(path: Path) -> None:
    """Refuse to write over a scenario, before any work is done for it."""
    if path.exists():
        raise OutputError(f"{path}: is there already; move it away")
    check_place(path)


def write_setting(
    study: Study,
    scenario: str,
    target: float,
    library: Path = LIBRARY,
    *,
    changes: Mapping[str, str] | None = None,
    stop: str | None = None,
) -> Path:
    """Write a scenario with the cheapest setting whose error is within a target; its path.

    It stands at :func:`setting_path`, and has the `changes` and the `stop` that were studied.
    Raises `InputError` where no setting reaches the target, and `OutputError` where there is such a
    file already.
    """
    path = setting_path(scenario, target)
    best = study.cheapest(target)
    if best is None:
        errors = [study.error(r) for r in study.runs if r.status == "done"]
        least = f"the least error is {min(errors):.1e}" if errors else "none of them runs"
        raise InputError(f"--use {target:g}: no setting reaches it; {least}")
    check_setting(path)
    lines = [
        f"# {best.method}: error {study.error(best):.1e} against {study.reference}",
        f"extends = {json.dumps(as_base(scenario))}",
        "",
        "[master]",
        f"kind = {json.dumps(best.method.kind)}",
        f"laws = {json.dumps(best.method.laws)}",
        "",
        "[time]",
        f"step = {best.step!r}" if best.tolerance is None else f"tolerance = {best.tolerance!r}",
    ]
    lines += [f"stop = {json.dumps(stop)}"] if stop else []
    starts: dict[str, dict[str, str]] = {}
    for name, value in (changes or {}).items():
        component, _, parameter = name.partition(".")
        starts.setdefault(component, {})[parameter] = value
    for component, values in starts.items():
        lines += ["", f"[components.{json.dumps(component)}.start]"]
        lines += [f"{json.dumps(name)} = {json.dumps(value)}" for name, value in values.items()]
    with written_whole(path) as waiting:
        waiting.write_text("\n".join([*lines, ""]), encoding="utf-8")
    try:
        unloaded(path, library=library)
    except ScenarioError:
        path.unlink()
        raise
    return path
