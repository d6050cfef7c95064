"""Pieces of work for workers, which import them."""

import os
import signal
from pathlib import Path


def add(known, say):
    return sum(known.answers.values()) + 1


def parent(known, say):
    return os.getppid()


def kill_always(path, known, say):
    """End every worker with SIGKILL, and note it."""
    with Path(path).open("a") as file:
        file.write("x")
    os.kill(os.getpid(), signal.SIGKILL)
