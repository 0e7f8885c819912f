"""Files as tables: formats, delimiters, units, and every way in which a record can be bad."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray
from scipy.io import savemat

from orchestrator.errors import RecordingError
from orchestrator.recording import csv_file
from orchestrator.recording.columns import Choice, Heading
from orchestrator.recording.read import read_table
from orchestrator.recording.table import Table

GOOD = "time [s],force.value [N]\n0,1\n0.5,2\n1,4\n"


def read(folder: Path, content: str | bytes, name: str = "bench.csv", **options: object) -> Table:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    bridge = str(options.pop("bridge", ""))
    most = int(str(options.pop("most", 1 << 20)))
    return read_table(path, Choice(**options), bridge=bridge, most=most)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "content",
    [
        GOOD,
        "\ufeff" + GOOD,
        GOOD.replace("\n", "\r\n"),
        GOOD.replace(",", ";"),
        GOOD.replace(",", "\t"),
        "# component: spring\n% bench: 3\n\n" + GOOD,
        'time (s), "force.value (N)"\n"0","1"\n"0.5", 2\n1,4e0\n',
        "time [ms];force.value [N]\n0,0;1,0\n500,0;2,0\n1000,0;4,00\n",
        "t;force.value [N];\n0;1;\n0.5;2;\n1;4;\n",
    ],
)
def test_one_record_in_many_formats(tmp_path: Path, content: str) -> None:
    table = read(tmp_path, content)
    assert [c.name for c in table.columns] == ["time", "force.value"]
    assert table.columns[1].unit == "N"
    np.testing.assert_allclose(table.times, [0.0, 0.5, 1.0])
    np.testing.assert_allclose(table.values[:, 0], [1.0, 2.0, 4.0])


def test_comments_are_kept_and_rows_keep_their_lines(tmp_path: Path) -> None:
    table = read(tmp_path, "# frequency: 18\n#\n" + GOOD)
    assert table.comments == {"frequency": "18"}
    assert table.at(0).endswith("bench.csv: line 4")


def test_pieces_join(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv_file, "PIECE", 2)
    rows = "".join(f"{k},{k * k}\n" for k in range(7))
    table = read(tmp_path, "time,y\n" + rows)
    np.testing.assert_array_equal(table.values[:, 0], np.arange(7.0) ** 2)


def test_columns_are_named_and_given_units_by_the_scenario(tmp_path: Path) -> None:
    content = "Zeit,F (N),remark,x\n0,1,start,7\n1,2,,8\n"
    table = read(
        tmp_path,
        content,
        columns={"Zeit": "time", "F (N)": "force.value", "x": "motion.displacement"},
        units={"x": "mm"},
    )
    found = [(c.name, c.unit) for c in table.columns]
    assert found == [("time", ""), ("force.value", "N"), ("motion.displacement", "mm")]


def test_an_index_is_not_a_unit() -> None:
    assert Heading.of("x[1]") == Heading("x[1]", "x[1]", "")
    assert Heading.of("x[1] [m]") == Heading("x[1] [m]", "x[1]", "m")


def test_an_endless_heading_takes_no_time(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no column has the name of a variable"):
        read(tmp_path, "time," + "x" + " " * 120_000 + "(\n0,1\n1,2\n")


@pytest.mark.parametrize("kind", ["linear", "held", "cubic"])
def test_gaps_are_bridged_when_asked(tmp_path: Path, kind: str) -> None:
    rows = "".join(f"{k},{'' if k == 5 else 2 * k}\n" for k in range(12) if k != 8)
    table = read(tmp_path, "time,y\n" + rows, bridge=kind)
    assert table.values[5, 0] == pytest.approx(8.0 if kind == "held" else 10.0)


MANY = "time,y\n" + "".join(f"{k},{k}\n" for k in range(30))

BAD: dict[str, tuple[str | bytes, dict[str, object], list[str]]] = {
    "nan": (GOOD + "2,nan\n", {}, ["line 5", "force.value", "gaps"]),
    "empty cell": (GOOD + "2,\n", {}, ["line 5", "no value"]),
    "infinite": (GOOD + "2,1e999\n", {}, ["line 5", "infinite"]),
    "gap at the end": (GOOD + "2,nan\n", {"bridge": "linear"}, ["line 5", "nothing to bridge"]),
    "rows missing": (MANY.replace("\n7,7\n", "\n"), {}, ["line 9", "rows are missing"]),
    "time missing": (GOOD + ",5\n", {}, ["line 5", "time is nan"]),
    "time falls": (GOOD + "0.7,5\n", {}, ["line 5", "comes after 1 s"]),
    "time twice": (GOOD + "1,5\n", {}, ["line 5", "is duplicated"]),
    "one row": ("time,y\n0,1\n", {}, ["one row"]),
    "no row": ("time,y\n", {}, ["no row"]),
    "empty": ("", {}, ["is empty"]),
    "only comments": ("# a: b\n\n", {}, ["is empty"]),
    "no headings": ("0,1\n1,2\n", {}, ["line 1", "no headings"]),
    "one column": ("time\n0\n1\n", {}, ["line 1", "no comma"]),
    "ragged": (GOOD + "2,3,4\n", {}, ["line 5", "3 cells", "2"]),
    "short": (GOOD + "2\n", {}, ["line 5", "1 cells"]),
    "text": (GOOD + "2,high\n", {}, ["line 5", "force.value", "'high' is not a number"]),
    "thousands": (GOOD.replace(",", ";") + "2;1.234,5\n", {}, ["line 5", "not a number"]),
    "latin-1": ("time,y\n0,1\n# 5 \xb5m\n1,2\n".encode("latin-1"), {}, ["line 3", "UTF-8"]),
    "bytes": (b"time,y\n0,\x00\n", {}, ["line 2", "not text"]),
    "heading twice": ("time,y,y\n0,1,2\n1,2,3\n", {}, ["two columns", "'y'"]),
    "no time": ("tme,y\n0,1\n1,2\n", {}, ["line 1", "no column of time", "'tme'"]),
    "misspelt": (GOOD, {"columns": {"force.valeu": "f"}}, ["did you mean 'force.value [N]'"]),
    "no variable": (GOOD, {"columns": {"force.value": "a b"}}, ["is not the name of a variable"]),
    "taken twice": (
        GOOD,
        {"columns": {"force.value": "a", "force.value [N]": "b"}},
        ["repeats the column or variable of another"],
    ),
    "nothing named": (
        "time,3 x\n0,1\n1,2\n",
        {},
        [
            "no column has the name of a variable",
            'columns = { "3 x" = "force.value" }',
            "--with 'columns.3 x=force.value'",
        ],
    ),
    "unit of none": (GOOD, {"units": {"forse.value": "N"}}, ["did you mean 'force.value [N]'"]),
    "no unit": ("time,y [furlongs per]\n0,1\n1,2\n", {}, ["column 'y [furlongs per]'"]),
    "time in newtons": ("time [N],y\n0,1\n1,2\n", {}, ["column 'time [N]'", "not convertible"]),
    "of another": (GOOD, {"component": "spring"}, ["no column of component 'spring'"]),
    "beyond the bridge": (
        "time,y\n0,1e300\n1,\n2,1\n3,1\n",
        {"bridge": "cubic"},
        ["line 2", "column 'y'", "1e+300 is beyond"],
    ),
    "too large": (GOOD, {"most": 20}, ["more than 20", "memory"]),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_record_is_reported_with_its_place(tmp_path: Path, name: str) -> None:
    content, options, words = BAD[name]
    with pytest.raises(RecordingError) as caught:
        read(tmp_path, content, **options)
    for word in ["bench.csv", *words]:
        assert word in str(caught.value)


def test_what_is_not_a_file_is_reported(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"missing\.csv: no such recording"):
        read_table(tmp_path / "missing.csv", Choice())
    with pytest.raises(RecordingError, match="no such recording"):
        read_table(tmp_path / "a\0.csv", Choice())
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(RecordingError, match="is a folder"):
        read_table(tmp_path / "folder.csv", Choice())
    with pytest.raises(RecordingError, match=r"no format known for '\.xls'"):
        read_table(tmp_path / "bench.xls", Choice())


def test_matlab_by_name_and_by_struct(tmp_path: Path) -> None:
    path = tmp_path / "bench.mat"
    time = np.linspace(0.0, 1.0, 5)
    savemat(path, {"t": time, "force": {"value": time**2}, "note": "x", "gain": 3.0})
    table = read_table(path, Choice(units={"force.value": "mN"}))
    assert [(c.name, c.unit) for c in table.columns] == [("time", ""), ("force.value", "mN")]
    np.testing.assert_allclose(table.values[:, 0], time**2)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM", "-v7"),
        (b"no such thing", "read as a MATLAB file"),
        (b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + b"\x0f\0\0\0\xff\xff\0\0", "MATLAB"),
    ],
)
def test_matlab_that_cannot_be_read(tmp_path: Path, content: bytes, words: str) -> None:
    with pytest.raises(RecordingError, match=words):
        read(tmp_path, content, "bench.mat")


def test_matlab_columns_of_other_lengths_and_holes(tmp_path: Path) -> None:
    path = tmp_path / "bench.mat"
    savemat(path, {"t": np.arange(5.0), "y": np.arange(4.0)})
    with pytest.raises(RecordingError, match="'y' has 4 rows, time has 5"):
        read_table(path, Choice())
    savemat(path, {"t": np.arange(3.0), "y": np.array([0.0, np.nan, 1.0])})
    with pytest.raises(RecordingError, match="row 2: column 'y' has no value"):
        read_table(path, Choice())


def test_netcdf_of_ours_and_of_others(tmp_path: Path) -> None:
    path = tmp_path / "run.nc"
    time = np.linspace(0.0, 1.0, 4)
    names = ["spring.force.value", "payload.velocity"]
    data = {name: ("time", time, {"units": "N"}) for name in names}
    ours = xarray.Dataset(data, coords={"time": time}, attrs={"resilin_version": "1"})
    ours.to_netcdf(path)
    with pytest.raises(RecordingError, match=r"several components.*--with component=NAME"):
        read_table(path, Choice())
    with pytest.raises(RecordingError, match="did you mean 'spring'"):
        read_table(path, Choice(component="sprng"))
    table = read_table(path, Choice(component="spring"))
    assert [(c.name, c.unit) for c in table.columns[1:]] == [("force.value", "N")]
    other = xarray.Dataset({"force.value": ("time", time)}, coords={"time": time})
    other.to_netcdf(path, mode="w")
    assert [c.name for c in read_table(path, Choice()).columns[1:]] == ["force.value"]
    with pytest.raises(RecordingError, match="read as a netCDF file"):
        read(tmp_path, b"CDF nonsense", "broken.nc")


def test_parquet_reports_what_it_needs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(RecordingError, match=r"needs pyarrow; pip install \"resilin\[parquet\]\""):
        read(tmp_path, b"PAR1", "bench.parquet")


def test_parquet(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = tmp_path / "bench.parquet"
    parquet.write_table(pyarrow.table({"time": [0.0, 1.0], "force.value [N]": [1.0, 2.0]}), path)
    assert read_table(path, Choice()).columns[1].unit == "N"
    with pytest.raises(RecordingError, match="read as a Parquet file"):
        read(tmp_path, b"PAR1", "broken.parquet")
