"""What runs in a worker of dask: a piece of work, which reports its progress."""

from __future__ import annotations

import json
import threading
import time
from dataclasses import asdict
from typing import Any

from distributed import get_worker
from quietarm.metaheuristics.runs.progress import SearchProgress
from quietarm.metaheuristics.sharing.pieces import Done, Piece, Say
from quietarm.ocp import Front
from quietarm.ocp.saved import plain

_SAY_SECONDS = 0.2
_ONE_AT_A_TIME = threading.Lock()
"""More threads in a worker gain nothing; with one, nothing is built twice for casadi."""


def do_piece(topic: str, number: int, piece: Piece, known: Done) -> Any:
    """Do a piece of work in a worker."""
    teller = _Teller(topic, number)
    try:
        with _ONE_AT_A_TIME:
            teller.end_if_unwanted()
            return piece.work(known, Say(teller.report, teller.found))
    except KeyboardInterrupt:
        if teller.wanted:
            raise
        return None


class _Teller:
    """Sends the reports of a piece to the client, by the scheduler.

    The client is sent words of JSON, no Python objects: the scheduler keeps the last of them.
    """

    def __init__(self, topic: str, number: int) -> None:
        self._worker, self._topic, self._number = get_worker(), topic, number
        self._task = self._worker.get_current_task()
        self._said = -float("inf")  # the first word is heard

    @property
    def wanted(self) -> bool:
        """Whether the client is still there and has not cancelled the piece."""
        task = self._worker.state.tasks.get(self._task)
        return task is not None and task.state != "cancelled"

    def end_if_unwanted(self) -> None:
        """Raise KeyboardInterrupt, which ends a search, where nobody waits for the answer."""
        if not self.wanted:
            raise KeyboardInterrupt

    def report(self, progress: SearchProgress) -> None:
        """Say how far the piece is, a few times a second."""
        self.end_if_unwanted()
        if time.monotonic() - self._said > _SAY_SECONDS:
            self._said = time.monotonic()
            self._send(progress=json.dumps(asdict(progress)))

    def found(self, front: Front) -> None:
        """Hand over the front that there is."""
        self._send(front=json.dumps(plain(front)))

    def _send(self, **content: str) -> None:
        self._worker.log_event(self._topic, {"piece": self._number, **content})
