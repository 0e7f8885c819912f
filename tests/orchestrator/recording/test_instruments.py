"""Texts as oscilloscopes, loggers and spreadsheets write them: one record in every kind."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.errors import RecordingError
from orchestrator.recording.columns import Choice
from orchestrator.recording.layout import Layout
from orchestrator.recording.read import read_table
from orchestrator.recording.table import Table
from orchestrator.units import factor

LAYOUT = set(Layout.__dataclass_fields__)
CH1 = {"CH1": "U"}
TEKTRONIX = """Model,MSO2024B
Firmware Version,1.52

Point Format,Y,
Horizontal Units,S,
Sample Interval,0.001,
Record Length,3,
Vertical Units,mV,
,
Label,,
TIME,CH1
0,1000
0.001,2000
0.002,4000
"""
TDS = """Record Length,2.500000e+03,,+00000.000000000,  1.00000,
Sample Interval,1.000000e-03,,+00000.001000000,  2.00000,
Trigger Point,1.250000000000e+03,,+00000.002000000,  4.00000,
"""
KEYSIGHT = "x-axis,1\nsecond,Volt\n0.0,1.0\n+1.0E-03,+2.0E+00\n2E-03,4\n"
RIGOL = (
    "X,CH1,Start,Increment,\nSequence,Volt,0.000000e+00,1.000000e-03\n"
    "0,1.00e+00,,\n1,2.00e+00,,\n2,4.00e+00,,\n"
)
LECROY = (
    "LECROYWS424,12345,Waveform\nSegments,1,SegmentSize,3\nSegment,TrigTime,TimeSinceSegment1\n"
    "#1,28-Nov-2026 10:00:00,0\nTime,Ampl\n0,1\n0.001,2\n0.002,4\n"
)
PICOSCOPE = "Time,Channel A\n(ms),(V)\n\n0.0,1.0\n1.0,2.0\n2.0,4.0\n"
TOA5 = (
    '"TOA5","CR1000","CPU:bench"\n"TIMESTAMP","RECORD","U_Avg"\n"TS","RN","Volts"\n"","","Avg"\n'
    '"2026-11-28 23:59:59.999",0,1\n"2026-11-29 00:00:00",1,2\n"2026-11-29 00:00:00.001",2,4\n'
)
U = {"U": "U"}
FIRST = {"1": "time", "2": "U"}
ROWS = "0,1\n0.001,2\n0.002,4\n"

KINDS: dict[str, tuple[str | bytes, dict[str, Any], str]] = {
    "tektronix": (TEKTRONIX, {"columns": CH1}, "mV"),
    "tektronix tds": (TDS, {"headings": 0, "columns": {"4": "time", "5": "U"}}, ""),
    "keysight": (KEYSIGHT, {"columns": {"1": "U"}}, "V"),
    "keysight, its channel in mV": (KEYSIGHT, {"columns": {"1": "U"}, "units": {"1": "mV"}}, "mV"),
    "rigol": (RIGOL, {"columns": CH1}, "V"),
    "lecroy": (LECROY, {"columns": {"Ampl": "U"}}, ""),
    "picoscope": (PICOSCOPE, {"columns": {"Channel A": "U"}}, "V"),
    "campbell": (TOA5, {"headings": 2, "units_row": 3, "columns": {"U_Avg": "U"}}, "V"),
    "units in the second row": ("Time;U\n[s];[kV]\n0;1\n0.001;2\n0.002;4\n", {}, "kV"),
    "excel's sep": ("sep=;\nTime [s];U [V]\n0;1\n0,001;2\n0,002;4\n", {}, "V"),
    "no brackets but a channel": (
        "Time(S),Voltage (Channel 1)\n" + ROWS,
        {"columns": {"Voltage (Channel 1)": "U"}, "units": {"Voltage (Channel 1)": "V"}}, "V"),
    "a unit in capitals": ("Time (SEC),U [KV]\n" + ROWS, {"units": {"U": "kV"}}, "kV"),
    "in front of the unit": ("Time (in s),U (in mV)\n" + ROWS, {}, "mV"),
    "no unit": ("time [s],U [-]\n" + ROWS, {}, ""),
    "three dashes": ("time [s],U [---]\n" + ROWS, {}, ""),
    "not applicable": ("time [s],U [n/a]\n" + ROWS, {}, ""),
    "percent": ("time [s],U [%]\n" + ROWS, {}, "%"),
    "another language": ("Zeit [sec],U [V]\n" + ROWS, {}, "V"),
    "milliseconds": ("Timestamp (ms),U\n0,1\n1,2\n2,4\n", {}, ""),
    "micro, Greek": ("t [\u03bcs],U\n0,1\n1000,2\n2000,4\n", {}, ""),
    "micro, Latin": ("t [\u00b5s],U\n0,1\n1000,2\n2000,4\n".encode("cp1252"),
                     {"encoding": "cp1252"}, ""),
    "degree sign": ("t,U [\u00b0]\n" + ROWS, {}, "deg"),
    "superscripts": ("t,U [m/s\u00b2]\n" + ROWS, {}, "m/s2"),
    "newton metre": ("t,U [Nm]\n" + ROWS, {}, "N.m"),
    "quotes around numbers": ('"time","U"\n"0","1"\n"0.001","2"\n"0.002","4"\n', {}, ""),
    "quotes around decimal commas": (
        '"time","U"\n"0","1"\n"0,001","2"\n"0,002","4"\n', {"decimal": ","}, ""),
    "single quotes": ("time;U\n'0';'1'\n'0.001';'2'\n'0.002';'4'\n", {}, ""),
    "clock times": ("time,U\n10:00:00,1\n10:00:00.001,2\n10:00:00.002,4\n", {}, ""),
    "over midnight": ("time,U\n23:59:59.999,1\n00:00:00,2\n00:00:00.001,4\n", {}, ""),
    "half a day": ("time,U\n11:59:59.999 AM,1\n12:00:00 PM,2\n12:00:00.001 PM,4\n", {}, ""),
    "date and time": (
        "When;U\n28.11.2026 10:00:00,000;1\n28.11.2026 10:00:00,001;2\n28.11.2026 10:00:00,002;4\n",
        {}, ""),
    "iso with zone": (
        "stamp,U\n2026-11-28T10:00:00Z,1\n2026-11-28T10:00:00.001Z,2\n2026-11-28T10:00:00.002Z,4\n",
        {}, ""),
    "a date for each row": (
        "Date,Time,U\n11/28/2026,10:00:00,1\n11/28/2026,10:00:00.001,2\n11/28/2026,10:00:00.002,4\n",
        {"columns": {"Time": "time", "U": "U"}}, ""),
    "blanks": ("time   U\n0      1\n0.001  2\n0.002  4\n", {}, ""),
    "blanks and commas": ("time [s]  U [V]\n0 1\n0,001 2\n0,002 4\n", {}, "V"),
    "headings in the last comment": ("# run: 7\n# time U\n0 1\n0.001 2\n0.002 4\n", {}, ""),
    "headings in a comment by its line": (
        "# time,U\n# more\n" + ROWS, {"headings": 1}, ""),
    "no headings": (ROWS, {"columns": FIRST}, ""),
    "no headings but names": (ROWS, {"names": ("time", "U [V]")}, "V"),
    "skipped": ("0.5,9\n0.6,9\ntime,U\n" + ROWS, {"skip": 2}, ""),
    "columns by number": ("when,volts (A),volts (A)\n0,9,1\n0.001,9,2\n0.002,9,4\n",
                          {"columns": {"1": "time", "3": "U"}, "units": {"3": "V"}}, "V"),
    "no times": ("U\tx\n1\t0\n2\t0\n4\t0\n", {"interval": 1e-3}, ""),
    "gain and shift": (
        "time,U\n0,-1\n0.001,-3\n0.002,-7\n", {"gains": {"U": -0.5}, "shifts": {"U": 0.5}}, ""),
    "carriage returns": (f"time,U\n{ROWS}".replace("\n", "\r"), {}, ""),
    "utf-16": (f"time\tU\n{ROWS}".replace(",", "\t").encode("utf-16"), {}, ""),
    "thousands": ("time;U\n0;1,000.0\n0.001;2,000.0\n0.002;4,000\n",
                  {"decimal": ".", "gains": {"U": 1e-3}}, ""),
}  # fmt: skip


def read(folder: Path, content: str | bytes, **options: Any) -> Table:
    path = folder / "bench.csv"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    layout = Layout(**{k: v for k, v in options.items() if k in LAYOUT})
    choice = Choice(**{k: v for k, v in options.items() if k not in LAYOUT})
    return read_table(path, choice, layout=layout)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_read(kind: str, tmp_path: Path) -> None:
    content, options, unit = KINDS[kind]
    table = read(tmp_path, content, **options)
    assert "U" in [c.name for c in table.columns[1:]]
    (j,) = [k for k, c in enumerate(table.columns[1:]) if c.name == "U"]
    found = table.columns[j + 1].unit
    assert found == unit or factor(found, unit) == 1.0
    np.testing.assert_allclose(table.times, [0.0, 1e-3, 2e-3], atol=1e-9)
    scale = 1e3 if kind == "tektronix" else 1.0
    np.testing.assert_allclose(table.values[:, j], np.array([1.0, 2.0, 4.0]) * scale)


WRONG: dict[str, tuple[str, dict[str, Any], list[str]]] = {
    "overflow": ("time,U\n0,1\n1,9.9E+37\n2,1\n", {}, ["line 3", "9.9e+37", "out of range"]),
    "no number of an instrument": ("time,U\n0,1\n1,-9.91E+37\n2,1\n", {}, ["line 3", "gaps"]),
    "thousands and points": ("time;U\n0;1,000\n0.001;1,224\n", {}, ["line 3", "decimal = "]),
    "thousands in quotes": ('time,U\n0,"1,000"\n1,2\n', {}, ["line 2", "'1,000'", "decimal"]),
    "a very long cell": (f"time,U\n0,1\n1,{'9' * 200_000}x\n", {}, ["line 3"]),
    "a quoted long cell": (f'time,U\n0,1\n1,"{"9" * 200_000}"\n', {}, ["line 3", "cells"]),
    "fewer headings than cells": ("time,U\n0,1,2\n1,2,3\n", {}, ["line 2", "3 cells", "2"]),
    "day or month": (
        "time,U\n01/02/2026 23:59:59,1\n02/02/2026 00:00:00,2\n", {}, ["line 3", "day and month"]),
    "no such line": ("time,U\n" + ROWS, {"headings": 9}, ["headings", "no line 9"]),
    "an encoding that is none": ("time,U\n" + ROWS, {"encoding": "klingon"}, ["'klingon'"]),
    "a gain of nothing": ("time,U\n" + ROWS, {"gains": {"V": 2.0}}, ["gains", "no column 'V'"]),
    "a channel in brackets": ("time,U (left)\n" + ROWS, {}, ["'left'", "units = "]),
}  # fmt: skip


@pytest.mark.parametrize("kind", WRONG)
def test_what_cannot_be_told_is_refused(kind: str, tmp_path: Path) -> None:
    content, options, words = WRONG[kind]
    with pytest.raises(RecordingError) as caught:
        read(tmp_path, content, **options)
    for word in ["bench.csv", *words]:
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)


def test_overflow_is_bridged_when_asked(tmp_path: Path) -> None:
    path = tmp_path / "bench.csv"
    path.write_text("time,U\n0,0\n1,9.9E+37\n2,2\n3,3\n")
    table = read_table(path, Choice(), bridge="linear")
    assert table.values[1, 0] == pytest.approx(1.0)


def test_keys_of_texts_mean_nothing_to_other_files(tmp_path: Path) -> None:
    path = tmp_path / "bench.mat"
    path.write_bytes(b"MATLAB")
    with pytest.raises(RecordingError, match=r"skip: means nothing to a \.mat file"):
        read_table(path, Choice(), layout=Layout(skip=1))
