"""How a process that hosts FAULTY ends: `python -m tests.foreign.faults JOBS`.

JOBS is a JSON list of pairs of an FMU and the fault to set, or null to leave it as built. Each
runs in a process of its own. Prints a JSON list: how each ended, what the host observed and how
much was written to stdout.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.foreign.host import FMICallException, hosted
from tests.foreign.scenarios import HANGS
from tests.processes import POLL, REACHED

PATIENCE = 0.5
"""Seconds that a process may go on after it has reached its fault_time, or its hang."""
SPARE_MEMORY = 128 << 20
STEP, STEPS = 0.25, 4


@dataclass(frozen=True)
class Job:
    """A running process and the folder it reports to."""

    process: int
    folder: Path
    hangs: bool


def observed(fmu: Path, fault: int | None) -> dict[str, Any]:
    """What a host observes in four steps with a fault, of which the second reaches fault_time."""
    logged: list[tuple[int, bytes]] = []
    found: dict[str, Any] = {"steps": []}
    try:
        with hosted(fmu, lambda status, message: logged.append((status, message))) as host:
            host.start(u=1.0, gain=3.0, **({} if fault is None else {"fault": fault}))
            while host.time < STEP * STEPS:
                report = host.step(STEP)
                found["steps"].append([host.time, str(host.get("y")), report])
    except FMICallException as caught:
        found["status"] = caught.status
    found["logged"] = sum(len(message) for _, message in logged)
    found["last"] = logged[-1][1].decode() if logged else ""
    return found


def begun(fmu: Path, fault: int | None, folder: Path) -> Job:
    """Run `observed` in a process with little memory, no core file and stdout in a file."""
    folder.mkdir()
    process = os.fork()
    if process:
        # only the hang that no parameter can ask for has to be built in
        return Job(process, folder, fault is None or fault in HANGS)
    code = 70
    try:
        with (folder / "stdout").open("wb") as stdout, (folder / "stderr").open("wb") as stderr:
            os.dup2(stdout.fileno(), 1)
            os.dup2(stderr.fileno(), 2)
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + SPARE_MEMORY, used + SPARE_MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        os.environ[REACHED] = str(folder / "reached")
        (folder / "observed.json").write_text(json.dumps(observed(fmu, fault)))
        code = 0
    finally:
        os._exit(code)


def ended(job: Job) -> dict[str, Any]:
    """How a job ended and what it observed; one that is meant to hang is killed once it does."""
    end = _end(job)
    path = job.folder / "observed.json"
    found: dict[str, Any] = json.loads(path.read_text()) if path.exists() else {}
    return {**found, "end": end, "stdout": (job.folder / "stdout").stat().st_size}


def _end(job: Job) -> str:
    """How a process ended: `exit 0`, `SIGSEGV` or `hang`."""
    waited = 0.0
    while True:
        done, status = os.waitpid(job.process, os.WNOHANG)
        if done:
            break
        if waited > PATIENCE:
            os.kill(job.process, signal.SIGKILL)
            os.waitpid(job.process, 0)
            return "hang"
        time.sleep(POLL)
        if job.hangs and (job.folder / "reached").exists():
            waited += POLL
    code = os.waitstatus_to_exitcode(status)
    return f"exit {code}" if code >= 0 else signal.Signals(-code).name


def main(jobs: list[tuple[str, int | None]]) -> None:
    """Run all jobs side by side."""
    with tempfile.TemporaryDirectory() as folder:
        running = [
            begun(Path(fmu), fault, Path(folder, str(number)))
            for number, (fmu, fault) in enumerate(jobs)
        ]
        json.dump([ended(job) for job in running], sys.stdout)


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
