"""Small searches that the tests of searches share, and what they all ask of a front."""

import dataclasses
import json
import math
from functools import cache

import numpy as np
import pytest
from moves import CASES

from quietarm.metaheuristics import search
from quietarm.ocp.saved import plain

pi = math.pi
(HALF, _), (SIXTH, _) = CASES["arm"], CASES["single link"]
TASKS = {"nsga2": HALF, "vepso": SIXTH}
BOUNDS = {"nsga2": 0.5, "vepso": 0.2}  # eqs (17) and (12)
METHODS = pytest.mark.parametrize("method", ["nsga2", "vepso"])


def run(method, task=None, **settings):
    """A small search with what a test does not care about filled in."""
    given = {"bound": BOUNDS[method], "population": 20, "generations": 15, **settings}
    return search(TASKS[method] if task is None else task, algorithm=method, **given)


@cache
def found(method, task=None, **settings):
    """Return the front of a search, done once for all tests that ask for it."""
    return run(method, task, **settings)


def exactly(front):
    """All of a front but its times, to the last bit."""
    history = [{**mark, "seconds": None} for mark in plain(front)["history"]]
    return json.dumps({**plain(front.restated(seconds=0.0)), "history": history})


def assert_is_a_front(front):
    """Sorted, finite, mutually non-dominated."""
    F = np.column_stack([front.residuals, front.energies])
    assert np.isfinite(F).all()
    assert np.all(np.diff(front.residuals) > 0)
    assert np.all(np.diff(front.energies) < 0)


LIMITED = {
    "nsga2": dataclasses.replace(HALF, torque_limit=0.3, acceleration_limit=75.0),
    "vepso": dataclasses.replace(SIXTH, torque_limit=0.16, speed_limit=0.99, deflection_limit=0.03),
}
