"""The workers of dask: those of a local cluster of processes, or of a scheduler that exists."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import resource_tracker
from tempfile import TemporaryDirectory
from typing import Any

from dask import config
from distributed import Client, LocalCluster, rpc
from distributed.comm.addressing import get_address_host_port
from distributed.utils import get_mp_context
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import QuietarmError
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.record import versions

_FORKED = "forkserver" in multiprocessing.get_all_start_methods()
"""Whether a process that only loads what all workers need can be forked into each of them."""
DEATHS = 3
"""Workers that a piece may cost before it is given up."""
_CONFIG = {
    "distributed.scheduler.allowed-failures": DEATHS - 1,
    "distributed.admin.low-level-log-length": 100,  # of every topic the scheduler keeps so many
    # A hundred samples of the stack a second and fifty ticks each take the interpreter from a
    # search, which took more than twice as long.
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    # On a busy machine everything takes long: dask's warnings about that are left out.
    "distributed.comm.timeouts.connect": "300s",
    "distributed.worker.multiprocessing-method": "forkserver" if _FORKED else "spawn",
    # With dask's 64 kB arrays go back to the system all the time: a sweep took a quarter longer.
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": str(1 << 27),
    "distributed.nanny.pre-spawn-environ.MALLOC_MMAP_THRESHOLD_": str(1 << 25),
    "distributed.nanny.pre-spawn-environ.PYTHONWARNINGS": "ignore::UserWarning",
}
_PACKAGES = {"distributed", "models", "ocp", "metaheuristics", "studies"}
_CONNECT_SECONDS = 10
_GUARD = (
    "the workers could not be started; in a script of your own run it under "
    "if __name__ == '__main__', or with one worker"
)


@dataclass(frozen=True)
class Cluster:
    """Workers that can be given work."""

    client: Client
    size: Callable[[], int]
    name: str


@contextmanager
def connected(workers: Workers, pieces: int) -> Iterator[Cluster]:
    """The workers that were asked for; those that are started here end with the block."""
    logger = logging.getLogger("distributed")
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)  # what a user has to know is said here
    try:
        address = workers.scheduler
        with _local(workers.local(pieces)) if address is None else _existing(address) as cluster:
            yield cluster
    finally:
        logger.setLevel(level)


@contextmanager
def _local(number: int) -> Iterator[Cluster]:
    with config.set(_CONFIG), TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        # nothing is left half started
        with note_interrupts() as came, _deaf_to_interrupts(), warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            _load_for_all_workers()
            try:
                cluster = LocalCluster(
                    n_workers=number,
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address=None,  # pyright: ignore[reportArgumentType]
                    memory_limit=None,
                    local_directory=folder,
                    silence_logs=logging.CRITICAL + 1,
                )
            except RuntimeError as error:
                raise QuietarmError(_GUARD) from error
            client = Client(cluster, set_as_default=False)
        try:
            if came:
                raise KeyboardInterrupt
            yield Cluster(client, lambda: number, "the workers of this machine")
        finally:
            with note_interrupts():
                _end(cluster)
                client.close()
                cluster.close()


def _load_for_all_workers() -> None:
    """Have what is loaded here loaded once for all workers, not by each of them."""
    if _FORKED:
        context = get_mp_context()  # which names other modules, for dask's own tests
        loaded = [name for name in sys.modules if name.partition(".")[0] in _PACKAGES]
        context.set_forkserver_preload(loaded)


def _end(cluster: LocalCluster) -> None:
    """End the workers at once, whatever they do: what they found has been handed over."""
    for nanny in cluster.workers.values():
        nanny.close_gracefully()  # else it starts the worker again while the cluster ends
        with suppress(ProcessLookupError):  # it ended by itself, but its nanny has not noticed
            if nanny.pid:
                os.kill(nanny.pid, getattr(signal, "SIGKILL", signal.SIGTERM))


def _ask(address: str) -> None:
    """Ask a scheduler who it is; OSError where none answers in time.

    A client waits for ever where something else listens and says nothing. The thread is left alone
    then: it ends with the process.
    """
    heard: list[Any] = []

    async def identity() -> Any:
        async with rpc(address) as scheduler:
            return await scheduler.identity()

    def ask() -> None:
        try:
            heard.append(asyncio.run(asyncio.wait_for(identity(), _CONNECT_SECONDS)))
        except Exception as error:
            heard.append(error)

    asking = threading.Thread(target=ask, daemon=True)
    asking.start()
    asking.join(_CONNECT_SECONDS)
    answer = heard[0] if heard else TimeoutError("it says nothing")
    if isinstance(answer, Exception):
        raise OSError(str(answer) or "it says nothing")


@contextmanager
def _existing(address: str) -> Iterator[Cluster]:
    try:  # before there is a client: one without a scheduler takes long to end, and fails
        get_address_host_port(address, strict=True)
    except ValueError:
        raise ValueError(f"scheduler is {address!r}; give it as tcp://host:8786") from None
    try:
        _ask(address)
        client = Client(address, timeout=_CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ValueError(
            f"no scheduler answers at {address} ({error}); start one with `dask scheduler`, or "
            "give --workers"
        ) from None
    try:
        _check_versions(client, address)
        yield Cluster(client, lambda: len(_awaited(client.nthreads())), _called(address))
    finally:
        with note_interrupts():
            client.close(timeout=1)


def _called(address: str) -> str:
    return f"the scheduler at {address}"


def _awaited(answer: Any) -> dict[str, Any]:
    """An answer of this client, which never is a coroutine as dask's types would have it."""
    return answer


def _check_versions(client: Client, address: str) -> None:
    remedy = "install the same as here, with quietarm[cluster], for every worker"
    try:
        theirs = _awaited(client.run(versions))
    except ImportError as error:
        raise QuietarmError(f"a worker of {address} has no quietarm ({error}); {remedy}") from None
    if not theirs:
        raise QuietarmError(
            f"{_called(address)} has no workers; start some with `dask worker {address}`"
        )
    for worker, found in theirs.items():
        for name, version in versions().items():
            if found.get(name) != version:
                raise QuietarmError(
                    f"the worker {worker} has {name} {found.get(name)}, here it is {version}; "
                    f"{remedy}"
                )


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Let the threads and processes that start here see neither Ctrl-C nor the end of a batch job.

    Both are sent to every process of a group, but it is this one that ends the others. Workers that
    take the place of others are started by these threads, and are deaf as well.
    """
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()  # its own start would let the signal through again
    stops = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, stops)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
