"""A sweep's dataset as rows: axes, metrics, and the status of each point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import printable

if TYPE_CHECKING:
    import xarray
    from rich.table import Table

BESIDE = ("status", "reason", "wall_time")


def facts(data: xarray.Dataset) -> list[dict[str, Any]]:
    """One record for each point."""
    names = [str(name) for name in [*data.coords, *data.data_vars] if data[name].ndim]
    return [
        {name: data[name].values[k].item() if _numeric(data[name]) else str(data[name].values[k])
         for name in names}
        for k in range(data.sizes["point"])
    ]  # fmt: skip


def table(data: xarray.Dataset) -> Table:
    """Axes and metrics side by side; the reason in place of metrics where a point failed."""
    from rich.table import Table

    axes = [str(name) for name in data.coords if data[name].dims == ("point",)]
    columns = [str(name) for name in data.data_vars if name not in BESIDE]
    made = Table(title=printable(str(data.attrs.get("title", ""))), title_justify="left")
    for name in [*axes, *columns]:
        unit = str(data[name].attrs.get("units", ""))
        made.add_column(printable(f"{name}\n{unit}"), justify="right")
    for k in range(data.sizes["point"]):
        row = [_shown(data[name].values[k]) for name in axes]
        if str(data["status"].values[k]) == "done":
            row += [_shown(data[name].values[k]) for name in columns]
        else:
            row.append(printable(f"{data['status'].values[k]}: {data['reason'].values[k]}"))
        made.add_row(*row)
    return made


def _numeric(column: xarray.DataArray) -> bool:
    return bool(np.issubdtype(column.dtype, np.number))


def _shown(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else printable(str(value), most=40)
