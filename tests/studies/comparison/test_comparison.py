"""Fronts held against each other; indicators are worked out by hand on staircases of few steps."""

import dataclasses
import math
from functools import partial

import numpy as np
import pytest
import quietarm.studies.comparison.measures
import quietarm.studies.reports.comparison
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import (
    CopperLoss,
    CycloidPolynomial,
    PointToPoint,
    epsilon_front,
    evaluate_coefficients,
)
from quietarm.studies.comparison.measures import FILL
from quietarm.studies.comparison.staircase import filled

# The fronts are invented, not motions of the plant: nothing can be evaluated between their points.
compare = partial(quietarm.studies.comparison.measures.compare_fronts, fill=0)
# Corners are (10 mm, 1 J); `good` and `poor` stand in conftest.py.


@pytest.fixture
def measured(good, poor):
    comparison = compare([good, poor])
    return comparison, *(group.runs[0] for group in comparison.groups)


def test_hypervolume_is_the_share_of_the_common_box(measured):
    comparison, better, worse = measured
    # the best front goes from 0 to 8 mm and from 0.8 to 0.4 J: a tenth of that beyond its ends
    assert comparison.corner == pytest.approx((8.8e-3, 0.84))
    # widths times heights of the steps, of a box of 8.8 by 0.44
    box = 8.8 * 0.44
    assert better.hypervolume == pytest.approx((4 * 0.04 + 4 * 0.34 + 0.8 * 0.44) / box)
    assert worse.hypervolume == pytest.approx(2.8 * 0.24 / box)


def test_the_box_is_that_of_the_best_front(front_of):
    far = front_of([(0, 2.0), (20, 0.4)], "epsilon", reference=(1e-9, 1e-9))
    comparison = compare([far, front_of([(1, 3.0)], "vepso", reference=(1e-9, 1e-9))])
    assert comparison.corner == pytest.approx((22e-3, 2.16))  # a tenth of 20 mm and of 1.6 J on


def test_igd_plus_and_epsilon_in_units_of_the_best_fronts_extent(measured, good):
    comparison, better, worse = measured
    assert comparison.extent == pytest.approx((8e-3, 0.4))
    assert (better.igd_plus, better.epsilon) == (0, 0)
    # Each point of good, and by how much the nearer of poor's misses it in (residual, energy):
    # (0, .8): (2/8, .1/.4); (4, .5): the second (2/8, .1/.4); (8, .4): the second (0, .2/.4).
    misses = [math.hypot(0.25, 0.25), math.hypot(0.25, 0.25), 0.5]
    assert worse.igd_plus == pytest.approx(np.mean(misses))
    assert worse.epsilon == pytest.approx(0.5)


def test_a_crowd_of_points_does_not_decide_what_the_others_miss(front_of):
    """Distances are over even stations: a thousand points in one place weigh as one."""
    spread = [(r, 1 - 0.09 * r) for r in np.linspace(0, 10, 101)]
    crowd = [(0.05 + 1e-5 * i, 0.9956 - 1e-7 * i) for i in range(1000)]
    other = front_of([(0, 1.0), (5, 0.6)], "vepso")
    even = compare([front_of(spread), other]).groups[1].runs[0]
    crowded = compare([front_of([*spread, *crowd]), other]).groups[1].runs[0]
    assert crowded.igd_plus == pytest.approx(even.igd_plus, rel=0.01)


def test_energies_count_only_what_was_found_within_the_residual(good, poor):
    comparison = compare([good, poor], levels=[1e-3, 4e-3, 9e-3])
    better, worse = (group.runs[0] for group in comparison.groups)
    assert better.energies == (0.8, 0.5, 0.4)  # (4, .5) is within 4 mm
    assert comparison.best == better.energies
    assert better.gaps == (0, 0, 0)
    np.testing.assert_allclose(worse.energies, [np.nan, 0.9, 0.6])
    np.testing.assert_allclose(worse.gaps, [np.nan, 0.9 / 0.5 - 1, 0.6 / 0.4 - 1])
    assert worse.gaps_between == pytest.approx(worse.gaps, nan_ok=True)


def test_coverage_is_the_share_that_the_other_dominates_or_equals(measured, good, front_of):
    comparison, *_ = measured
    np.testing.assert_allclose(comparison.coverage, [[np.nan, 1], [0, np.nan]])
    half = front_of([(0, 0.8), (3, 0.45)], "vepso")  # its first is good's, its second better
    np.testing.assert_allclose(compare([good, half]).coverage, [[np.nan, 0.5], [2 / 3, np.nan]])


def test_seeds_are_taken_together_as_attainment_surfaces(good, front_of):
    runs = [front_of([(1, e), (5, e - 0.2)], seed=s) for s, e in enumerate((0.5, 0.7, 0.6))]
    comparison = compare([*runs, good])
    group = comparison.groups[0]
    assert [run.front.seed for run in group.runs] == [0, 1, 2]
    for surface, energy in ((group.best, 0.5), (group.median, 0.6), (group.worst, 0.7)):
        np.testing.assert_allclose(surface, [[1e-3, energy], [5e-3, energy - 0.2]])
    spread = group.spread("energies", 1)  # at 1 mm
    assert (spread.lower, spread.median, spread.upper) == pytest.approx((0.55, 0.6, 0.65))
    assert group.spread("front.evaluations").median == 100


def test_seeds_that_reach_a_residual_are_counted(good, front_of):
    runs = [front_of([(residual, 0.5)], seed=i) for i, residual in enumerate((0.05, 0.5, 3))]
    group = compare([*runs, good]).groups[0]
    assert [group.reached(level) for level in range(3)] == [1, 2, 3]


@pytest.mark.parametrize(
    ("other", "labels"),
    [
        ({"method": "epsilon"}, ["NSGA-II", "epsilon constraint"]),
        ({"bound": 0.5}, ["NSGA-II, bound 0.2", "NSGA-II, bound 0.5"]),
        ({"bound": 0.2000001}, ["NSGA-II, bound 0.2", "NSGA-II, bound 0.2000001"]),
        ({"terms": 4}, ["NSGA-II, terms 2", "NSGA-II, terms 4"]),
        ({"complete": False}, ["NSGA-II", "NSGA-II, interrupted"]),
        ({"method": "MOEAD"}, ["NSGA-II", "MOEAD"]),
        ({"seed": 1}, ["NSGA-II"]),
    ],
)
def test_methods_are_named_with_what_tells_them_apart(poor, front_of, other, labels):
    comparison = compare([poor, front_of([(1, 0.9)], **other)])
    assert [group.label for group in comparison.groups] == labels


OTHERS = {
    "plant is arm-on-flexible-link, not single-link": {"plant": ArmOnFlexibleLink()},
    "plant parameter zeta is 0.5, not 0.009636": {"plant": SingleLinkManipulator(zeta=0.5)},
    "start is 0.1 rad, not 0 rad": {"start": 0.1},
    "target is 1 rad, not 0.5235987756 rad": {"target": 1.0},
    "duration is 0.9 s, not 0.8 s": {"duration": 0.9},
    "residual window is 0.5 s, not 1 s": {"residual_window": 0.5},
    "torque limit is 2 N m, not none": {"torque_limit": 2.0},
    "deflection limit is 0.1 m, not none": {"deflection_limit": 0.1},
    "energy is copper:0.12, not absolute": {"energy": CopperLoss(0.12)},
    "duration is 1 s, not 0.8 s, speed limit is 3 rad/s, not none": {
        "duration": 1.0, "speed_limit": 3.0
    },
}  # fmt: skip


@pytest.mark.parametrize("words", OTHERS)
def test_another_task_is_refused_and_the_difference_named(words, good, poor, front_of, task):
    other = front_of([(1, 0.5)], task=dataclasses.replace(task, **OTHERS[words]))
    with pytest.raises(ValueError, match=r"b.json is of another task than a.json") as refused:
        compare([good, other], ["a.json", "b.json"])
    assert words in str(refused.value)
    with pytest.raises(ValueError, match=r"ref.json is of another task"):
        compare([good, poor], reference=other, reference_name="ref.json")


def test_a_task_in_degrees_is_the_one_in_radians_but_for_rounding(good, front_of, task):
    degrees = dataclasses.replace(task, target=task.target * (1 + 1e-15))
    assert degrees.target != task.target
    assert compare([good, front_of([(1, 0.5)], task=degrees)]).task == task


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"names": ["a"]}, r"names are \['a'\]; give one for each of 2 fronts"),
        ({"names": ["a", "a"]}, "'a' is the name of two fronts; give each one of its own"),
        ({"levels": [-1]}, "level is -1 m; give a positive number"),
        ({"levels": []}, r"no levels are given; give one residual in m or more, as \[1e-3\]"),
        ({"levels": [math.nan]}, "level is nan; give a finite number in m"),
        ({"fill": -5}, "fill is -5; give a whole number from 0 up"),
        ({"floor": math.nan}, "floor is nan; give a finite number in J"),
        ({"floor": -3}, "floor is -3 J; give 0 or more"),
    ],
)
def test_arguments_out_of_range_are_refused_in_a_line(good, poor, arguments, words):
    with pytest.raises(ValueError, match=words) as refused:
        compare([good, poor], **arguments)
    assert "\n" not in str(refused.value)


# Real fronts: what lies between their points


@pytest.fixture(scope="module")
def real():
    """A gradient's front of the README's move, of a few points."""
    task = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
    return epsilon_front(task, CycloidPolynomial(2), bound=0.2, points=9)


def test_between_points_lie_motions_with_coefficients_in_between(real):
    one, other = real.points[3:5]
    middle = np.mean([one.coefficients, other.coefficients], axis=0)
    plan = evaluate_coefficients(real.task, middle)  # by CVODES
    table = filled(real, 2 * (len(real.points) - 1))  # one between each two
    found = table[np.argmin(np.abs(table[:, 0] - plan.residual))]
    assert tuple(found) == pytest.approx((plan.residual, plan.energy), rel=1e-4)
    assert one.residual < found[0] < other.residual
    assert one.energy > found[1] > other.energy


def test_a_filled_front_is_one(real):
    table = filled(real, FILL)
    assert len(table) > FILL / 2
    assert (np.diff(table[:, 0]) > 0).all()
    assert (np.diff(table[:, 1]) < 0).all()


def test_the_number_of_points_does_not_decide(real):
    """Every other point left out: as found the front seems far worse, filled it is the same."""
    thinned = dataclasses.replace(real, points=real.points[::2], method="thinned")
    whole, few = (
        group.runs[0]
        for group in quietarm.studies.comparison.measures.compare_fronts([real, thinned]).groups
    )
    lost_as_found = whole.hypervolume_found - few.hypervolume_found
    assert lost_as_found > 0.004
    assert abs(whole.hypervolume - few.hypervolume) < lost_as_found / 20
    assert max(few.gaps) > 20 * max(few.gaps_between)


def test_motions_between_that_break_a_limit_do_not_count(real):
    limited = dataclasses.replace(real, task=dataclasses.replace(real.task, torque_limit=1e-6))
    np.testing.assert_array_equal(filled(limited, FILL)[:, 0], real.residuals)
