"""Moves of VEPSO's particles, and what happens at the bounds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pymoo.optimize import minimize
from target_problems import Targets, step

from quietarm.metaheuristics.algorithms.velocity import INERTIA_2002, VelocityRule, clip, reflect
from quietarm.metaheuristics.algorithms.vepso import VEPSO


def test_velocity_is_inertia_plus_both_pulls():
    rule, problem = VelocityRule(0.6, 0.6, 0.7, 1.5, 1.2), Targets()
    algorithm = VEPSO(4, rule, velocity_limit=0.4).setup(problem, seed=5)
    before, state = step(algorithm), step(algorithm)
    x, best_next = problem.X[0].reshape(2, 4, 3), state["best_X"]
    for _ in range(6):
        before, x = state, problem.X[-1].reshape(2, 4, 3)
        r = np.random.default_rng()
        r.bit_generator.state = before["random_state"]
        r1, r2 = r.random((2, 2, 4, 3))
        best_next = before["best_X"][[1, 0], before["swarm_best"][[1, 0]]][:, None]
        own = 1.5 * r1 * (before["best_X"] - x)
        v = 0.7 * (0.6 * before["velocities"] + own + 1.2 * r2 * (best_next - x))
        v = np.clip(v, -0.4 * 3.0, 0.4 * 3.0)
        state = step(algorithm)
        np.testing.assert_allclose(problem.X[-1].reshape(2, 4, 3), np.clip(x + v, -1, 2))
        inside = np.abs(x + v - 0.5) < 1.5
        np.testing.assert_allclose(state["velocities"], np.where(inside, v, 0.0))


def test_falling_inertia_needs_the_number_of_iterations():
    with pytest.raises(ValueError, match="give iterations or n_gen"):
        VEPSO(10, INERTIA_2002).setup(Targets(), termination=("time", 1.0))
    explicit = minimize(Targets(), VEPSO(10, INERTIA_2002, iterations=7), ("n_eval", 140), seed=3)
    implicit = minimize(Targets(), VEPSO(10, INERTIA_2002), ("n_gen", 7), seed=3)
    assert np.array_equal(explicit.F, implicit.F)


def test_reflect_mirrors_and_reverses():
    x, v = reflect(
        np.array([-0.25, 0.5, 1.25]), np.array([-1.0, 1.0, 2.0]), np.zeros(3), np.ones(3)
    )
    assert x.tolist() == [0.25, 0.5, 0.75]
    assert v.tolist() == [1.0, 1.0, -2.0]


@pytest.mark.parametrize("boundary", [clip, reflect])
@given(
    x=arrays(float, 4, elements=st.floats(-1e3, 1e3)),
    v=arrays(float, 4, elements=st.floats(-1e3, 1e3)),
)
def test_boundary_keeps_to_the_box_and_leaves_the_inside_alone(boundary, x, v):
    lower, upper = np.array([-1.0, 0.0, 0.5, 2.0]), np.array([1.0, 0.1, 700.0, 2.0])
    kept_x, kept_v = boundary(x, v, lower, upper)
    assert ((kept_x >= lower) & (kept_x <= upper)).all()
    assert (np.abs(kept_v) <= np.abs(v)).all()
    inside = (x >= lower) & (x <= upper)
    assert np.array_equal(kept_x[inside], x[inside])
    assert np.array_equal(kept_v[inside], v[inside])
