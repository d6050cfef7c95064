"""Where work is done: in this process, in processes of this machine, or on a cluster."""

from __future__ import annotations

import os
from dataclasses import dataclass
from importlib.util import find_spec

from quietarm.ocp.checks import install, whole

MOST_WORKERS = 1000
_FEW = 4
"""More processes than this are started only where they are asked for: each takes memory."""


@dataclass(frozen=True)
class Workers:
    """Where pieces of work are done."""

    number: int = 1
    scheduler: str | None = None

    def __post_init__(self) -> None:
        because = "each is a process with 0.1 GB of memory"
        object.__setattr__(self, "number", whole("workers", self.number, 1, MOST_WORKERS, because))
        if self.scheduler is not None and self.number > 1:
            raise ValueError(
                f"workers is {self.number} and the scheduler {self.scheduler} has its own; give "
                "one of them"
            )
        if self.scheduler is not None and find_spec("distributed") is None:
            raise ValueError(f"a scheduler needs dask; leave it out, or {install('cluster')}")

    def local(self, pieces: int) -> int:
        """How many processes are started here for so many pieces."""
        return 0 if self.scheduler is not None else min(self.number, pieces)


def cores_at_hand() -> int:
    """How many processes share long work best: the cores of this process, a few at most."""
    return min(cores_here(), _FEW)


def cores_here() -> int:
    """The cores that this process may use; a batch queue gives it fewer than the machine has."""
    able = getattr(os, "sched_getaffinity", None)  # not on every system
    return len(able(0)) if able else os.cpu_count() or 1


HERE = Workers()
"""In this process."""
