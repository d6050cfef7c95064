"""Profiles whose process dies or has no memory left; processes of their own import them."""

import os
import signal
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from quietarm.ocp import CycloidPolynomial

ORDER = "QUIETARM_TEST_ORDER_TO_DIE"
"""Environment variable with the path of a file: one process takes it away, and dies."""
ASKED = 40
_asked = 0


@dataclass(frozen=True)
class Dying(CycloidPolynomial):
    """Kills the process that asks for its size for the 40th time, a few generations on, once."""

    name: ClassVar[str] = "dying"

    @property
    def size(self):
        global _asked
        _asked += 1
        if _asked > ASKED and (order := os.environ.get(ORDER)) and Path(order).exists():
            try:
                Path(order).unlink()
            except FileNotFoundError:  # another process was first
                return super().size
            os.kill(os.getpid(), signal.SIGKILL)
        return super().size
