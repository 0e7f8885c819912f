"""What recipes share: an SSP archive as plain lists, and the figures that are compared.

Only the standard library, so that it runs in any tool's Python.
"""

from __future__ import annotations

import json
import math
import tempfile
import zipfile
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

BASE = "{http://ssp-standard.org/SSP1/SystemStructure"
SSD, SSV = f"{BASE}Description}}", f"{BASE}ParameterValues}}"
CYCLES, PER_CYCLE, FREQUENCY = 10, 100, 18.0
STEP = 1.0 / FREQUENCY / PER_CYCLE
"""The scenario that recipes run: flapping-spring-full-wings, ten cycles of 18 Hz."""


@dataclass
class Structure:
    """Components in the order in which a sequential tool should step them."""

    folder: Path
    fmus: dict[str, Path]
    starts: dict[str, dict[str, float]]
    wires: list[tuple[str, str, str, str]]

    @classmethod
    def of(cls, path: str) -> Structure:
        """Unpack an archive that `resilin export` has written."""
        folder = Path(tempfile.mkdtemp(prefix="recipe_"))
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        root = ElementTree.parse(folder / "SystemStructure.ssd").getroot()
        fmus, starts = {}, {}
        for element in root.iter(f"{SSD}Component"):
            name = element.get("name")
            fmus[name] = folder / element.get("source")
            starts[name] = {
                p.get("name"): float(p[0].get("value")) for p in element.iter(f"{SSV}Parameter")
            }
        ends = ("startElement", "startConnector", "endElement", "endConnector")
        wires = [tuple(c.get(key) for key in ends) for c in root.iter(f"{SSD}Connection")]
        return cls(folder, fmus, starts, wires)


def told(tool: str, version: str, times: list[float], angles: list[float]) -> None:
    """Print stroke [deg] and frequency [Hz] of the last cycles as JSON."""
    rows = list(zip(times, angles, strict=True))
    last = [a for t, a in rows if t > times[-1] - 1.0 / FREQUENCY - 1e-9]
    middle = 0.5 * (max(last) + min(last))
    up = [
        t0 + (middle - a0) / (a1 - a0) * (t1 - t0)
        for (t0, a0), (t1, a1) in pairwise(rows)
        if a0 < middle <= a1 and t0 > 0.5 * times[-1]
    ]
    found = {
        "tool": tool,
        "version": version,
        "stroke": math.degrees(max(last) - min(last)),
        "frequency": (len(up) - 1) / (up[-1] - up[0]) if len(up) > 1 else math.nan,
    }
    print(json.dumps(found), flush=True)
