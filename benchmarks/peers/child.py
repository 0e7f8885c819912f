"""One run in a process of its own: `python -m peers.child CASE TOOL METHOD REPEATS RESULT`.

Only the stepping of the loaded case is timed; the least of the repeats counts, and one run is
enough where it takes longer than `LONG`. The result goes into a file, so that a tool may print
anything, and may crash the process.
"""

from __future__ import annotations

import gc
import json
import sys
import traceback
from pathlib import Path
from time import perf_counter
from typing import Any

from .case import Case, read
from .tools import TOOLS
from .tools.base import Tool, Track

LONG = 10.0


def timed(tool: Tool, case: Case, method: str) -> tuple[float, Track]:
    """One run on fresh instances and its time."""
    with tool.load(case, method) as march:
        gc.collect()
        begun = perf_counter()
        track = march()
        return perf_counter() - begun - track.aside, track


def measured(tool: Tool, case: Case, method: str, repeats: int) -> dict[str, Any]:
    """Result of a run, for the parent process."""
    wall, track = timed(tool, case, method)
    for _ in range(repeats - 1 if wall <= LONG else 0):
        again, _ = timed(tool, case, method)
        wall = min(wall, again)
    found = {"times": track.times, "rows": track.rows, "calls": track.calls}
    return {"status": "done", "version": tool.version(), "wall": wall, **found}


def main(arguments: list[str]) -> None:
    case, name, method, repeats, result = arguments
    tool = TOOLS[name]
    found: dict[str, Any]
    if lacking := tool.missing():
        found = {"status": "not installed", "reason": f"{lacking}; {tool.install}"}
    else:
        try:
            found = measured(tool, read(Path(case)), method, int(repeats))
        except Exception as error:
            traceback.print_exc()
            text = str(error).strip().splitlines() or [""]
            reason = f"{type(error).__name__}: {text[0]}"
            found = {"status": "stopped", "reason": reason, "version": tool.version()}
    waiting = Path(f"{result}.part")
    waiting.write_text(json.dumps(found), encoding="utf-8")
    waiting.replace(result)


if __name__ == "__main__":
    main(sys.argv[1:])
