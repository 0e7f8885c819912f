"""A scenario over ranges of its start values: one run for each point, on worker processes.

Each finished point is written to disk at once, in `TARGET.points`, so that a sweep that was stopped
or killed goes on where it was. At the end all points are in one labelled netCDF file.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import InputError, OutputError, SimulationError, nearest, printable
from ...extras import require
from ...scenario.files import scenario_names, scenario_path
from ...scenario.library import LIBRARY, located
from ...simulation.interrupt import Interrupt, Interrupted
from ..workers.in_process import InProcess
from ..workers.pool import Answer, Failed, WorkerPool
from .axes import Axis, check_axes, parse_axis
from .checkpoint import Checkpoint, record_of
from .metric_units import shown_units
from .peak import FINEST, Peak, middles, peak_of, spacing, uncertainty_of
from .points import Grid, Point, Record, Setting, calculate, calculated, planned, point_at

if TYPE_CHECKING:
    import xarray

__all__ = ["Axis", "parse_axis", "sweep"]

BRIEF = 300_000
"""Communication steps of all points together up to which no worker is started: some seconds."""

Check = Callable[[], None]


def sweep(
    scenario: str | Path,
    axes: Sequence[Axis | str],
    library: Path = LIBRARY,
    target: Path = Path("results") / "sweep.nc",
    *,
    changes: Mapping[str, str] | None = None,
    options: Mapping[str, Any] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    patience: float | None = None,
    refine: str | None = None,
    keep: bool = False,
    overwrite: bool = True,
    progress: bool | None = None,
    interrupt: Interrupt | None = None,
) -> xarray.Dataset:
    """Run a scenario at every point of the axes' product; its metrics over the axes.

    Each axis is a dimension with its values as coordinate, numbers rising, so that
    `data["travel"].sel({"amplifier.frequency": 18}, method="nearest")` picks a point.

    An axis may be a text, as :func:`~orchestrator.studies.sweep.axes.parse_axis` reads it.
    `changes` and `options` hold for all points, as for :func:`orchestrator.simulation.load.load`.
    Points run on `workers` processes here, as many as processors by default, or on those of a
    dask `scheduler`; a few short ones of compiled parts run in this process where neither is given.
    A run that stops, ends its worker twice or takes longer than `patience` seconds is `failed`,
    with its reason; no other point fails with it. With `refine`, the name of a metric, the gaps
    beside its largest value on the one axis are bisected down to 1/8 of the grid's, or until the
    top of the parabola through the peak changes by less than 1e-3.

    The result is written to `target`. A sweep that is interrupted, or loses its scheduler, leaves
    `TARGET.partial.nc` with `missing` points, and goes on from `TARGET.points` the next time:
    points of another scenario, FMU or version of Resilin are not reused. `keep` leaves that
    folder after a whole sweep. Without `overwrite` a result of other points at `target` is kept
    under another name, with a :class:`~orchestrator.errors.KeptWarning`. Raises `InputError` with
    all problems before anything runs.
    """
    from ...results.kept_aside import keep_other
    from ...results.netcdf import check_target, prepare
    from .dataset import described

    require("a sweep", "xarray")
    check_target(target)
    common = dict(changes or {})
    parsed = [parse_axis(axis) if isinstance(axis, str) else axis for axis in axes]
    check_axes(parsed, common)
    _check_numbers(workers, patience)
    if refine is not None:
        _check_line(parsed)
    check: Check = interrupt.check if interrupt is not None else _nothing
    place = _place_of(scenario)
    parts = str(located(library, Path(place)).absolute())
    setting = Setting(place, parts, common, dict(options or {}))
    grid = planned(setting, parsed, check)
    if refine is not None and not grid.coordinates[0].numeric:
        raise InputError(f"refine: {parsed[0].name} takes texts, and there is nothing between them")
    if refine is not None and refine not in (known := shown_units(grid.plan)):
        raise InputError(f"refine: no metric {printable(refine)!r}; {nearest(refine, known)}")
    prepare(target)
    with (
        Checkpoint(target) as folder,
        _pool(grid, workers, scheduler, patience) as pool,
        _bar(bool(progress)) as show,
    ):
        if not overwrite:
            keep_other(target, described(grid, refine))
        study = _Study(grid, folder, pool, refine, check, show)
        return study.carried_out(target, keep)


def _pool(
    grid: Grid, workers: int | None, scheduler: str | None, patience: float | None
) -> WorkerPool[Point] | InProcess[Point]:
    """Workers, or this process where it is done with all points before they would have started.

    Compiled parts of this project, whose steps are known, take some microseconds for each.
    """
    plan = grid.plan
    compiled = all(known.ours and not known.needs_tool for known in plan.interfaces.values())
    short = len(grid.points) * plan.grid.count <= BRIEF and plan.scenario.time.tolerance is None
    asked = workers is not None or scheduler is not None or patience is not None
    if compiled and short and not asked:
        return InProcess(calculated)
    return WorkerPool(calculate, workers, scheduler, patience)


class _Study:
    """The points of one sweep and their records so far."""

    def __init__(
        self,
        grid: Grid,
        folder: Checkpoint,
        pool: WorkerPool[Point] | InProcess[Point],
        refine: str | None,
        check: Check,
        show: Callable[[int, int], None],
    ) -> None:
        self._grid = grid
        self._folder = folder
        self._pool = pool
        self._refine = refine
        self._check = check
        self._show = show
        self._points = list(grid.points)
        self._records: dict[str, Record] = {}
        self._peak: Peak | None = None

    def carried_out(self, target: Path, keep: bool) -> xarray.Dataset:
        """Run the points without a record, refine, and write all points to one file."""
        try:
            self._run(self._points)
            if self._refine is not None:
                self._find_peak(self._refine)
        except Interrupted as error:
            self._keep(target, str(error))
            raise
        except (InputError, SimulationError) as error:
            self._keep(target, str(error))
            raise type(error)(f"{error}{self._kept()}") from None
        data = self._written(target, "")
        if not keep:
            self._folder.remove()
        return data

    def _run(self, points: Sequence[Point]) -> None:
        """Get a record of every point: from an earlier sweep, or from a worker."""
        known = {point.key: self._folder.read(point) for point in points}
        self._records |= {key: record for key, record in known.items() if record is not None}
        self._show(len(self._records), len(self._points))
        waiting = [point for point in points if known[point.key] is None]
        for point, answer in self._pool.answers(waiting, self._check):
            record = _record(answer)
            self._folder.write(point, record)
            self._records[point.key] = record
            self._show(len(self._records), len(self._points))

    def _find_peak(self, metric: str) -> None:
        """Add points beside the largest value of a metric, until they change it no more."""
        axis = self._grid.coordinates[0]
        finest = FINEST * spacing(self._values(metric))
        while True:
            values, before = self._values(metric), self._peak
            self._peak = peak = peak_of(values)
            if peak is None:
                return
            if before is not None and peak.like(before, finest):
                return
            more = [self._at(place) for place in middles(values, finest, whole=axis.whole)]
            if not more:
                return
            self._points += more
            self._run(more)

    def _values(self, metric: str) -> dict[float, float]:
        """A metric over the axis; NaN where a point has none."""
        values = {}
        for point in self._points:
            record = self._records.get(point.key)
            value = record.metric(metric) if record is not None else None
            values[float(point.place[0])] = math.nan if value is None else value
        return values

    def _at(self, place: float) -> Point:
        """A point between those of the grid."""
        axis, setting = self._grid.coordinates[0], self._grid.setting
        text = repr(place) if axis.unit == "1" else f"{place!r} {axis.unit}"
        return point_at(setting, (axis.name,), (text,))[1]

    def _written(self, target: Path, reason: str) -> xarray.Dataset:
        from .dataset import collected, write

        data = collected(self._grid, self._points, self._records, reason, self._refine)
        if self._refine is not None and self._peak is not None:
            found = {"peak_at": self._peak.at, "peak": self._peak.value}
            error = uncertainty_of(self._values(self._refine))
            if error is not None:
                found |= {"peak_at_uncertainty": error.at, "peak_uncertainty": error.value}
            data.attrs |= found
        write(data, target)
        return data

    def _keep(self, target: Path, reason: str) -> None:
        """Write the points so far; where that fails too, they are still in their folder."""
        if self._records:
            with suppress(OutputError):
                self._written(target, reason)

    def _kept(self) -> str:
        """The end of an error message, about the points that are on disk."""
        if not self._records:
            return ""
        return (
            f"; {len(self._records)} of {len(self._points)} points are kept in"
            f" {self._folder.path}; the same sweep goes on from there"
        )


def _record(answer: Answer | Failed) -> Record:
    if isinstance(answer, Failed):
        return Record("failed", answer.reason)
    return record_of(answer)


def _place_of(scenario: str | Path) -> str:
    """A shipped scenario by its name, any other by a path that holds wherever a worker runs."""
    name = str(scenario)
    return name if name in scenario_names() else str(scenario_path(name).absolute())


def _check_numbers(workers: int | None, patience: float | None) -> None:
    if workers is not None and workers < 1:
        raise InputError(f"workers: {workers} cannot run anything; give at least 1")
    if patience is not None and not patience > 0.0:
        raise InputError(
            f"patience: {patience:g} s has to be above zero; give more, or leave it out"
        )


def _check_line(axes: Sequence[Axis]) -> None:
    """Refuse to look for a peak unless there is one axis of at least three points."""
    if len(axes) != 1:
        raise InputError("refine: takes a sweep over one axis; sweep the others one by one")
    if len(axes[0].values) < 3:
        raise InputError(f"refine: {axes[0].name} has fewer than three values; give more")


def _nothing() -> None:
    """Check for no interrupts."""


@contextmanager
def _bar(show: bool) -> Iterator[Callable[[int, int], None]]:
    """A bar on the terminal, as a function of the points done and the points in all."""
    if not show:
        yield lambda done, total: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("points", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
