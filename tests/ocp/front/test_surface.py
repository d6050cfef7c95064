"""Fronts of three objectives and more, by the gradient and by searches, against brute force."""

import dataclasses

import moocore
import numpy as np
import pytest
from moves import CASES

import quietarm as qa
from quietarm.metaheuristics import MoveFunction
from quietarm.metaheuristics.evaluation.stated_figures import check_figures
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    FrontPoint,
    Ipopt,
    Sqp,
    cross_check,
    epsilon_front,
    non_dominated,
    polish_front,
)
from quietarm.ocp.objectives import checked_objectives, known_objectives

SIXTH, _ = CASES["single link"]
THREE = ("residual", "energy", "peak_torque")
FOUR = (*THREE, "peak_deflection")
TWO_TERMS = CycloidPolynomial(2)


@pytest.fixture(scope="module")
def front():
    return epsilon_front(SIXTH, TWO_TERMS, bound=0.2, points=60, objectives=THREE)


@pytest.fixture(scope="module")
def lattice():
    """Objectives of 101 x 101 pairs of coefficients: brute force."""
    function = MoveFunction(SIXTH, TWO_TERMS, bound=0.2, objectives=THREE, steps=96)
    axis = np.linspace(-0.2, 0.2, 101)
    rows = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    return function(rows)[0]


@pytest.mark.slow
def test_no_motion_of_a_lattice_of_coefficients_dominates_a_point(front, lattice):
    # within what the nodes of 96 steps miss of a peak, 1 %
    for values in front.objective_values:
        better = (lattice < values * (1 - 1e-2) - [1e-6, 0.0, 0.0]).all(axis=1)
        assert not better.any()


@pytest.mark.slow
def test_its_hypervolume_is_that_of_the_lattice(front, lattice):
    best = moocore.filter_dominated(lattice)
    ideal = best.min(axis=0)
    extent = np.ptp(best, axis=0)

    def volume(points):
        return moocore.hypervolume((points - ideal) / extent, ref=[1.1] * 3)

    # both are samples of the same surface, the front of fewer points, which are exact
    assert len(best) > 100
    assert 0.95 < volume(front.objective_values) / volume(best) < 1.01


@pytest.mark.slow
def test_a_point_has_the_figures_of_its_motion_and_the_file_keeps_them(front, tmp_path):
    for point in front.points[::7]:
        motion = qa.evaluate_coefficients(SIXTH, point.coefficients).motion
        assert point.values(["torque"]) == pytest.approx(
            (motion.residual, motion.energy, motion.peak_torque), rel=1e-6, abs=1e-9
        )
    front.save(tmp_path / "front.json")
    again = Front.load(tmp_path / "front.json")
    assert again == front
    check_figures(again, "front.json")
    assert list(front.columns())[:4] == ["residual_m", "energy_J", "peak_torque_Nm", "a_1"]
    front.save_csv(tmp_path / "front.csv")
    assert len((tmp_path / "front.csv").read_text().splitlines()) == len(front.points) + 1


@pytest.mark.slow
def test_it_has_the_ends_of_every_objective(front):
    curve = epsilon_front(SIXTH, TWO_TERMS, bound=0.2, points=2)
    assert front.cheapest().energy == pytest.approx(curve.cheapest().energy, rel=1e-4)
    least = curve.smallest_residual().residual
    assert front.smallest_residual().residual == pytest.approx(least, rel=2e-3, abs=1e-8)
    limited = dataclasses.replace(SIXTH, torque_limit=0.9 * front.objective_values[:, 2].min())
    with pytest.raises(qa.InfeasibleTaskError):
        epsilon_front(limited, TWO_TERMS, bound=0.2, points=2)


@pytest.mark.slow
def test_a_limit_of_the_task_holds_on_the_surface():
    limited = dataclasses.replace(SIXTH, torque_limit=0.15)
    inside = epsilon_front(limited, TWO_TERMS, bound=0.2, points=16, objectives=THREE)
    assert inside.objective_values[:, 2].max() <= 0.15 * (1 + 1e-9)
    assert inside.task == limited


@pytest.mark.slow
def test_both_solvers_find_the_same_surface():
    fronts = [
        epsilon_front(SIXTH, TWO_TERMS, bound=0.2, points=6, objectives=THREE, solver=solver)
        for solver in (Sqp(), Ipopt())
    ]
    by_sqp, by_ipopt = (front.objective_values for front in fronts)
    np.testing.assert_allclose(by_sqp.min(axis=0), by_ipopt.min(axis=0), rtol=1e-4, atol=1e-8)
    np.testing.assert_allclose(by_sqp.max(axis=0), by_ipopt.max(axis=0), rtol=1e-3, atol=1e-8)


@pytest.mark.slow
def test_four_objectives_and_polishing():
    searched = qa.search(
        SIXTH,
        TWO_TERMS,
        algorithm="nsga3",
        bound=0.2,
        population=20,
        generations=5,
        objectives=FOUR,
    )
    assert searched.objective_values.shape[1] == 4
    check_figures(searched, "searched")
    polish = polish_front(searched)
    assert len(polish.gains) == len(searched.points)
    assert min(gain.share for gain in polish.gains) >= 0
    # nothing of the front before dominates a point after
    for values in polish.front.objective_values:
        assert not (searched.objective_values < values * (1 - 1e-3)).all(axis=1).any()


def test_objectives_are_a_set_in_one_order():
    assert checked_objectives(["peak-torque", "energy", "residual"]) == THREE
    assert tuple(known_objectives())[:3] == ("residual", "energy", "peak_torque")
    for names, words in (
        (["residual"], "without the energy"),
        (["energy", "residual", "energy"], "energy is given twice"),
        (["residual", "energy", "peak"], "unknown objective 'peak'"),
        (["residual", "energy", 3], "unknown objective '3'"),
        ("residual,energy", "give a list of names"),
    ):
        with pytest.raises(ValueError, match=words):
            checked_objectives(names)


def test_dominance_is_of_all_objectives():
    def point(residual, energy, torque):
        return FrontPoint((0.0, 0.0), residual, energy, peaks={"torque": torque})

    first, worse = point(1.0, 1.0, 3.0), point(1.0, 2.0, 3.0)
    quiet, third = point(0.5, 3.0, 3.0), point(2.0, 2.0, 1.0)
    assert non_dominated([worse, third, first, quiet, first], THREE) == (quiet, first, third)


@pytest.mark.slow
def test_points_of_other_peaks_and_orders_are_refused(front):
    for change, words in (
        ({"points": front.points[::-1]}, "out of order"),
        ({"reference": front.reference[:2]}, "its reference has 2 figures; give one for each"),
        ({"objectives": FOUR, "reference": (*front.reference, 1.0)}, "the peaks of point 1 are"),
    ):
        with pytest.raises(ValueError, match=words):
            dataclasses.replace(front, **change)


@pytest.mark.slow
def test_a_cross_check_refuses_more_objectives_in_one_line(front):
    with pytest.raises(ValueError, match="cross check is of residual and energy; find"):
        cross_check(front)
