"""VEPSO: its arguments and its first positions."""

import dataclasses

import numpy as np
import pytest
from target_problems import Targets, state_of

from quietarm.metaheuristics.algorithms.velocity import CONSTRICTION, INERTIA_2002, PAPER_GROUP
from quietarm.metaheuristics.algorithms.vepso import VEPSO

# -- arguments --


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"particles": 1}, "particles is 1; give a whole number from 2 up"),
        ({"iterations": 0}, "iterations is 0; give a whole number from 1 up"),
        ({"boundary": "wrap"}, "boundary is 'wrap'; give one of clip, reflect"),
        ({"velocity_limit": 0.0}, "velocity_limit is 0; give a positive"),
    ],
)
def test_wrong_arguments_are_named_with_the_remedy(arguments, message):
    with pytest.raises(ValueError, match=message):
        VEPSO(**arguments)


def test_presets_are_the_published_constants():
    assert dataclasses.astuple(INERTIA_2002) == (1.0, 0.4, 1.0, 0.5, 0.5)
    assert dataclasses.astuple(CONSTRICTION) == (1.0, 1.0, 0.729, 2.05, 2.05)
    assert dataclasses.astuple(PAPER_GROUP) == (1.0, 1.0, 0.73, 2.05, 2.05)


# -- first positions --


def test_first_positions_are_uniform_in_the_box():
    algorithm = VEPSO(500).setup(Targets(), seed=1)
    algorithm.next()
    X = algorithm.pop.get("X")
    counts = np.apply_along_axis(lambda x: np.histogram(x, 10, (-1.0, 2.0))[0], 0, X)
    assert counts.sum(axis=0).tolist() == [1000] * 3
    assert counts.min() > 60
    assert counts.max() < 140
    goals = X + 2 * state_of(algorithm)["velocities"].reshape(X.shape)  # the first move is halfway
    assert ((goals >= -1 - 1e-12) & (goals <= 2 + 1e-12)).all()
    assert abs(np.corrcoef(X.T, goals.T)[:3, 3:]).max() < 0.15
