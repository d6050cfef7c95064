"""Archives that a search keeps, and every indicator from them at any moment."""

import dataclasses

import moocore
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import quietarm as qa
from quietarm.metaheuristics import MoveFunction, problem_of, run_jobs
from quietarm.metaheuristics.archive import Archive, entering
from quietarm.metaheuristics.evaluation.population import objectives_of, search_evaluator
from quietarm.metaheuristics.jobs import Job
from quietarm.metaheuristics.score import (
    HYPERVOLUME,
    Indicator,
    Reference,
    Scale,
    final_share_of_box,
    known_indicators,
    scores_on_the_way,
    shares_of_box,
)
from quietarm.studies.bench.results import Results

NAME = "single-link-30deg-0.8s-2-terms"
TASK = problem_of(NAME).task


def one_by_one(candidates):
    """Rows that no earlier one weakly dominates, by the definition."""
    return [
        i for i, row in enumerate(candidates)
        if not any((earlier <= row).all() for earlier in candidates[:i])
    ]  # fmt: skip


few = st.integers(0, 6).map(float)  # with ties


@pytest.mark.slow
@given(st.lists(st.tuples(few, few), min_size=1, max_size=30), st.integers(1, 7))
def test_what_enters_is_what_nothing_earlier_dominates_whatever_is_asked_at_once(rows, size):
    candidates = np.array(rows)
    assert entering(np.empty((0, 2)), candidates).tolist() == one_by_one(candidates)
    archive = Archive(MoveFunction(TASK, qa.CycloidPolynomial(1), bound=0.2))
    for begin in range(0, len(candidates), size):
        part = candidates[begin : begin + size]
        archive.add(part[:, :1], part, np.ones(len(part), dtype=bool))
    entries = archive.entries
    assert [number - 1 for number in entries.candidates] == one_by_one(candidates)
    for count in range(1, len(candidates) + 1):
        best = moocore.filter_dominated(candidates[:count])
        kept = moocore.filter_dominated(entries.objectives(count))
        assert sorted(map(tuple, kept)) == sorted(map(tuple, best))


@pytest.mark.parametrize("method", ["nsga2", "vepso", "random"])
def test_a_search_keeps_what_entered_with_the_figures_of_its_candidates(method):
    front = qa.search(TASK, algorithm=method, bound=0.2, population=20, evaluations=300)
    entries = front.entries
    assert 1 <= entries.candidates[0] <= entries.candidates[-1] <= 300
    assert len(front.points) <= len(entries) < 300
    evaluation = search_evaluator(TASK, front.profile)(entries.coefficients)
    residuals, energies = objectives_of(evaluation).T
    np.testing.assert_allclose(entries.residuals, residuals, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(entries.energies, energies, rtol=1e-9)
    assert entries.objectives().tolist()[0] == [entries.residuals[0], entries.energies[0]]
    found = {point.coefficients for point in front.points}
    assert found <= set(entries.coefficients)


def test_marks_hold_effort_and_figures_follow_from_the_entries():
    front = qa.search(TASK, algorithm="nsga2", bound=0.2, population=20, evaluations=300)
    assert {mark.hypervolume for mark in front.history} == {None}
    shares = shares_of_box(front)
    for mark, share in zip(front.history, shares, strict=True):
        points = front.entries.objectives(mark.evaluations) / front.reference
        assert share == pytest.approx(moocore.hypervolume(points, ref=[1.0, 1.0]))
    assert (np.diff(shares) >= 0).all()
    assert final_share_of_box(front) == shares[-1]
    assert final_share_of_box(dataclasses.replace(front, history=())) == 0.0


@pytest.mark.slow
def test_an_indicator_that_is_added_is_known_on_the_way_of_runs_that_are_stored(
    tmp_path, what_is_made_up_is_forgotten
):
    jobs = [Job(NAME, "nsga2", seed, 300, {"population": 20}) for seed in range(3)]
    results = Results.of_jobs(run_jobs(jobs, tmp_path))

    class Hausdorff(Indicator):
        """Larger mean distance of two fronts."""

        name = "hausdorff"

        def value(self, points, scale):
            return moocore.avg_hausdorff_dist(points, ref=scale.stations)

    hausdorff = Hausdorff()
    front = results.runs[0].front
    scale = problem_of(NAME).reference()
    on_the_way = scores_on_the_way(front, scale, hausdorff)
    first = scale.scaled(front.entries.objectives(front.history[0].evaluations))
    best = moocore.filter_dominated(first)
    assert on_the_way[0] == pytest.approx(
        moocore.avg_hausdorff_dist(best, ref=scale.stations)
    )  # of fewer than 100 points, all
    worst, end = max(on_the_way), on_the_way[-1]
    target = (worst + end) / 2
    group = NAME, "nsga2(population=20)"
    time, low, high = results.expected_running_time(
        *group, target, by="evaluations", indicator=hausdorff
    )
    assert 20 <= low <= time <= high
    reached = results.histories(*group, hausdorff)[0]
    assert reached.missing.tolist() == on_the_way.tolist()


def test_indicators_of_a_square(front_of_two):
    """Reference (0, 1) and (1, 0), scaled; one point in the middle of the corner's box."""
    scale = Reference(front_of_two)
    assert scale.whole == pytest.approx(0.5 + 2 * 0.1 * 1.1 - 0.01)  # the triangle and its rims
    point = front_of_two.residuals.mean(), front_of_two.energies.max()  # (0.5, 1) scaled
    scores = scale.scores(np.array([point]))
    assert scores["hypervolume"] == pytest.approx(0.6 * 0.1 / scale.whole)
    assert scores["epsilon"] == pytest.approx(1.0)  # of (1, 0) it misses the energy by 1
    assert scores["igd_plus"] == pytest.approx((0.5 + 1.0) / 2)
    nothing = scale.scores(np.empty((0, 2)))
    assert nothing["hypervolume"] == 0.0
    assert np.isnan([nothing[name] for name in known_indicators() if name != "hypervolume"]).all()
    assert scale.score(scale.front.coefficients[:0], HYPERVOLUME) == 0.0
    assert isinstance(scale, Scale)


@pytest.fixture
def front_of_two():
    points = problem_of(NAME).fronts()[0].points
    return dataclasses.replace(problem_of(NAME).fronts()[0], points=(points[0], points[-1]))
