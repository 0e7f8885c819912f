"""The result of a run on disk: a labelled netCDF file that is whole, or marked as partial.

A file is written beside its place and renamed at the end. An incomplete run leaves
`NAME.partial.nc`, marked by its attribute `complete = 0` and the reason.
"""

from __future__ import annotations

import functools
import json
import re
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, OutputError
from ..extras import require
from ..report.files import check_place, make_folder, written_whole
from ..scenario.files import is_file
from ..scenario.plan import Plan
from . import run_notes
from .segments import Column, Segments, assemble, clear_of_nothing, folder_of, found, taken

if TYPE_CHECKING:
    import xarray
from .outcome import Estimate, Outcome
from .texts import Change, Texts, texts_at


def dataset(outcome: Outcome) -> xarray.Dataset:
    """Recorded values over time, named `component.variable`, units and meaning as attributes.

    The dataset's attributes hold what is needed to run it again: scenario, FMU digests,
    versions, master, step; and how the run went. Of a run whose rows have left memory in segments
    only the last rows are here: :func:`write` puts all of them into one file.
    """
    require("a dataset", "xarray")
    import xarray

    data = {}
    for k, column in enumerate(columns(outcome.plan, outcome.texts, outcome.estimates)):
        numbers = column.changes is None
        found = outcome.rows[:, k] if numbers else texts_at(column.changes or (), outcome.times)
        data[column.name] = ("time", found, dict(column.attributes))
    time = ("time", outcome.times, {"units": "s", "long_name": "Time at which values hold"})
    return xarray.Dataset(data, coords={"time": time}, attrs=attributes(outcome))


def columns(
    plan: Plan,
    texts: Mapping[str, Sequence[Change]],
    estimates: dict[str, Estimate] | None = None,
) -> list[Column]:
    """Each recorded variable under a name that netCDF takes: first the numbers, then the texts."""
    made: list[Column] = []
    taken: set[str] = set()
    for index, (component, variable) in enumerate([*plan.records, *plan.texts]):
        name = f"{component}.{variable.name}"
        noted: dict[str, Any] = {"units": variable.unit} if variable.numeric else {}
        noted["long_name"] = variable.description
        if name in (estimates or {}):
            noted["estimated_error"] = (estimates or {})[name].error
        safe = netcdf_name(name)
        if safe != name:
            noted["original_name"] = name
        while safe in taken:
            safe = f"{safe}_{index}"
        taken.add(safe)
        made.append(Column(safe, noted, texts.get(name)))
    return made


def netcdf_name(name: str) -> str:
    """A name that netCDF takes, composed as it composes names; other characters become `_`."""
    composed = unicodedata.normalize("NFC", name)
    kept = "".join("_" if c == "/" or not c.isprintable() else c for c in composed)
    short = kept.encode()[:200].decode(errors="ignore")
    return re.sub(r"^[^A-Za-z0-9_]|\s+$", "_", short)


@functools.cache
def release() -> str:
    """Version of Resilin that is installed; `unknown` where it is not."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("resilin")
    except PackageNotFoundError:
        return "unknown"


def provenance(plan: Plan) -> dict[str, Any]:
    """What a run is made of, as netCDF attributes, known before it starts."""
    digests = {name: interface.guid for name, interface in plan.interfaces.items()}
    return {
        "title": plan.scenario.title,
        "scenario": plan.scenario.model_dump_json(by_alias=True),
        "scenario_file": str(plan.path),
        "fmu_guids": json.dumps(digests),
        "fmu_sha256": json.dumps(plan.digests),
        "resilin_version": release(),
        "master": plan.scenario.master.kind,
        "laws": plan.scenario.master.laws,
        "communication_step": plan.grid.step,
        "frequency": plan.frequency or 0.0,
        "texts": json.dumps(plan.text_names),
        **run_notes.attributes_of(plan),
    }


def attributes(outcome: Outcome) -> dict[str, Any]:
    """Provenance of a run and how it went, as netCDF attributes."""
    return provenance(outcome.plan) | {
        "communication_steps": outcome.steps,
        "rejected_steps": outcome.rejected,
        "step_calls": json.dumps(outcome.calls),
        "rollbacks": json.dumps(outcome.rollbacks),
        "initial_residual": outcome.residual,
        "coupling_energies": json.dumps(outcome.couplings),
        "error_estimate": outcome.doubt or ("none" if outcome.estimates is None else "half step"),
        "metric_errors": json.dumps(outcome.metric_errors),
        "not_estimated": json.dumps(outcome.unseen),
        "wall_time": outcome.wall_time,
        "communication_loop": f"python: {outcome.python_loop}"
        if outcome.python_loop
        else "compiled",
        **run_notes.attributes(outcome),
        "complete": int(outcome.failure is None),
        "reason": str(outcome.failure or ""),
    }


def segments_for(plan: Plan, path: Path) -> Segments:
    """Segments for the rows of a long run, in a folder beside the result."""
    unfinished = provenance(plan) | {"complete": 0, "reason": "the run was killed"}
    texts = Texts(plan.text_names)
    return Segments(folder_of(path), columns(plan, texts.changes), unfinished, texts)


@contextmanager
def opened_file(path: Path) -> Iterator[xarray.Dataset]:
    """A netCDF file to read, a run's or a sweep's; `InputError` where it is not one."""
    require("a plot of a sweep", "xarray")
    import xarray

    if not is_file(path):
        raise InputError(f"{path}: no such result; resilin run makes one")
    try:
        data = xarray.open_dataset(path, engine="netcdf4")
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(f"{path}: not a result that can be read ({error})") from None
    with data:
        yield data


def partial_path(path: Path) -> Path:
    """File for the rows of an incomplete run."""
    return path.with_name(path.name.removesuffix(".nc") + ".partial.nc")


def check_target(path: Path) -> None:
    """Check that a result can be written to `path`, before any work is done for it.

    Raises `OutputError` where it cannot, also where an earlier run has left segments there.
    """
    check_place(path, "results are netCDF files", [".nc"])
    clear_of_nothing(folder_of(path))
    if folder_of(path).exists():
        raise taken(folder_of(path))


def prepare(path: Path) -> None:
    """The same, and make the folder of the result."""
    check_target(path)
    make_folder(path)


def write(outcome: Outcome, path: Path) -> Path:
    """Write an outcome to `path`, or beside it as partial where it is not complete.

    An earlier result stays until a new one is whole, which takes its place and that of an earlier
    partial one. Segments stay where they cannot be put together; `OutputError` then names them.
    """
    target = path if outcome.failure is None else partial_path(path)
    segments = outcome.segments
    pieces = segments.pieces() if segments else iter(())
    try:
        _assembled(
            target,
            columns(outcome.plan, outcome.texts, outcome.estimates),
            attributes(outcome),
            chain(pieces, [(outcome.times, outcome.rows)]),
        )
    except OutputError as error:
        raise OutputError(_unwritten(outcome, error)) from None
    if segments:
        segments.remove()
    if outcome.failure is None:
        partial_path(path).unlink(missing_ok=True)
    return target


def _unwritten(outcome: Outcome, error: OutputError) -> str:
    """Why there is no file of an outcome, and where those of its rows are that are on the disk."""
    text = f"{outcome.failure}; {error}" if outcome.failure is not None else str(error)
    if not outcome.segments:
        return text
    folder = outcome.segments.folder
    outcome.segments.lock.release()
    return (
        f"{text}; {outcome.segments.rows} rows are in {folder}: make room, then"
        f" `resilin recover {folder}` makes a file of them"
    )


def recover(folder: Path) -> tuple[Path, int, list[str]]:
    """Make a partial result of the segments of a killed run.

    Its path, its number of rows, and the names of damaged segments, whose rows are lost; the folder
    stays where there are any. Raises `InputError` where no segment can be read, and while the run
    is alive.
    """
    left = found(folder)
    try:
        lost = [name for name in left.digests if not left.is_whole(name)]
        for name in lost:
            del left.digests[name]
        if not left.digests:
            raise InputError(f"{folder}: no segment is whole: {', '.join(lost) or 'there is none'}")
        target = partial_path(folder.with_name(folder.name.removesuffix(".segments") + ".nc"))
        rows = 0

        def counted() -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
            nonlocal rows
            for times, values in left.pieces():
                rows += len(times)
                yield times, values

        _assembled(target, left.columns, left.attributes, counted())
        if not lost:
            left.remove()
    finally:
        left.lock.release()
    return target, rows, lost


def _assembled(
    target: Path,
    named: list[Column],
    noted: dict[str, Any],
    pieces: Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> None:
    """Write a file that is whole once it has its name."""
    with written_whole(target, failures=(RuntimeError,)) as waiting:
        assemble(waiting, named, noted, pieces)
