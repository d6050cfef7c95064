"""Workers that a scheduler of dask has, and what runs in them."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue
from typing import Any
from uuid import uuid4

from distributed import Client, get_worker
from distributed.comm.addressing import get_address_host_port
from quietarm.metaheuristics.runs.progress import SearchProgress
from quietarm.metaheuristics.sharing.pieces import Done, Piece, Say, Tell, in_worker
from quietarm.ocp import Front, QuietarmError
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.record import versions
from quietarm.ocp.saved import plain, typed

_CONNECT_SECONDS = 10
_SAY_SECONDS = 0.2
_ONE_AT_A_TIME = threading.Lock()
"""More threads in a worker gain nothing; with one, nothing is built twice for casadi."""


@contextmanager
def scheduler_at(address: str, tell: Tell) -> Iterator[Scheduler]:
    """The workers of a scheduler; after the block they do nothing more for this process."""
    logger = logging.getLogger("distributed")
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)  # what a user has to know is said here
    try:
        client = _client_of(address)
        try:
            _check_versions(client, address)
            yield Scheduler(client, tell)
        finally:
            with note_interrupts():
                client.close(timeout=1)
    finally:
        logger.setLevel(level)


class Scheduler:
    """A scheduler that runs already."""

    def __init__(self, client: Any, tell: Tell) -> None:
        self._client, self._tell, self._topic = client, tell, f"quietarm-{uuid4().hex}"
        self._pool = client.get_executor(pure=False)
        client.subscribe_topic(self._topic, self._hear)

    @property
    def size(self) -> int:
        """How many workers it has now; 0 once it is gone."""
        try:
            return max(1, len(self._client.nthreads()))
        except Exception:
            if self._client.status == "running":
                raise
            return 0

    def submit(self, number: int, piece: Piece, known: Done) -> Future[Any]:
        """Have a piece done."""
        return self._pool.submit(_do, self._topic, number, piece, known)

    def _hear(self, event: tuple[float, dict[str, Any]]) -> None:
        """Take what a piece tells, which came as plain numbers: the scheduler keeps some of it."""
        _, said = event
        kind = SearchProgress if "generation" in said["what"] else Front
        self._tell(said["piece"], typed(said["what"], kind))


def _do(topic: str, number: int, piece: Piece, known: Done) -> Any:
    """Do a piece in a worker, as long as the client is there and wants it."""
    worker, said = get_worker(), 0.0
    task = worker.get_current_task()

    def tell(what: SearchProgress | Front) -> None:
        worker.log_event(topic, {"piece": number, "what": plain(what)})

    def end_if_unwanted() -> None:
        state = worker.state.tasks.get(task)
        if state is None or state.state == "cancelled":
            raise KeyboardInterrupt  # which ends a search

    def report(progress: SearchProgress) -> None:
        nonlocal said
        end_if_unwanted()
        if time.monotonic() - said > _SAY_SECONDS:
            said = time.monotonic()
            tell(progress)

    try:
        with _ONE_AT_A_TIME:
            end_if_unwanted()
            return in_worker(piece, known, Say(report, tell))
    except KeyboardInterrupt:
        return None


def _client_of(address: str) -> Any:
    """A client, made in a thread: where something listens that says nothing, it waits for ever."""
    try:  # before there is a client: it fails in other words
        get_address_host_port(address, strict=True)
    except ValueError:
        raise ValueError(f"scheduler is {address!r}; give it as tcp://host:8786") from None
    heard = SimpleQueue[Any]()

    def connect() -> None:
        try:
            heard.put(Client(address, timeout=_CONNECT_SECONDS, set_as_default=False))
        except Exception as error:
            heard.put(error)

    threading.Thread(target=connect, daemon=True).start()
    answer: Any = TimeoutError("it says nothing")
    with suppress(Empty):
        answer = heard.get(timeout=_CONNECT_SECONDS + 1)
    if isinstance(answer, Exception):
        raise ValueError(
            f"no scheduler answers at {address} ({answer}); start one with `dask scheduler`, or "
            "give --workers"
        )
    return answer


def _check_versions(client: Any, address: str) -> None:
    remedy = "install the same as here, with quietarm[cluster], for every worker"
    try:
        theirs = client.run(versions)
    except ImportError as error:
        raise QuietarmError(f"a worker of {address} has no quietarm ({error}); {remedy}") from None
    if not theirs:
        raise QuietarmError(
            f"the scheduler at {address} has no workers; start some with `dask worker {address}`"
        )
    for worker, found in theirs.items():
        for name, version in versions().items():
            if found.get(name) != version:
                raise QuietarmError(
                    f"the worker {worker} has {name} {found.get(name)}, here it is {version}; "
                    f"{remedy}"
                )
