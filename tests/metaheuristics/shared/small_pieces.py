"""Pieces of work for workers, which import them."""

import os
import signal
from pathlib import Path


def add(known, say):
    return sum(known.answers.values()) + 1


def parent(known, say):
    return os.getppid()


def kill_once(path, known, say):
    """End the worker with SIGKILL, unless it was done before."""
    if not Path(path).exists():
        Path(path).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "done by another"


def kill_always(path, known, say):
    """End every worker with SIGKILL, and note it."""
    with Path(path).open("a") as file:
        file.write("x")
    os.kill(os.getpid(), signal.SIGKILL)
