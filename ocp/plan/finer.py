"""Figures of many motions by a finer rule, in one call; CVODES confirms some of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.program.batch import Values, batch
from quietarm.ocp.program.program import Program
from quietarm.ocp.simulation.rollout import default_steps

EVERY = 10
"""CVODES checks one motion in so many."""
SAME = 1e-6
"""The share by which its figures may then differ."""
_FINER = 3


def finer_values(programs: Sequence[Program], coefficients: NDArray[np.float64]) -> Values:
    """Figures of one motion of each program, on three times the solver's steps or more."""
    one = programs[0]
    steps = max(default_steps(one.task), _FINER * one.steps)
    move = np.array([program.task.move for program in programs])
    no_errors = np.zeros((len(programs), 0))
    return batch(one.plant, one.profile, steps).values(coefficients, move, no_errors)
