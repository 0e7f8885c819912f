"""Which of the results that a command is given are runs, and which are sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from . import common

if TYPE_CHECKING:
    import xarray

    from ..results.recorded import Recorded


def runs_or_sweeps(
    paths: Sequence[Path],
) -> tuple[dict[str, Recorded], dict[str, xarray.Dataset]]:
    """Results by their short names, all of them runs, or all of them sweeps.

    `InputError` where one cannot be read, or there are both kinds.
    """
    from ..results.recorded import read_run

    names = common.run_names(paths)
    found = {name: read_run(path) for name, path in names.items()}
    runs = {name: run for name, run in found.items() if run is not None}
    swept = [name for name in found if name not in runs]
    if not swept:
        return runs, {}
    if runs:
        raise InputError(
            f"{names[next(iter(runs))]} is a run over time, {names[swept[0]]} a sweep, which keeps"
            " the metrics of many runs: give results of one kind; a sweep of one point has the"
            " metrics of that run"
        )
    from ..studies.sweep.dataset import read

    return {}, {name: read(names[name]) for name in swept}
