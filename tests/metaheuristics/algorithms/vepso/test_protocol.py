"""VEPSO: its arguments, its first positions, pymoo's protocol."""

import dataclasses

import numpy as np
import pytest
from pymoo.core.evaluator import Evaluator
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from pymoo.problems import get_problem
from quietarm.metaheuristics.algorithms.velocity import (
    CONSTRICTION,
    INERTIA_2002,
    PAPER_GROUP,
    VelocityRule,
)
from quietarm.metaheuristics.algorithms.vepso import VEPSO
from target_problems import Targets, state_of

# -- arguments --


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"particles": 1}, "particles is 1; give a whole number from 2 up"),
        ({"particles": 10.5}, "particles is 10.5"),
        ({"particles": None}, "particles is None"),
        ({"archive_size": 1}, "archive_size is 1; give a whole number from 2 up"),
        ({"iterations": 0}, "iterations is 0; give a whole number from 1 up"),
        ({"boundary": ["clip"]}, "boundary is .'clip'.; give one of clip, reflect"),
        ({"boundary": "wrap"}, "boundary is 'wrap'; give one of clip, reflect"),
        ({"velocity_limit": 0.0}, "velocity_limit is 0; give a positive"),
        ({"velocity_limit": float("nan")}, "velocity_limit is nan"),
        ({"rule": "constriction"}, "rule is 'constriction'; give a VelocityRule"),
    ],
)
def test_wrong_arguments_are_named_with_the_remedy(arguments, message):
    with pytest.raises(ValueError, match=message) as caught:
        VEPSO(**arguments)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(VelocityRule)])
@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf")])
def test_constants_of_the_velocity_are_checked(field, value):
    with pytest.raises(ValueError, match=f"{field} is {value!r}; give"):
        dataclasses.replace(CONSTRICTION, **{field: value})


def test_of_the_constants_only_the_constriction_may_not_be_zero():
    VelocityRule(0, 0, 1.0, 0, 0)
    with pytest.raises(ValueError, match=r"cognitive is -1; give 0 or more"):
        VelocityRule(1.0, 1.0, 0.7, -1, 2.0)
    with pytest.raises(ValueError, match="constriction is 0"):
        VelocityRule(1.0, 1.0, 0.0, 2.0, 2.0)


def test_misspelt_option_is_not_ignored():
    with pytest.raises(TypeError, match="VEPSO has no option particels"):
        VEPSO(particels=10)


def test_presets_are_the_published_constants():
    assert dataclasses.astuple(INERTIA_2002) == (1.0, 0.4, 1.0, 0.5, 0.5)
    assert dataclasses.astuple(CONSTRICTION) == (1.0, 1.0, 0.729, 2.05, 2.05)
    assert dataclasses.astuple(PAPER_GROUP) == (1.0, 1.0, 0.73, 2.05, 2.05)
    with pytest.raises(dataclasses.FrozenInstanceError):
        CONSTRICTION.social = 1.0


def test_problem_without_bounds_is_refused():
    with pytest.raises(ValueError, match="no finite bounds; give its xl and xu"):
        VEPSO().setup(Problem(n_var=2, n_obj=2))
    with pytest.raises(ValueError, match="no finite bounds"):
        VEPSO().setup(Problem(n_var=2, n_obj=2, xl=0.0, xu=np.inf))


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


def test_sampling_as_array_or_population_is_used_and_evaluated():
    X = np.random.default_rng(1).uniform(-1, 2, (12, 3))
    evaluated = Evaluator().eval(Targets(), Population.new(X=X))
    for sampling in (X, evaluated):
        problem = Targets()
        result = minimize(problem, VEPSO(6, sampling=sampling), ("n_gen", 3), seed=1)
        assert np.array_equal(problem.X[0], X)
        assert result.algorithm.evaluator.n_eval == 36


def test_wrong_sampling_is_refused():
    for sampling in (np.zeros((11, 3)), np.full((12, 3), 2.5), np.full((12, 3), np.nan)):
        algorithm = VEPSO(6, sampling=sampling).setup(Targets())
        with pytest.raises(ValueError, match=r"give \(12, 3\), within the bounds"):
            algorithm.ask()


# -- pymoo's protocol --


@pytest.mark.parametrize("n_obj", [1, 2, 3])
def test_exactly_swarms_times_particles_evaluations(n_obj):
    problem = Targets(n_obj=n_obj)
    result = minimize(problem, VEPSO(7), ("n_gen", 9), seed=1)
    assert [len(X) for X in problem.X] == [n_obj * 7] * 9
    assert result.algorithm.evaluator.n_eval == n_obj * 7 * 9
    assert len(result.pop) == n_obj * 7


def test_default_is_the_size_of_the_paper():
    problem = Targets()
    minimize(problem, VEPSO(), ("n_gen", 2), seed=1)
    assert [len(X) for X in problem.X] == [200, 200]


def test_terminations_are_honoured():
    for termination, iterations in ((("n_gen", 4), 4), (("n_eval", 100), 5), (("n_eval", 101), 6)):
        problem = Targets()
        minimize(problem, VEPSO(10), termination, seed=1)
        assert len(problem.X) == iterations
    problem = Targets()
    VEPSO(10, termination=("n_gen", 3), seed=1).setup(problem).run()  # as the constructor's
    assert len(problem.X) == 3
    assert minimize(Targets(), VEPSO(10), seed=1).algorithm.n_iter < 1000  # pymoo's tolerances


def test_seed_decides_everything():
    a, b, c = (minimize(Targets(), VEPSO(10), ("n_gen", 10), seed=seed) for seed in (1, 1, 2))
    d = VEPSO(10, seed=1, termination=("n_gen", 10)).setup(Targets()).run()
    assert np.array_equal(a.X, b.X)
    assert np.array_equal(a.X, d.X)
    assert not np.array_equal(a.X, c.X)


def test_ask_and_tell_equals_minimize():
    problem = get_problem("zdt1", n_var=5)
    expected = minimize(problem, VEPSO(10), ("n_gen", 12), seed=3)
    algorithm = VEPSO(10).setup(problem, termination=("n_gen", 12), seed=3)
    while algorithm.has_next():
        candidates = algorithm.ask()
        candidates.set("F", problem.evaluate(candidates.get("X")))
        algorithm.tell(infills=candidates)
    assert np.array_equal(algorithm.result().X, expected.X)
    assert np.array_equal(algorithm.result().F, expected.F)


def test_tell_refuses_what_was_not_asked_for():
    problem = Targets()
    algorithm = VEPSO(5).setup(problem, seed=1)
    candidates = algorithm.ask()
    with pytest.raises(
        ValueError,
        match=r"evaluate all candidates that ask\(\) gave, and pass them to tell\(\) once",
    ):
        algorithm.tell(infills=candidates)
    Evaluator().eval(problem, candidates)
    with pytest.raises(
        ValueError,
        match=r"evaluate all candidates that ask\(\) gave, and pass them to tell\(\) once",
    ):
        algorithm.tell(infills=candidates[:-1])
    algorithm.tell(infills=candidates)
    with pytest.raises(
        ValueError,
        match=r"evaluate all candidates that ask\(\) gave, and pass them to tell\(\) once",
    ):
        algorithm.tell(infills=candidates)


def test_display_history_and_copies_work(capsys):
    result = minimize(
        get_problem("zdt1", n_var=4),
        VEPSO(5),
        ("n_gen", 4),
        seed=1,
        verbose=True,
        save_history=True,
    )
    assert "n_nds" in capsys.readouterr().out
    assert [entry.iteration for entry in result.history] == [1, 2, 3, 4]
