"""Fronts held against each other; indicators are worked out by hand on staircases of few steps."""

import dataclasses
import math
from functools import partial

import numpy as np
import pytest

from quietarm.metaheuristics.score import gap
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, epsilon_front
from quietarm.studies.compare import compare_fronts

# The fronts are invented, not motions of the plant: nothing can be evaluated between their points.
compare = partial(compare_fronts, fill=0)
# Corners are (10 mm, 1 J); `good` and `poor` stand in conftest.py.


@pytest.fixture
def measured(good, poor):
    comparison = compare([good, poor])
    return comparison, *(group.runs[0] for group in comparison.groups)


def test_hypervolume_is_the_share_of_the_best_fronts(measured):
    comparison, better, worse = measured
    # the best front goes from 0 to 8 mm and from 0.8 to 0.4 J: a tenth of that beyond its ends
    assert comparison.corner == pytest.approx((8.8e-3, 0.84))
    # widths times heights of the steps
    whole = 4 * 0.04 + 4 * 0.34 + 0.8 * 0.44
    assert better.scores["hypervolume"] == pytest.approx(1)
    assert worse.scores["hypervolume"] == pytest.approx(2.8 * 0.24 / whole)
    assert gap(worse.scores["hypervolume"]) == pytest.approx(100 * (1 - 2.8 * 0.24 / whole))


def test_igd_plus_and_epsilon_in_units_of_the_best_fronts_extent(measured, good):
    comparison, better, worse = measured
    assert comparison.extent == pytest.approx((8e-3, 0.4))
    assert (better.scores["igd_plus"], better.scores["epsilon"]) == (0, 0)
    # Each point of good, and by how much the nearer of poor's misses it in (residual, energy):
    # (0, .8): (2/8, .1/.4); (4, .5): the second (2/8, .1/.4); (8, .4): the second (0, .2/.4).
    misses = [math.hypot(0.25, 0.25), math.hypot(0.25, 0.25), 0.5]
    assert worse.scores["igd_plus"] == pytest.approx(np.mean(misses))
    assert worse.scores["epsilon"] == pytest.approx(0.5)


def test_energies_count_only_what_was_found_within_the_residual(good, poor):
    comparison = compare([good, poor], levels=[1e-3, 4e-3, 9e-3])
    better, worse = (group.runs[0] for group in comparison.groups)
    assert better.energies == (0.8, 0.5, 0.4)  # (4, .5) is within 4 mm
    assert comparison.best == better.energies
    assert better.gaps == (0, 0, 0)
    np.testing.assert_allclose(worse.energies, [np.nan, 0.9, 0.6])
    np.testing.assert_allclose(worse.gaps, [np.nan, 0.9 / 0.5 - 1, 0.6 / 0.4 - 1])
    assert worse.gaps_between == pytest.approx(worse.gaps, nan_ok=True)


def test_seeds_are_taken_together_as_attainment_surfaces(good, front_of):
    runs = [front_of([(1, e), (5, e - 0.2)], seed=s) for s, e in enumerate((0.5, 0.7, 0.6))]
    comparison = compare([*runs, good])
    group = comparison.groups[0]
    assert [run.front.record.seed for run in group.runs] == [0, 1, 2]
    for surface, energy in ((group.best, 0.5), (group.median, 0.6), (group.worst, 0.7)):
        np.testing.assert_allclose(surface, [[1e-3, energy], [5e-3, energy - 0.2]])
    spread = group.spread("energies", 1)  # at 1 mm
    assert (spread.lower, spread.median, spread.upper) == pytest.approx((0.5, 0.6, 0.7))
    assert group.spread("front.record.evaluations").median == 100


@pytest.mark.parametrize(
    ("other", "labels"),
    [
        ({"method": "epsilon"}, ["NSGA-II", "epsilon constraint"]),
        ({"bound": 0.5}, ["NSGA-II, bound 0.2", "NSGA-II, bound 0.5"]),
        ({"seed": 1}, ["NSGA-II"]),
    ],
)
def test_methods_are_named_with_what_tells_them_apart(poor, front_of, other, labels):
    comparison = compare([poor, front_of([(1, 0.9)], **other)])
    assert [group.label for group in comparison.groups] == labels


def test_fronts_of_other_tasks_are_refused_and_rounding_is_no_other_task(poor, front_of, task):
    other = front_of([(1, 0.5)], task=dataclasses.replace(task, target=1.0))
    with pytest.raises(ValueError, match=r"b.json is of another task than a.json: its target is 1"):
        compare([poor, other], ["a.json", "b.json"])
    with pytest.raises(ValueError, match=r"ref.json is of another task"):
        compare([poor], reference=other, reference_name="ref.json")
    rounded = front_of([(1, 0.5)], task=dataclasses.replace(task, target=task.target * (1 + 1e-15)))
    assert len(compare([poor, rounded]).runs) == 2


# Real fronts: what lies between their points


@pytest.fixture(scope="module")
def real():
    """A gradient's front of the README's move, of a few points."""
    task = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
    return epsilon_front(task, CycloidPolynomial(2), bound=0.2, points=9)


def test_the_number_of_points_does_not_decide(real):
    """Every other point left out: as found the front seems far worse, filled it is the same."""
    thinned = dataclasses.replace(real, points=real.points[::2]).restated(method="thinned")
    whole, few = (group.runs[0] for group in compare_fronts([real, thinned]).groups)
    lost_as_found = whole.scores_found["hypervolume"] - few.scores_found["hypervolume"]
    assert lost_as_found > 0.004
    lost = abs(whole.scores["hypervolume"] - few.scores["hypervolume"])
    assert lost < lost_as_found / 20
    assert max(few.gaps) > 20 * max(few.gaps_between)
