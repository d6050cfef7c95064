"""Do pieces of work side by side: here, by processes of this machine, or by a cluster."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError
from contextlib import contextmanager
from typing import Any

from quietarm.ocp import QuietarmError
from quietarm.ocp.checks import install

_CONNECT_SECONDS = 10


class LostWorkersError(QuietarmError):
    """A worker died, or the scheduler is gone."""


def side_by_side(
    function: Callable[[Any], Any],
    items: Sequence[Any],
    workers: int = 1,
    scheduler: str | None = None,
) -> Iterator[Any]:
    """What a function gives for each item, as they end.

    In this process with one worker, else in so many of joblib's, of one thread each, or in those of
    a dask scheduler. ValueError where no scheduler answers, LostWorkersError where a worker dies.
    """
    if not items:
        return
    if scheduler is None and min(workers, len(items)) == 1:
        yield from map(function, items)
        return
    from joblib import Parallel, delayed

    with _backend(min(workers, len(items)), scheduler):
        # an item at a time, so that what ends is handed over at once
        options: Any = {"return_as": "generator_unordered", "batch_size": 1}
        running: Any = Parallel(**options)
        yield from running(delayed(function)(item) for item in items)


@contextmanager
def _backend(workers: int, scheduler: str | None) -> Iterator[None]:
    from joblib import parallel_config

    if scheduler is None:
        try:
            with parallel_config("loky", n_jobs=workers, inner_max_num_threads=1):
                yield
        except BrokenExecutor:
            raise LostWorkersError("a worker died") from None
        return
    with _connect(scheduler) as client:
        from distributed.scheduler import KilledWorker

        try:
            with parallel_config("dask", client=client):
                yield
        except (CancelledError, KilledWorker):
            raise LostWorkersError(f"the scheduler at {scheduler} is gone") from None


@contextmanager
def _connect(scheduler: str) -> Iterator[Any]:
    """A client of a dask scheduler that has workers."""
    try:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port
    except ImportError:
        raise ValueError(f"a scheduler needs dask; {install('cluster')}") from None
    # what a user has to know is said here
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL + 1)
    try:
        get_address_host_port(scheduler, strict=True)
        client = Client(scheduler, timeout=_CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ValueError(
            f"no scheduler answers at {scheduler} ({error}); start one with `dask scheduler` and "
            "give its address as tcp://host:8786, or give --workers"
        ) from None
    try:
        if not client.nthreads():
            raise ValueError(
                f"the scheduler at {scheduler} has no workers; start some with `dask worker "
                f"{scheduler}`"
            )
        yield client
    finally:
        client.close(timeout=1)
