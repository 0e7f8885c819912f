"""Worker processes of dask.distributed: started here on loopback, or reached at an address."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import pickle
import signal
import sys
import warnings
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from ...errors import InputError, SimulationError, printable
from ...simulation.scratch import Scratch

Client = Any
"""A `distributed.Client`, which has no type annotations."""

PACKAGES = ("distributed", "cryptography")
"""What is imported here, the second for the certificate of :func:`local`."""

HOST = "127.0.0.1"
CONNECTING = 10.0
"""Seconds within which a scheduler has to answer."""

SETTINGS: dict[str, Any] = {
    "distributed.scheduler.allowed-failures": 0,
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.scheduler.work-stealing": False,
    "distributed.scheduler.worker-ttl": None,
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.worker.profile.enabled": False,
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
    "distributed.deploy.lost-worker-timeout": 1e9,
}
"""A task whose worker ends fails at once; a worker that is busy or large is left alone.

By default a `LocalCluster` closes the nanny of a worker that is not there some seconds after its
process has ended, also where the next one starts slowly or has ended again. With the last setting
nannies always start another process.
"""

SAFE = {"PYTHONSAFEPATH": "1"}
"""Environment of workers and of what starts them: they import nothing from the current folder."""

PRELOADED = [
    "orchestrator.simulation.load",
    "orchestrator.simulation.run",
    "orchestrator.results.metrics",
]
"""Modules that a worker imports before it registers, so that no point waits for them."""

LOGGERS = ("distributed", "distributed.client", "tornado.application")
IN_TERMINAL = {"SIGINT", "SIGHUP"}
"""Signals that a terminal sends to workers too, although they are meant for the sweep alone."""


@contextlib.contextmanager
def local(count: int) -> Iterator[Client]:
    """A client of `count` worker processes of one thread each, on loopback, without dashboard.

    They talk by TLS with a certificate of this cluster's own, made here and kept in memory: whoever
    can reach a scheduler can have it run anything, and on loopback that is every user of the
    machine.
    They leave nothing behind: their temporary files share one folder, and at the end they are
    killed, so that no FMU's library is unloaded, which may crash an interpreter.
    """
    import dask

    distributed = _distributed()
    with contextlib.ExitStack() as stack:
        stack.enter_context(_quiet())
        stack.enter_context(_same_environment())
        scratch = str(stack.enter_context(Scratch(Path("workers"))))
        stack.enter_context(dask.config.set({**SETTINGS, "temporary-directory": scratch}))
        security = distributed.Security.temporary()
        os.environ.update(SAFE)
        try:
            with _signals_kept_from_children():
                cluster = distributed.LocalCluster(
                    n_workers=count,
                    threads_per_worker=1,
                    processes=True,
                    host=HOST,
                    protocol="tls://",
                    security=security,
                    scheduler_kwargs={"dashboard": False, "dashboard_address": f"{HOST}:0"},
                    silence_logs=logging.CRITICAL,
                    local_directory=scratch,
                    env={"TMPDIR": scratch, **SAFE},
                    preload=PRELOADED,
                )
        except (OSError, RuntimeError) as error:
            raise SimulationError(
                f"no worker processes can be started: {error} A script that sweeps has to be a"
                " file, and has to call sweep below `if __name__ == '__main__':`"
            ) from None
        stack.callback(_close, cluster)
        client = stack.enter_context(distributed.Client(cluster, set_as_default=False))
        stack.callback(_end_all, client)
        yield client


@contextlib.contextmanager
def remote(address: str) -> Iterator[Client]:
    """A client of a running scheduler; its workers are left as they are."""
    distributed = _distributed()
    with contextlib.ExitStack() as stack:
        stack.enter_context(_quiet())
        try:
            with ThreadPoolExecutor(1) as beside:  # an event loop may run here, as in Jupyter
                beside.submit(asyncio.run, _answers(address)).result()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # other versions of packages
                client = distributed.Client(address, timeout=CONNECTING, set_as_default=False)
        except (OSError, TimeoutError, TypeError, ValueError) as error:
            raise InputError(
                f"scheduler {printable(address)!r}: no answer ({_reason(error)}); start one with"
                " `dask scheduler`, write it as tcp://host:8786, or leave it out to work on this"
                " machine"
            ) from None
        stack.enter_context(client)
        yield client


async def _answers(address: str) -> None:
    """Ask a scheduler for its identity: a client waits for ever for one that does not answer."""
    distributed = _distributed()
    secured = distributed.Security().get_connection_args("client")
    scheduler = distributed.rpc(address, connection_args=secured)
    try:
        await asyncio.wait_for(scheduler.identity(), CONNECTING)
    finally:
        await scheduler.close_rpc()


def _reason(error: Exception) -> str:
    return printable(str(error)) or f"nothing within {CONNECTING:g} s"


def _distributed() -> Any:
    """The package, imported on demand: its import takes as long as that of all others."""
    import distributed

    return distributed


def nannies(client: Client) -> set[str]:
    """Addresses of the nannies of the registered workers; a worker may have none."""
    workers = client.scheduler_info(n_workers=-1)["workers"].values()
    return {worker["nanny"] for worker in workers if worker.get("nanny")}


def starting(client: Client, addresses: Iterable[str]) -> dict[str, int | None]:
    """The process that each nanny is starting, by the address of the nanny.

    `None` where a nanny is between two processes; a nanny that does not answer is left out.
    """
    found: dict[str, int | None] = client.sync(_starting, list(addresses), client.security)
    return found


async def _starting(addresses: list[str], security: Any) -> dict[str, int | None]:
    distributed = _distributed()
    secured = security.get_connection_args("client")
    asked = pickle.dumps(_process)
    found = {}
    for address in addresses:
        nanny = distributed.rpc(address, connection_args=secured)
        try:
            answer = await asyncio.wait_for(nanny.run(function=asked), CONNECTING)
            found[address] = answer["result"]
        except (OSError, TimeoutError):
            continue
        finally:
            await nanny.close_rpc()
    return found


def _process(dask_worker: Any) -> int | None:
    """Process of a nanny's worker; runs in the nanny."""
    process: int | None = dask_worker.pid
    return process


def end(client: Client, address: str) -> None:
    """Kill a worker process through its nanny, which starts another; does nothing without one."""
    with contextlib.suppress(Exception):
        client.run(_kill, nanny=True, workers=[address])


def _close(cluster: Any) -> None:
    """Close a cluster whose workers are killed, whether or not they end within its timeout."""
    with contextlib.suppress(OSError, TimeoutError, RuntimeError):
        cluster.close()


def _end_all(client: Client) -> None:
    with contextlib.suppress(Exception):
        client.run(_kill_for_good, nanny=True, on_error="ignore")


def _kill(dask_worker: Any) -> None:
    """Kill the worker process of a nanny; runs in the nanny."""
    if dask_worker.pid is not None:
        os.kill(dask_worker.pid, getattr(signal, "SIGKILL", signal.SIGTERM))


def _kill_for_good(dask_worker: Any) -> None:
    dask_worker.close_gracefully()
    _kill(dask_worker)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep dask's logs off standard error: what matters is raised as errors."""
    _distributed()  # sets the levels that are put back
    loggers = [logging.getLogger(name) for name in LOGGERS]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


@contextlib.contextmanager
def _same_environment() -> Iterator[None]:
    """Restore this process's environment, which starting workers changes."""
    before = dict(os.environ)
    try:
        yield
    finally:
        for name in [name for name in os.environ if name not in before]:
            del os.environ[name]
        os.environ.update(before)


@contextlib.contextmanager
def _signals_kept_from_children() -> Iterator[None]:
    """Block Ctrl-C while threads start: they and the processes they start never get it."""
    if sys.platform == "win32":
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # starts on its own otherwise, and unblocks Ctrl-C again
    held = {number for number in signal.valid_signals() if _name(number) in IN_TERMINAL}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, held)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _name(number: int) -> str:
    return number.name if isinstance(number, signal.Signals) else ""
