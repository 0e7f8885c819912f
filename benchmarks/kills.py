"""Runs and sweeps that are killed at random times: what is left of each, and that nothing is false.

    python benchmarks/kills.py [--kills 100] [--signals 30] [--seed 0]       needs `resilin build`

Each killed run writes a segment every `PATIENCE` seconds. Counted are whole results under the final
name (none may be there), segment folders that `recover` makes a readable file of, without gaps, and
the temporary folders that stopped runs leave. A sweep is killed half way, goes on, and is compared
bit by bit with one that was not disturbed.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import xarray

PATIENCE = 0.2
"""Seconds between two segments, in the place of a minute."""
RUN = f"""
import sys
from orchestrator.simulation.observers import Recorder
Recorder.PATIENCE = {PATIENCE}
from orchestrator.cli import app
sys.argv = ["resilin", "run", "oscillator-1", "--stop", "400000 cycles", "--no-picture",
            "--quiet", "--output", sys.argv[1]]
app()
"""
SWEEP = [
    "sweep",
    "oscillator-1",
    "--over",
    "amplifier.frequency=40:63:0.1Hz",
    "--stop",
    "300 cycles",
]
LONGEST = 4.0
"""Seconds after which a run is killed at the latest."""


def begun(folder: Path) -> subprocess.Popen[bytes]:
    """A long run in a session of its own, whose temporary files go into the folder."""
    (folder / "temporary").mkdir()
    return subprocess.Popen(
        [sys.executable, "-c", RUN, str(folder / "out.nc")],
        env={**os.environ, "TMPDIR": str(folder / "temporary")},
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def killed(folder: Path, after: float) -> str:
    """What a run has left that was killed: `recovered`, `before its first segment`, or a fault."""
    process = begun(folder)
    time.sleep(after)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    if (folder / "out.nc").exists():
        return "FAULT: a result under the final name"
    if not (folder / "out.segments" / "manifest.json").is_file():
        return "before its first segment was whole"
    done = subprocess.run(
        [sys.executable, "-m", "orchestrator.cli", "recover", str(folder / "out.segments")],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        return f"FAULT: not recovered: {done.stderr.strip()}"
    (found,) = folder.glob("out*.nc")
    with xarray.open_dataset(found) as data:
        rows = data.sizes["time"]
        steps = data["time"].diff("time")
        whole = rows > 1 and float(steps.max()) < 1.5 * float(steps.min())
    return "recovered" if whole else "FAULT: a gap in the recovered rows"


def stopped(folder: Path, after: float, number: signal.Signals) -> str:
    """What a run has left that was stopped by a signal."""
    process = begun(folder)
    time.sleep(after)
    process.send_signal(number)
    code = process.wait()
    if code == -number:
        return "before it looked for signals"
    if code != 128 + number:
        return f"FAULT: exit code {code}"
    if not (folder / "out.partial.nc").exists():
        return "stopped before its first row"
    with xarray.open_dataset(folder / "out.partial.nc") as data:
        return "rows kept" if data.sizes["time"] > 0 else "FAULT: no rows"


def resumed(folder: Path, after: float) -> str:
    """Whether a sweep that was killed and went on equals one that was not."""

    def command(name: str) -> list[str]:
        made = [sys.executable, "-m", "orchestrator.cli", *SWEEP, "--quiet"]
        return [*made, "--output", str(folder / f"{name}.nc")]

    process = subprocess.Popen(command("killed"), start_new_session=True)
    time.sleep(after)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    before = "finished before" if (folder / "killed.nc").exists() else "half way"
    for name in ("killed", "whole"):
        subprocess.run(command(name), check=True)
    with (
        xarray.open_dataset(folder / "killed.nc") as one,
        xarray.open_dataset(folder / "whole.nc") as other,
    ):
        apart = {"wall_time", "calls"} | {n for n in one.variables if "wall" in str(n)}
        names = [n for n in one.data_vars if n not in apart]
        same = all(one[n].equals(other[n]) for n in names)
    return f"killed {before}, the same bits" if same else f"FAULT: killed {before}, other numbers"


def main() -> None:
    """Kill, stop and resume; print what was left, and leave with 1 where anything is false."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--signals", type=int, default=30)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    choice = random.Random(given.seed)
    left = 0
    kinds: dict[str, Counter[str]] = {"SIGKILL": Counter(), "sweep": Counter()}
    for k in range(given.kills + given.signals + 1):
        folder = Path(tempfile.mkdtemp(prefix="kills-"))
        after = choice.uniform(0.3, LONGEST)
        if k < given.kills:
            kinds["SIGKILL"][killed(folder, after)] += 1
        elif k < given.kills + given.signals:
            number = choice.choice([signal.SIGINT, signal.SIGTERM])
            told = stopped(folder, after, number)
            kinds.setdefault(number.name, Counter())[told] += 1
            left += len(list((folder / "temporary").iterdir()))
        else:
            kinds["sweep"][resumed(folder, 4.0 + after)] += 1
        shutil.rmtree(folder)
    for kind, found in kinds.items():
        for told, count in found.most_common():
            print(f"{kind:8} {count:4} {told}")
    print(f"folders left by stopped runs: {left}")
    sys.exit(any("FAULT" in told for found in kinds.values() for told in found))


if __name__ == "__main__":
    main()
