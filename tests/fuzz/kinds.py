"""The kinds of input that are mutated: good ones, how they are mutated, and what reads them."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from random import Random
from zlib import crc32

import netCDF4
import numpy as np
from scipy.io import savemat

from orchestrator.fmi.description import read_interface
from orchestrator.recording.recording import open_recording
from orchestrator.recording.settings import RecordingSettings
from orchestrator.results.metrics import metrics
from orchestrator.results.recorded import read_recorded
from orchestrator.results.segments import CODED
from orchestrator.simulation.load import load

from . import mutators
from .mutators import Mutator

ROWS = np.linspace(0.0, 1.0, 33)
WAVE = np.sin(2.0 * np.pi * ROWS)


@dataclass(frozen=True)
class Kind:
    """Good inputs, the name of their file, mutators, and the reader.

    `usual` inputs are tried by `make test`, `most` by `make slow`.
    """

    goods: tuple[bytes, ...]
    file: str
    mutators: tuple[Mutator, ...]
    read: Callable[[Path], None]
    usual: int = 100
    most: int = 10_000

    def mutated(self, seed: int) -> bytes:
        """The input of a seed, always the same."""
        random = Random(seed)
        data = random.choice(self.goods)
        for _ in range(random.choice((1, 1, 1, 2, 4, 8))):
            data = random.choice(self.mutators)(random, data)
        return data


def kinds(library: Path, folder: Path) -> dict[str, Kind]:
    """All kinds, with the built parts of a library; `folder` takes the good files while made."""

    def scenario(path: Path) -> None:
        load(path, None, library)

    fmus = tuple((library / f"{name}.fmu").read_bytes() for name in ("payload", "spring"))
    described = mutators.entry_of("modelDescription.xml", mutators.XML)
    structured = mutators.entry_of("SystemStructure.ssd", mutators.XML)
    return {
        "fmu": Kind(
            fmus, "input.fmu", (described,) * 6 + (mutators.entries, *mutators.BYTES), _interface
        ),
        "scenario": Kind(SCENARIOS, "input.toml", mutators.TEXT, scenario),
        "ssp": Kind(
            (_ssp(library),),
            "input.ssp",
            (structured,) * 6 + (mutators.entries, *mutators.BYTES),
            scenario,
        ),
        "csv": Kind(TABLES, "input.csv", mutators.CSV, _recording),
        "matlab": Kind(_matlab(), "input.mat", mutators.BYTES, _recording, usual=50),
        "netcdf": Kind(_netcdf(folder), "input.nc", mutators.BYTES, _recording, usual=50),
        "parquet": Kind(_parquet(), "input.parquet", mutators.BYTES, _recording, usual=50),
        "result": Kind(_results(folder), "input.nc", mutators.BYTES, _result, usual=50),
    }


def _interface(path: Path) -> None:
    read_interface(path)


SETTINGS = (
    RecordingSettings(),
    RecordingSettings(interpolation="held", repeat=True),
    RecordingSettings(interpolation="band-limited", gaps="bridge"),
    RecordingSettings(repeat=True),
    RecordingSettings(interpolation="linear", gaps="bridge", repeat="3 s"),
)


def _recording(path: Path) -> None:
    """Open a recording in one of several ways, which its content decides; take values of it."""
    chosen = SETTINGS[crc32(path.read_bytes()) % len(SETTINGS)]
    recording = open_recording(chosen.model_copy(update={"data": str(path)}), path)
    for time in (0.0, 0.37, 1.0):
        with np.errstate(all="ignore"):
            recording.outputs(time, 0.01)


def _result(path: Path) -> None:
    metrics(read_recorded(path))


SCENARIOS = (
    b"""title = "Pushed"
[time]
stop = "0.01 s"
step = "1e-3 s"
[master]
kind = "gauss-seidel"
laws = "affine"
[components.payload]
fmu = "payload"
start = { mass = "1 g" }
[hold]
"payload.force.value" = "0.1 N"
[[actions]]
at = "5 ms"
set = { "payload.force.value" = "0.2 N" }
[[faults]]
at = "6 ms"
on = "payload"
kind = "freeze"
until = "7 ms"
[record]
variables = ["payload.*"]
every = 2
last = "5 ms"
[metrics]
cycles = 3
travel = "peak_to_peak(payload.displacement) in mm"
[plot]
"Displacement" = "payload.displacement in mm"
""",
    b"""[time]
stop = "20 cycles"
step = { per_cycle = 40 }
frequency = "50 Hz"
[components.payload]
fmu = "payload"
isolate = true
patience = "3 s"
memory = "1 GiB"
[components.spring]
fmu = "spring"
[[wires]]
from = "spring.force"
to = "payload.force"
[[wires]]
from = "payload.motion"
to = "spring.motion"
[hold]
"spring.top.voltage" = "1 kV"
"spring.bottom.voltage" = 0
""",
)


def _ssp(library: Path) -> bytes:
    structure = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<ssd:SystemStructureDescription'
        ' xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"'
        ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"'
        ' xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'
        ' version="1.0" name="pushed"><ssd:System name="top"><ssd:Elements>'
        '<ssd:Component name="payload" type="application/x-fmu-sharedlibrary"'
        ' source="resources/payload.fmu"><ssd:Connectors>'
        '<ssd:Connector name="force.value" kind="input"><ssc:Real unit="N"/></ssd:Connector>'
        '<ssd:Connector name="displacement" kind="output"><ssc:Real/></ssd:Connector>'
        "</ssd:Connectors><ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
        '<ssv:ParameterSet version="1.0" name="x"><ssv:Parameters>'
        '<ssv:Parameter name="mass"><ssv:Real value="0.002" unit="kg"/></ssv:Parameter>'
        '<ssv:Parameter name="force.value"><ssv:Real value="0.003"/></ssv:Parameter>'
        "</ssv:Parameters></ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding>"
        "</ssd:ParameterBindings></ssd:Component></ssd:Elements></ssd:System>"
        '<ssd:DefaultExperiment startTime="0" stopTime="0.5"/></ssd:SystemStructureDescription>'
    )
    part = (library / "payload.fmu").read_bytes()
    return mutators.packed(
        {"SystemStructure.ssd": structure.encode(), "resources/payload.fmu": part}
    )


def _table(delimiter: str, comma: bool) -> bytes:
    lines = ["# frequency: 1", delimiter.join(["time [s]", "force.value [N]", "x (mm)"])]
    for time, value in zip(ROWS, WAVE, strict=True):
        text = delimiter.join(f"{number:.6g}" for number in (time, value, 1e3 * value))
        lines.append(text.replace(".", ",") if comma else text)
    return ("\n".join(lines) + "\n").encode()


TABLES = (_table(",", False), _table(";", True), _table("\t", False))


def _matlab() -> tuple[bytes, ...]:
    made = []
    for options in ({"do_compression": True}, {"do_compression": False}, {"format": "4"}):
        file = io.BytesIO()
        content = {"t": ROWS, "y": WAVE}
        if "format" not in options:
            content |= {"force": {"value": WAVE}, "note": "text", "list": [1, "a"]}  # type: ignore[dict-item]
        savemat(file, content, **options)
        made.append(file.getvalue())
    return tuple(made)


def _netcdf(folder: Path) -> tuple[bytes, ...]:
    made = []
    for how in ("NETCDF4", "NETCDF3_CLASSIC"):
        path = folder / "good.nc"
        coded = CODED | {"chunksizes": (16,)} if how == "NETCDF4" else {}
        with netCDF4.Dataset(path, "w", format=how) as file:
            file.createDimension("time", len(ROWS))
            file.createVariable("time", "f8", ("time",), **coded)[:] = ROWS
            force = file.createVariable("force.value", "f8", ("time",), fill_value=-9.0, **coded)
            force[:] = WAVE
            force.units = "N"
            file.createVariable("count", "i4", ("time",), **coded)[:] = np.arange(len(ROWS))
        made.append(path.read_bytes())
    return tuple(made)


def _parquet() -> tuple[bytes, ...]:
    import pyarrow
    from pyarrow import parquet

    file = io.BytesIO()
    table = {
        "time": ROWS,
        "force.value [N]": WAVE,
        "n": np.arange(len(ROWS)),
        "a remark": ["a"] * len(ROWS),
    }
    parquet.write_table(pyarrow.table(table), file)
    return (file.getvalue(),)


def _results(folder: Path) -> tuple[bytes, ...]:
    path = folder / "good.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(
            {
                "title": "Pushed",
                "frequency": 1.0,
                "scenario": '{"metrics": {"cycles": 1, "a": "phase(p.x, p.v) in deg"}, "plot": {}}',
            }
        )
        file.createDimension("time", None)
        file.createVariable("time", "f8", ("time",), chunksizes=(16,), **CODED)[:] = ROWS
        for name, unit in (("p.x", "mm"), ("p.v", "m/s")):
            variable = file.createVariable(name, "f8", ("time",), chunksizes=(16,), **CODED)
            variable[:] = WAVE
            variable.setncatts({"units": unit, "original_name": name})
    return (path.read_bytes(),)
