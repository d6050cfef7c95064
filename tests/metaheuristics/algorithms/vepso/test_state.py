"""VEPSO's state: a restored run goes on bit for bit."""

import json

import numpy as np
import pytest
from pymoo.optimize import minimize
from pymoo.problems import get_problem
from quietarm.metaheuristics.algorithms.velocity import INERTIA_2002
from quietarm.metaheuristics.algorithms.vepso import VEPSO
from states import same
from target_problems import Constrained, States, Targets, Undefined, step


def plain(value):
    """What JSON would make of a state."""
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    return value.tolist() if isinstance(value, np.ndarray) else value


@pytest.mark.parametrize("through_json", [False, True])
@pytest.mark.parametrize(
    ("problem", "options"),
    [
        (get_problem("zdt3", n_var=6), {"rule": INERTIA_2002, "boundary": "reflect"}),
        (get_problem("zdt1", n_var=6), {"archive_size": 8}),
        (Constrained(), {}),
        (Undefined(n_obj=3), {}),
    ],
)
def test_restored_run_goes_on_bit_for_bit(problem, options, through_json):
    def algorithm():
        return VEPSO(8, **options).setup(problem, termination=("n_gen", 20), seed=7)

    whole = algorithm()
    states = [step(whole) for _ in range(20)]
    for completed in (1, 9, 20):
        state = states[completed - 1]
        if through_json:
            state = json.loads(json.dumps(plain(state)))
        restored = algorithm()
        restored.restore(state)
        assert same(restored.state(), states[completed - 1])
        assert restored.has_next() == (completed < 20)
        for expected in states[completed:]:
            assert same(step(restored), expected)
        assert not restored.has_next()
        assert restored.n_iter == whole.n_iter
        assert restored.evaluator.n_eval == whole.evaluator.n_eval == 20 * 8 * problem.n_obj
        ours, theirs = restored.result(), whole.result()
        for key in ("X", "F", "CV", "G"):
            assert np.array_equal(getattr(ours, key), getattr(theirs, key))
        assert np.array_equal(ours.pop.get("CV"), theirs.pop.get("CV"))


def test_state_in_a_callback_is_that_of_the_finished_iteration():
    states = States()
    minimize(Targets(), VEPSO(5), ("n_gen", 6), seed=1, callback=states)
    algorithm = VEPSO(5).setup(Targets(), termination=("n_gen", 6), seed=1)
    for state in states.states:
        assert same(step(algorithm), state)
    restored = VEPSO(5).setup(Targets(), termination=("n_gen", 6), seed=99)
    restored.restore(states.states[2])
    restored.run()
    assert same(restored.state(), states.states[-1])


def test_state_between_ask_and_tell_is_that_before_the_ask():
    algorithm = VEPSO(5).setup(Targets(), seed=1)
    before = step(algorithm)
    candidates = algorithm.ask()
    assert same(algorithm.state(), before)
    restored = VEPSO(5).setup(Targets())
    restored.restore(algorithm.state())
    assert np.array_equal(restored.ask().get("X"), candidates.get("X"))


def test_state_and_run_do_not_share_memory():
    algorithm = VEPSO(5).setup(Targets(), seed=1)
    state = step(algorithm)
    copy = json.dumps(plain(state))
    algorithm.next()
    restored = VEPSO(5).setup(Targets())
    restored.restore(state)
    restored.next()
    assert json.dumps(plain(state)) == copy
    state = algorithm.state()
    copy = json.dumps(plain(state))
    for array in (*state.values(), *state["particles"].values(), *state["archive"].values()):
        if isinstance(array, np.ndarray):
            array[...] = 0
    assert json.dumps(plain(algorithm.state())) == copy


def test_restored_run_may_be_given_more_iterations():
    state = minimize(Targets(), VEPSO(5), ("n_gen", 10), seed=1).algorithm.state()
    algorithm = VEPSO(5).setup(Targets(), termination=("n_eval", 150))
    algorithm.restore(state)
    longer = minimize(Targets(), algorithm)
    assert longer.algorithm.iteration == 15
    direct = minimize(Targets(), VEPSO(5), ("n_gen", 15), seed=1)
    assert np.array_equal(longer.X, direct.X)


def test_no_state_before_the_first_iteration():
    algorithm = VEPSO(5).setup(Targets(), seed=1)
    algorithm.ask()
    with pytest.raises(RuntimeError, match="no state before the first iteration"):
        algorithm.state()


def test_state_of_another_run_is_refused():
    state = minimize(Targets(), VEPSO(5), ("n_gen", 2), seed=1).algorithm.state()
    for particles, problem in ((6, Targets()), (5, Targets(n_var=4)), (5, Targets(n_obj=3))):
        with pytest.raises(ValueError, match="where a state has"):
            VEPSO(particles).setup(problem).restore(state)
