"""Pieces of work for workers, which import them."""

import os
import signal
from pathlib import Path

from quietarm.metaheuristics.objective.population import PopulationObjective
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint


def add(known, say):
    return sum(known.answers.values()) + 1


def parent(known, say):
    return os.getppid()


def refuse(known, say):
    raise ValueError("give another")


def exhaust(known, say):
    raise MemoryError


def built(known, say):
    """Which worker it is, and how often it has built the same objective of a population."""
    from quietarm.ocp.program.batch import batch

    task = PointToPoint(SingleLinkManipulator(), 0.5, 0.8)
    PopulationObjective(task, CycloidPolynomial(2))([[0.0, 0.0]])
    return os.getpid(), batch.cache_info().misses


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
