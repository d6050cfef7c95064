"""VEPSO: the moves, the archive, pymoo's protocol, checkpoints, and ZDT1 to ZDT3."""

import dataclasses
import json

import moocore
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pymoo.core.callback import Callback
from pymoo.core.evaluator import Evaluator
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from pymoo.problems import get_problem

from metaheuristics.velocity import (
    CONSTRICTION,
    INERTIA_2002,
    PAPER_GROUP,
    VelocityRule,
    clip,
    reflect,
)
from metaheuristics.vepso import VEPSO, least_crowded


class Targets(Problem):
    """Objective s is the squared distance to a target of its own; remembers what it was asked."""

    def __init__(self, n_obj=2, n_var=3, **options):
        super().__init__(n_var=n_var, n_obj=n_obj, xl=-1.0, xu=2.0, **options)
        self.targets = np.eye(n_obj, n_var)
        self.X, self.F = [], []

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = ((x[:, None, :] - self.targets) ** 2).sum(axis=2)
        self.X.append(x)
        self.F.append(out["F"])


class Undefined(Targets):
    """NaN for x1 < 0 and infinite for x1 > 1.5 in one objective only."""

    def _evaluate(self, x, out, *args, **kwargs):
        super()._evaluate(x, out)
        out["F"][x[:, 0] < 0.0, 0] = np.nan
        out["F"][x[:, 0] > 1.5, 1] = np.inf


class Constrained(Targets):
    """Feasible in a small corner only, x1 >= 1.9."""

    def __init__(self, **options):
        super().__init__(n_ieq_constr=1, **options)

    def _evaluate(self, x, out, *args, **kwargs):
        super()._evaluate(x, out)
        out["G"] = 1.9 - x[:, :1]


class States(Callback):
    """Collects the state after every iteration."""

    def __init__(self):
        super().__init__()
        self.states = []

    def notify(self, algorithm):
        self.states.append(algorithm.state())


def same(a, b):
    """Whether two states are equal to the last bit, NaN included."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    return (
        np.asarray(a).tobytes() == np.asarray(b).tobytes() if isinstance(a, np.ndarray) else a == b
    )


def step(algorithm):
    algorithm.next()
    return algorithm.state()


# --- arguments ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"particles": 1}, "particles is 1; give a whole number from 2 up"),
        ({"particles": 10.5}, "particles is 10.5"),
        ({"particles": None}, "particles is None"),
        ({"archive_size": 1}, "archive_size is 1; give a whole number from 2 up"),
        ({"iterations": 0}, "iterations is 0; give a whole number from 1 up"),
        ({"iterations": True}, "iterations is True"),
        ({"boundary": ["clip"]}, "boundary is .'clip'.; give one of clip, reflect"),
        ({"velocity_limit": "a"}, "velocity_limit is 'a'; give a number"),
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
@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf"), "a"])
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


# --- moves --------------------------------------------------------------------------------------


@pytest.mark.parametrize("n_obj", [2, 3, 4])
def test_social_term_pulls_to_the_best_of_the_next_swarm(n_obj):
    particles, problem = 5, Targets(n_obj=n_obj, n_var=4)
    algorithm = VEPSO(particles, VelocityRule(0.0, 0.0, 1.0, 0.0, 1.0), iterations=9)
    algorithm.setup(problem, seed=1)
    algorithm.next()
    x = problem.X[0].reshape(n_obj, particles, -1)
    F = problem.F[0].reshape(n_obj, particles, n_obj)
    moved = algorithm.ask().get("X").reshape(x.shape)
    for swarm in range(n_obj):
        following = (swarm + 1) % n_obj
        best = x[following, F[following, :, following].argmin()]
        fraction = (moved[swarm] - x[swarm]) / (best - x[swarm])
        assert ((fraction >= 0) & (fraction < 1)).all()
        assert len(np.unique(fraction)) == fraction.size  # random per particle and coordinate


def test_single_swarm_follows_its_own_best():
    problem = Targets(n_obj=1)
    result = minimize(problem, VEPSO(20), ("n_gen", 100), seed=1)
    assert result.X.shape == (3,)
    assert result.F[0] < 1e-6  # measured: below 2e-9 for seeds 0 to 19


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


def test_inertia_falls_linearly_from_first_to_last_move():
    rule = dataclasses.replace(INERTIA_2002, cognitive=0.0, social=0.0)
    states = States()
    minimize(Targets(), VEPSO(50, rule), ("n_gen", 5), seed=2, callback=states)
    velocities = [state["velocities"] for state in states.states]
    for inertia, v, following in zip(
        (1.0, 0.8, 0.6, 0.4), velocities, velocities[1:], strict=False
    ):
        kept = following != 0  # the others stopped at a bound
        assert kept.mean() > 0.2
        np.testing.assert_allclose(following[kept], inertia * v[kept])


def test_falling_inertia_needs_the_number_of_iterations():
    for termination in (None, ("n_eval", 1000), ("time", 1.0)):
        with pytest.raises(ValueError, match="unknown iteration; give iterations or n_gen"):
            VEPSO(10, INERTIA_2002).setup(Targets(), termination=termination)
        VEPSO(10, CONSTRICTION).setup(Targets(), termination=termination)
    explicit = minimize(Targets(), VEPSO(10, INERTIA_2002, iterations=7), ("n_eval", 140), seed=3)
    implicit = minimize(Targets(), VEPSO(10, INERTIA_2002), ("n_gen", 7), seed=3)
    assert np.array_equal(explicit.F, implicit.F)
    minimize(Targets(), VEPSO(10, INERTIA_2002, iterations=3), ("n_gen", 7), seed=3)  # stays at end


def test_bests_are_those_of_the_own_objective_over_the_whole_run():
    problem, states = Targets(n_obj=3), States()
    minimize(problem, VEPSO(6), ("n_gen", 30), seed=4, callback=states)
    state = states.states[-1]
    X = np.reshape(problem.X, (30, 3, 6, 3))
    F = np.reshape(problem.F, (30, 3, 6, 3))
    for swarm in range(3):
        when = F[:, swarm, :, swarm].argmin(axis=0)
        assert np.array_equal(state["best_X"][swarm], X[when, swarm, np.arange(6)])
        own = F[:, swarm, :, swarm].min(axis=0)
        assert np.array_equal(state["best_merit"][swarm, :, 1], own)
        assert state["swarm_best"][swarm] == own.argmin()


def test_tie_in_the_own_objective_is_broken_by_the_next():
    class Flat(Targets):
        def _evaluate(self, x, out, *args, **kwargs):
            super()._evaluate(x, out)
            out["F"][:, 0] = 7.0

    result = minimize(Flat(), VEPSO(10), ("n_gen", 100), seed=1)
    state = result.algorithm.state()
    leader = state["best_X"][0, state["swarm_best"][0]]
    assert leader == pytest.approx([0.0, 1.0, 0.0], abs=1e-3)  # the second target


@pytest.mark.parametrize("limit", [0.05, 0.5])
def test_velocity_limit_is_a_fraction_of_the_box(limit):
    problem = Targets()
    minimize(problem, VEPSO(20, velocity_limit=limit), ("n_gen", 20), seed=1)
    longest = np.abs(np.diff(problem.X, axis=0)).max()
    assert 0.99 * limit * 3.0 < longest <= limit * 3.0 * (1 + 1e-12)


def test_clip_stops_at_the_bound():
    x, v = clip(np.array([-0.5, 0.5, 1.5]), np.array([-1.0, 1.0, 2.0]), np.zeros(3), np.ones(3))
    assert x.tolist() == [0.0, 0.5, 1.0]
    assert v.tolist() == [0.0, 1.0, 0.0]


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


@pytest.mark.parametrize("boundary", ["clip", "reflect"])
@pytest.mark.parametrize("limit", [1.0, 5.0])
def test_no_candidate_leaves_the_box(boundary, limit):
    problem = Targets()
    problem.xl[1] = problem.xu[1] = 1.0  # a variable may be fixed
    rule = VelocityRule(1.3, 1.3, 1.0, 2.0, 2.0)  # explodes without the limit
    minimize(problem, VEPSO(10, rule, boundary, limit), ("n_gen", 60), seed=1)
    X = np.concatenate(problem.X)
    assert np.array_equal(X, np.clip(X, problem.xl, problem.xu))


# --- first positions ----------------------------------------------------------------------------


def test_first_positions_are_uniform_in_the_box():
    algorithm = VEPSO(500).setup(Targets(), seed=1)
    algorithm.next()
    X = algorithm.pop.get("X")
    counts = np.apply_along_axis(lambda x: np.histogram(x, 10, (-1.0, 2.0))[0], 0, X)
    assert counts.sum(axis=0).tolist() == [1000] * 3
    assert counts.min() > 60
    assert counts.max() < 140
    goals = X + 2 * algorithm.state()["velocities"].reshape(X.shape)  # the first move is halfway
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


# --- pymoo's protocol ---------------------------------------------------------------------------


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
    with pytest.raises(ValueError, match="tell all candidates evaluated"):
        algorithm.tell(infills=candidates)
    Evaluator().eval(problem, candidates)
    with pytest.raises(ValueError, match="tell all candidates evaluated"):
        algorithm.tell(infills=candidates[:-1])
    algorithm.tell(infills=candidates)
    with pytest.raises(ValueError, match="ask, and tell"):
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


# --- archive ------------------------------------------------------------------------------------


def test_result_is_the_unbounded_archive_of_all_that_was_not_dominated():
    problem = Targets()
    result = minimize(problem, VEPSO(15), ("n_gen", 40), seed=1)
    X, F = np.concatenate(problem.X), np.concatenate(problem.F)
    kept = moocore.is_nondominated(F)
    assert len(result.F) == kept.sum() > 30
    assert np.array_equal(np.unique(result.X, axis=0), np.unique(X[kept], axis=0))
    assert np.array_equal(result.F, problem.evaluate(result.X))


def test_bounded_archive_keeps_the_extremes_and_spreads():
    bounded = minimize(Targets(), VEPSO(20, archive_size=15), ("n_gen", 60), seed=1)
    free = minimize(Targets(), VEPSO(20), ("n_gen", 60), seed=1)
    assert len(bounded.F) == 15 < len(free.F)
    assert moocore.is_nondominated(bounded.F).all()
    # the archive does not steer the swarms, so both saw the same candidates
    assert np.array_equal(bounded.F.min(axis=0), free.F.min(axis=0))
    gaps = np.diff(np.sort(bounded.F[:, 0]))
    assert gaps.max() < 0.5 * np.ptp(bounded.F[:, 0])


def test_least_crowded_thins_a_cluster_without_a_hole():
    f = np.concatenate([np.linspace(0, 0.1, 50), [0.5, 1.0]])
    F = np.column_stack([f, 1 - f])
    kept = F[least_crowded(F, 5), 0]
    assert {0.0, 0.5, 1.0} <= set(kept)
    assert ((kept > 0) & (kept <= 0.1)).sum() == 2
    assert least_crowded(F, 52).tolist() == list(range(52))


@settings(deadline=None, max_examples=60)
@given(data=st.data(), n_obj=st.integers(1, 4), size=st.sampled_from([None, 2, 5]))
def test_archive_is_feasible_finite_and_mutually_non_dominated(data, n_obj, size):
    values = st.sampled_from([0.0, 1.0, 2.0, 3.0, -1.0, np.nan, np.inf, -np.inf])
    problem = Problem(n_var=2, n_obj=n_obj, n_ieq_constr=1, xl=0.0, xu=1.0)
    algorithm = VEPSO(4, archive_size=size).setup(problem, termination=("n_gen", 3), seed=1)
    best = np.full(n_obj, np.inf)
    for _ in range(3):
        candidates = algorithm.ask()
        F = data.draw(arrays(float, (4 * n_obj, n_obj), elements=values))
        G = data.draw(
            arrays(float, (4 * n_obj, 1), elements=st.sampled_from([-1.0, 0.0, 2.0, np.nan]))
        )
        candidates.set("F", F)
        candidates.set("G", G)
        algorithm.tell(infills=candidates)
        usable = np.isfinite(F).all(axis=1) & (G[:, 0] <= 0)
        best = np.vstack([best, F[usable]]).min(axis=0)
        archive = algorithm.external_archive
        if not len(archive):
            assert not np.isfinite(best).any()
            continue
        A = archive.get("F")
        assert np.isfinite(A).all()
        assert (archive.get("CV") <= 0).all()
        assert np.isfinite(algorithm.ask().get("X")).all()
        worse = (A[:, None] >= A[None]).all(axis=2) & (A[:, None] > A[None]).any(axis=2)
        assert not worse.any()
        assert len(np.unique(A, axis=0)) == len(A)
        assert size is None or len(A) <= size
        if size is None:
            assert np.array_equal(A.min(axis=0), best)
        assert algorithm.opt is archive


# --- failed and infeasible candidates -----------------------------------------------------------


def test_undefined_candidates_become_no_best_and_stay_out_of_the_archive():
    problem, states = Undefined(), States()
    result = minimize(problem, VEPSO(20), ("n_gen", 30), seed=1, callback=states)
    assert np.isnan(np.concatenate(problem.F)).sum() > 10
    assert np.isinf(np.concatenate(problem.F)).sum() > 10
    assert np.isfinite(result.F).all()
    for state in states.states:
        assert not np.isnan(state["best_merit"]).any()
        found = np.isfinite(state["best_merit"][..., 0])
        assert np.isfinite(state["best_merit"][found]).all()
        x1 = state["best_X"][found][:, 0]
        assert ((x1 >= 0) & (x1 <= 1.5)).all()
    assert found.all()


class Nowhere(Targets):
    """NaN everywhere, in the second objective."""

    def _evaluate(self, x, out, *args, **kwargs):
        super()._evaluate(x, out)
        out["F"][:, 1] = np.nan


def test_who_has_found_nothing_usable_draws_nobody():
    problem = Nowhere()
    rule = VelocityRule(0.0, 0.0, 1.0, 2.0, 2.0)  # moves by the pulls only
    minimize(problem, VEPSO(5, rule), ("n_gen", 5), seed=1)
    assert np.ptp(problem.X, axis=0).max() == 0


def test_nothing_defined_at_all_gives_no_result():
    for termination in (("n_gen", 10), None):
        problem = Nowhere()
        result = minimize(problem, VEPSO(5), termination, seed=1)
        assert result.X is None
        assert result.F is None
        assert len(problem.X) >= 10
        assert not result.pop.get("FEAS").any()
    assert np.ptp(problem.X, axis=0).min() > 0  # the swarms go on looking


def test_constraints_come_before_objectives():
    problem = Constrained()
    result = minimize(problem, VEPSO(30), ("n_gen", 60), seed=1)
    assert (result.CV <= 0).all()
    assert (result.G <= 0).all()
    assert (result.X[:, 0] >= 1.9).all()
    state = result.algorithm.state()
    assert (state["best_merit"][..., 0] == 0).all()
    # the constrained minima of the objectives: x1 = 1.9, the rest as in the targets
    # (measured for seeds 0 to 19: at most 0.005 above)
    assert result.F.min(axis=0) == pytest.approx([0.9**2, 1.9**2], abs=0.03)


def test_infeasible_run_gives_none_or_the_least_infeasible():
    class Never(Constrained):
        def _evaluate(self, x, out, *args, **kwargs):
            super()._evaluate(x, out)
            out["G"] += 1.0

    result = minimize(Never(), VEPSO(10), ("n_gen", 40), seed=1)
    assert result.X is None
    result = minimize(Never(), VEPSO(10, return_least_infeasible=True), ("n_gen", 40), seed=1)
    np.testing.assert_allclose(result.CV, 0.9, atol=1e-3)
    assert len(result.algorithm.external_archive) == 0
    result = minimize(Never(), VEPSO(10), seed=1, verbose=True)  # pymoo's tolerances and display
    assert result.X is None


# --- checkpoints --------------------------------------------------------------------------------


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
        with pytest.raises(ValueError, match="give a state with"):
            VEPSO(particles).setup(problem).restore(state)


# --- the fronts ---------------------------------------------------------------------------------
# All at the paper's effort, 100 particles a swarm and 200 iterations. IGD is the mean distance of
# the true front to the archive, HV the archive's hypervolume over the true front's at (1.1, 1.1).
# Measured is the worst of seeds 0 to 19. 40,000 uniformly random candidates get an IGD of 0.06 to
# 0.09 for 3 variables, 0.2 to 0.6 for 5 and 1.3 to 2.9 for 30.
#
# These problems have their optima on the bounds, which favours "clip"; "reflect" shows what is left
# without that help. The thin middle is VEPSO's own: nothing pulls a swarm along the front.


def fronts(name, n_var, algorithm):
    problem = get_problem(name, n_var=n_var)
    result = minimize(problem, algorithm, ("n_gen", 200), seed=1)
    assert result.algorithm.evaluator.n_eval == 40_000
    return result.F, problem.pareto_front(1000)


def quality(F, true):
    hypervolumes = [moocore.hypervolume(front, ref=[1.1, 1.1]) for front in (F, true)]
    return moocore.igd(F, ref=true), hypervolumes[0] / hypervolumes[1]


@pytest.mark.parametrize("name", ["zdt1", "zdt2", "zdt3"])
def test_default_finds_the_whole_front_of_five_variables(name):
    igd, hv = quality(*fronts(name, 5, VEPSO()))
    assert igd < 2e-3  # measured: 5e-5, 9e-5, 4e-4
    assert hv > 0.995  # measured: 1.000 each


@pytest.mark.parametrize(
    ("name", "largest_igd", "smallest_hv"),
    [
        ("zdt1", 0.01, 0.98),  # measured: 0.0027, 0.995
        ("zdt3", 0.3, 0.6),  # measured: 0.144, 0.758 (median 0.031)
    ],
)
def test_default_finds_the_front_of_thirty_variables(name, largest_igd, smallest_hv):
    igd, hv = quality(*fronts(name, 30, VEPSO()))
    assert igd < largest_igd
    assert hv > smallest_hv


def test_default_finds_the_corner_of_zdt2_with_thirty_variables():
    # Known weakness: for 17 seeds of 20 both swarms end at the corner (0, 1), from where the
    # concave front is uphill for the second objective; the IGD is then 0.61. What is found is on
    # the front: its mean distance to it was at most 0.036.
    F, true = fronts("zdt2", 30, VEPSO())
    assert moocore.igd(true, ref=F) < 0.1
    assert np.abs(F - [0.0, 1.0]).max(axis=1).min() < 1e-3


@pytest.mark.parametrize("name", ["zdt1", "zdt2", "zdt3"])
@pytest.mark.parametrize(
    ("rule", "boundary", "largest_igd", "smallest_hv"),
    [
        (PAPER_GROUP, "clip", 2e-3, 0.995),  # measured: 3e-4, 1.000
        (CONSTRICTION, "reflect", 0.05, 0.85),  # measured: 0.024, 0.932
        (INERTIA_2002, "clip", 0.01, 0.98),  # measured: 0.0024, 0.996
        (INERTIA_2002, "reflect", 0.25, 0.4),  # measured: 0.125, 0.622; medians 0.034 to 0.059
    ],
)
def test_variants_find_the_front_of_three_variables(name, rule, boundary, largest_igd, smallest_hv):
    igd, hv = quality(*fronts(name, 3, VEPSO(100, rule, boundary)))
    assert igd < largest_igd
    assert hv > smallest_hv


def test_bounded_archive_covers_the_front():
    F, true = fronts("zdt1", 5, VEPSO(archive_size=50))
    igd, hv = quality(F, true)
    assert len(F) == 50
    assert igd < 0.015  # measured: 0.0079
    assert hv > 0.98  # measured: 0.989


def test_three_objectives_cover_the_sphere():
    F = minimize(get_problem("dtlz2", n_var=8), VEPSO(50), ("n_gen", 200), seed=1).F
    assert len(F) > 500  # measured: 1339
    assert np.abs(np.linalg.norm(F, axis=1) - 1).mean() < 0.015  # measured: 0.0049
    assert moocore.hypervolume(F, ref=[1.1] * 3) > 0.73  # measured: 0.769; three corners: 0.331
    assert (F.min(axis=0) < 0.01).all()  # measured: 4e-33
