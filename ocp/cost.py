"""Work that was computed so far in this thread, by which methods are compared."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import local
from typing import Literal


@dataclass
class Cost:
    """Work of a thread: motions simulated, processor seconds of CVODES and of compilation.

    `candidates` are simulated for their values alone, the others with first or second derivatives.
    """

    candidates: int = 0
    gradients: int = 0
    hessians: int = 0
    checks: float = 0.0
    builds: float = 0.0

    def since(self, earlier: Cost) -> Cost:
        """Return the cost that came after an earlier `copy`."""
        return Cost(**{name: now - getattr(earlier, name) for name, now in vars(self).items()})

    def copy(self) -> Cost:
        """Return the cost as it is now."""
        return Cost(**vars(self))

    @contextmanager
    def timed(self, name: Literal["checks", "builds"]) -> Iterator[None]:
        """Count the block's processor time as that of checks or builds."""
        began = time.thread_time()
        try:
            yield
        finally:
            setattr(self, name, getattr(self, name) + time.thread_time() - began)


class _CostOfThread(local, Cost):
    """The cost that adds up in each thread by itself."""


COST = _CostOfThread()
"""Of this thread; every batch, every run of IPOPT and every run of CVODES adds to it."""
