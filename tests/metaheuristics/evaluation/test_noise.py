"""Noise of residual and energy: its size, its seed, its cost, and the true values at the end."""

import numpy as np
import pytest
from small_searches import SIXTH, exactly

import quietarm as qa
from quietarm.metaheuristics import MoveFunction, RecordedFunction, problem_of
from quietarm.metaheuristics.evaluation.noise import Noise, belief_of, noise_share
from quietarm.metaheuristics.evaluation.stated_figures import check_figures
from quietarm.metaheuristics.problems.recorded import BudgetSpentError
from quietarm.metaheuristics.score import objectives, scores_on_the_way
from quietarm.ocp import CycloidPolynomial, Front

PROFILE = CycloidPolynomial(2)
SMALL = {"bound": 0.2, "population": 20, "generations": 10}


@pytest.fixture(scope="module")
def noisy():
    return qa.search(SIXTH, PROFILE, noise=0.05, reevaluate=3, **SMALL)


@pytest.mark.parametrize("share", [0.01, 0.05, 0.5])
def test_a_factor_has_mean_one_and_the_standard_deviation_that_was_asked_for(share):
    # closed form of a lognormal factor; 4 standard errors of 40,000 draws
    values = Noise(share, 3).of(np.ones((20_000, 3)), np.zeros(20_000, dtype=bool))
    factors = values[:, :2].ravel()
    assert (values[:, 2] == 1.0).all()  # a peak has none
    assert factors.min() > 0
    assert factors.mean() == pytest.approx(1.0, abs=4 * share / 200)
    assert factors.std() == pytest.approx(share, rel=0.1)


def test_every_evaluation_has_its_own_and_the_seed_decides():
    rows = np.full((4, 2), 0.1)
    (true, _) = MoveFunction(SIXTH, PROFILE, bound=0.2)(rows)

    def values(seed):
        return RecordedFunction(SIXTH, PROFILE, bound=0.2, noise=0.02, seed=seed)(rows)[0]

    assert values(1).tolist() == values(1).tolist()
    assert values(1).tolist() != values(2).tolist()
    assert len(np.unique(values(1))) == 8
    assert values(1) == pytest.approx(true, rel=0.12)  # six standard deviations


def test_without_noise_nothing_changes():
    plain, zero = (qa.search(SIXTH, PROFILE, seed=1, **SMALL, **noise)
                   for noise in ({}, {"noise": 0.0}))  # fmt: skip
    assert exactly(plain) == exactly(zero)
    assert "noise" not in plain.record.settings
    assert belief_of(plain) is None


def test_the_front_has_the_true_values_and_the_entries_what_was_believed(noisy, tmp_path):
    settings = noisy.record.settings
    assert (settings["noise"], settings["reevaluate"]) == (0.05, 3)
    for point in noisy.points[::5]:
        motion = qa.evaluate_coefficients(SIXTH, point.coefficients).motion
        assert (point.residual, point.energy) == pytest.approx(
            (motion.residual, motion.energy), rel=1e-9
        )
    entries = noisy.entries
    shares = entries.beliefs() / entries.objectives()
    assert 0.01 < shares.std() < 0.06  # means of three
    noisy.save(tmp_path / "noisy.json")
    again = Front.load(tmp_path / "noisy.json")
    assert again == noisy
    check_figures(again, "noisy.json")


def test_whoever_takes_the_best_of_noisy_values_believes_too_much(noisy):
    belief = belief_of(qa.search(SIXTH, PROFILE, noise=0.05, **SMALL))
    assert belief.energy < -0.01
    assert 0 < belief.dominated < belief.points
    averaged = belief_of(noisy)
    assert belief.energy < averaged.energy  # a mean of three is nearer


def test_an_evaluation_again_is_counted_and_the_budget_holds():
    function = RecordedFunction(SIXTH, PROFILE, bound=0.2, noise=0.05, reevaluate=4, budget=50)
    rows = np.random.default_rng(0).uniform(-0.2, 0.2, (10, 2))
    function(rows)
    kept = len(function.archive.non_dominated()[0])
    entered = len(function.archive.entries)
    assert kept <= entered
    spent = function.archive.evaluations
    assert spent > 10
    assert (spent - 10) % 3 == 0  # three more of each that would enter
    with pytest.raises(BudgetSpentError):
        function(np.repeat(rows, 20, axis=0))
    assert function.archive.evaluations == 50
    front = qa.search(
        SIXTH, PROFILE, bound=0.2, population=20, evaluations=300, noise=0.05, reevaluate=3
    )
    assert front.record.evaluations == 300


def test_marks_are_scored_by_true_values(noisy):
    reference = problem_of("single-link-30deg-0.8s-2-terms").reference()
    scores = scores_on_the_way(noisy, reference)
    assert scores.max() <= 1 + 1e-4  # more than the reference front would be a belief
    assert scores[-1] == reference.scores(objectives(noisy))["hypervolume"]


@pytest.mark.parametrize("value", [-0.01, 1.01, float("nan"), float("inf"), "1%", None, True])
def test_what_is_no_share_is_refused(value):
    with pytest.raises(ValueError, match=r"noise is .*, not a share from 0 to 1; give"):
        noise_share(value)
    with pytest.raises(ValueError, match="not a share from 0 to 1"):
        qa.search(SIXTH, PROFILE, noise=value, **SMALL)


def test_evaluations_again_need_noise():
    with pytest.raises(ValueError, match="reevaluate is 2, and without noise"):
        qa.search(SIXTH, PROFILE, reevaluate=2, **SMALL)
