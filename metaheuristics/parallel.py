"""Do pieces of work side by side: here, by processes of this machine, or by a cluster."""

from __future__ import annotations

import logging
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, ThreadPoolExecutor
from contextlib import contextmanager
from threading import Thread
from typing import Any

from quietarm.models.plant_file import WithPlantFiles
from quietarm.ocp import QuietarmError
from quietarm.ocp.checks import install

MOST_WORKERS = 1024
"""Processes of one machine."""
_ANSWER_SECONDS = 10
"""In which a scheduler answers, and within which it has a worker again that has lost the last."""
_LOOK_SECONDS = 2
"""Of silence, after which it is asked whether it is still there."""


class LostWorkersError(QuietarmError):
    """A worker died, or the scheduler is gone."""


def side_by_side(
    function: Callable[[Any], Any],
    items: Sequence[Any],
    workers: int | str = 1,
    *,
    apart: bool = False,
) -> Iterator[Any]:
    """Call a function for each item and yield the results as they end.

    In this process with one worker, unless all is to be `apart` from it, else in so many of
    joblib's, of one thread each; or in those of the dask scheduler whose address stands in place of
    a number. ValueError where no scheduler answers, LostWorkersError where a worker dies.
    """
    if not items:
        return
    sent = WithPlantFiles(function)
    if isinstance(workers, str):
        yield from _on_cluster(sent, items, workers)
    elif min(workers, len(items)) == 1 and not apart:
        yield from map(function, items)
    else:
        # joblib has one worker's work done in this process
        yield from _in_processes(sent, items, max(min(workers, len(items)), 2))


def _in_processes(
    function: Callable[[Any], Any], items: Sequence[Any], workers: int
) -> Iterator[Any]:
    """Call in joblib's processes, which end soon after this one, however it ends."""
    from joblib import Parallel, delayed, parallel_config

    watched: Any = {"initializer": _watch_parent, "initargs": (os.getpid(),)}
    try:
        with parallel_config(
            "loky",
            n_jobs=workers,
            inner_max_num_threads=1,
            **watched,
        ):
            # an item at a time, so that what ends is handed over at once
            options: Any = {"return_as": "generator_unordered", "batch_size": 1}
            running: Any = Parallel(**options)
            yield from running(delayed(function)(item) for item in items)
    except BrokenExecutor:
        raise LostWorkersError("a worker died") from None


def _watch_parent(parent: int) -> None:
    """Let this process end when its parent has; else it would wait for work for minutes."""
    Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: int) -> None:
    if sys.platform == "win32":
        import _winapi

        process = _winapi.OpenProcess(_winapi.SYNCHRONIZE, False, parent)
        _winapi.WaitForSingleObject(process, _winapi.INFINITE)
    else:
        while os.getppid() == parent:
            time.sleep(1)
    os._exit(1)


def _on_cluster(
    function: Callable[[Any], Any], items: Sequence[Any], scheduler: str
) -> Iterator[Any]:
    """Call in the workers of a dask scheduler, even if it has one of one thread."""
    with _connect(scheduler) as client:
        from distributed import as_completed
        from distributed.scheduler import KilledWorker

        futures = client.map(function, items, pure=False)
        ended = as_completed(futures, loop=client.loop)
        patience = _Patience(scheduler)
        try:
            while ended.count():
                for future in ended.next_batch(block=False):
                    patience.renew()
                    yield future.result()
                patience.wait()
        except (CancelledError, KilledWorker):
            raise LostWorkersError(f"the scheduler at {scheduler} is gone") from None
        finally:
            client.cancel([future for future in futures if not future.done()])


class _Patience:
    """Waits for a cluster, as long as it has workers."""

    def __init__(self, scheduler: str) -> None:
        self._scheduler = scheduler
        self.renew()

    def renew(self) -> None:
        """Something has come: ask again only after a while."""
        self._looked = self._seen = time.monotonic()

    def wait(self) -> None:
        """Wait a moment; LostWorkersError where there has been nobody to wait for."""
        time.sleep(0.02)
        if time.monotonic() - self._looked < _LOOK_SECONDS:
            return
        try:
            threads = _threads_of(self._scheduler)
        except Exception:  # of any of its protocols
            raise LostWorkersError(f"the scheduler at {self._scheduler} is gone") from None
        self._looked = time.monotonic()
        if threads:
            self._seen = self._looked
        elif self._looked - self._seen > _ANSWER_SECONDS:
            raise LostWorkersError(f"all workers of the scheduler at {self._scheduler} are gone")


def scheduler_address(text: str) -> str:
    """The address of a dask scheduler; ValueError where there is none."""
    if not text.strip():
        raise ValueError("the scheduler's address is empty; give one, such as tcp://host:8786")
    return text


def _threads_of(scheduler: str) -> int:
    """Return how many threads a scheduler's workers have; any error if it does not answer."""
    import asyncio  # not needed by commands that plan, whose start it would delay

    from distributed.core import rpc
    from distributed.security import Security

    async def ask() -> int:
        arguments = Security().get_connection_args("client")
        there: Any = rpc(
            scheduler,
            timeout=_ANSWER_SECONDS,
            connection_args=arguments,
        )
        async with there:
            threads = await there.ncores()
        return sum(threads.values())

    async def ask_in_time() -> int:
        return await asyncio.wait_for(ask(), _ANSWER_SECONDS)

    with ThreadPoolExecutor(1) as thread:  # in a notebook this one has a loop of its own
        return thread.submit(asyncio.run, ask_in_time()).result()


def reach_scheduler(workers: int | str) -> None:
    """Find out whether a scheduler answers and has workers; ValueError with a remedy if not.

    Of a number of processes there is nothing to find out.
    """
    if not isinstance(workers, str):
        return
    scheduler = workers
    try:
        from distributed.comm.addressing import get_address_host_port
    except ImportError:
        raise ValueError(f"a scheduler needs dask; {install('cluster')}") from None
    scheduler_address(scheduler)
    # what a user has to know is said here
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)
    try:
        get_address_host_port(scheduler, strict=True)
        threads = _threads_of(scheduler)
    except Exception as error:  # of any of its protocols, as tls without certificates
        reason = str(error) or f"not within {_ANSWER_SECONDS} s"
        raise ValueError(
            f"no scheduler answers at {scheduler} ({reason}); start one with `dask scheduler` and "
            "give its address as tcp://host:8786, or give --workers"
        ) from None
    if not threads:
        raise ValueError(
            f"the scheduler at {scheduler} has no workers; start some with `dask worker "
            f"{scheduler}`"
        )


@contextmanager
def _connect(scheduler: str) -> Iterator[Any]:
    """A client of a dask scheduler that has workers."""
    reach_scheduler(scheduler)
    from distributed import Client

    client = Client(scheduler, timeout=_ANSWER_SECONDS, set_as_default=False)
    try:
        yield client
    finally:
        client.close(timeout=1)
