"""Searches: what they find, what a front is, and what is refused."""

import dataclasses
import math
import random
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from quietarm.metaheuristics import CONSTRICTION, search
from quietarm.ocp import CycloidPolynomial, Front, PointToPoint, resimulate, rollout
from small_searches import (
    BOUNDS,
    HALF,
    METHODS,
    SWARMS,
    TASKS,
    assert_is_a_front,
    exactly,
    found,
    one_line,
    pi,
    run,
)

# -- what a front is --


@METHODS
@pytest.mark.parametrize("seed", [0, 1])
def test_points_are_sorted_and_none_is_better_than_another(method, seed):
    front = found(method, seed=seed)
    assert len(front.points) > 3
    assert_is_a_front(front)


@METHODS
def test_figures_are_those_of_the_finer_rollout_and_of_the_independent_integrator(method):
    front = found(method)
    for point in front.points:
        motion = rollout(front.task, front.profile, point.coefficients).motion
        assert point.energy == pytest.approx(motion.energy, rel=1e-12)
        assert point.residual == pytest.approx(motion.residual, rel=5e-5)
    for point in (front.points[0], front.points[-1]):
        motion = resimulate(front.task, front.profile, point.coefficients)
        assert point.energy == pytest.approx(motion.energy, rel=1e-5)
        assert point.residual == pytest.approx(motion.residual, rel=1e-4, abs=1e-6)


@METHODS
def test_coefficients_stay_in_the_box(method):
    coefficients = np.array([point.coefficients for point in found(method).points])
    assert coefficients.shape[1] == 6
    assert np.all(np.abs(coefficients) <= BOUNDS[method])
    assert np.abs(coefficients).max() > BOUNDS[method] / 10


@METHODS
def test_provenance(method):
    front = found(method)
    assert (front.task, front.profile) == (TASKS[method], CycloidPolynomial(6))
    assert (front.method, front.seed, front.complete) == (method, 0, True)
    asked = {"bound": BOUNDS[method], "population": 20, "generations": 15}
    assert asked.items() <= dict(front.settings).items()
    assert front.failed == 0
    assert front.seconds > 0
    # what a result depends on; 'versions: of what computed it'
    assert {"quietarm", "casadi", "numpy", "python", "pymoo"} <= front.versions.keys()


def test_the_operators_of_nsga2_are_in_the_front():
    # docs/physics.md, 'NSGA-II settings'
    stated = found("nsga2").settings
    assert stated["crossover"] == "SBX(prob=0.8, prob_var=0.5, eta=15)"
    assert stated["mutation"] == "PM(prob=1, prob_var=0.01, eta=20)"
    assert {"sampling", "selection", "survival", "duplicates"} <= stated.keys()


def test_the_constants_of_vepso_are_in_the_front():
    stated = dict(found("vepso").settings)
    assert dataclasses.asdict(CONSTRICTION).items() <= stated.items()
    assert (stated["boundary"], stated["velocity_limit"]) == ("clip", 1.0)


@METHODS
def test_a_front_cannot_be_changed(method):
    front = found(method)
    before = exactly(front)
    with pytest.raises(dataclasses.FrozenInstanceError):
        front.points = ()
    with pytest.raises(dataclasses.FrozenInstanceError):
        front.points[0].energy = 0.0
    with pytest.raises(TypeError):
        front.points[0] = front.points[1]
    with pytest.raises(TypeError):
        front.points[0].coefficients[0] = 0.0
    for array in (front.residuals, front.energies):
        array[:] = 0.0  # a copy
    assert exactly(front) == before


@METHODS
def test_a_front_comes_back_from_its_file(tmp_path, method):
    found(method).save(tmp_path / "front.json")
    loaded = Front.load(tmp_path / "front.json")
    assert loaded == found(method)
    assert exactly(loaded) == exactly(found(method))


@METHODS
def test_numpys_integers_are_taken_and_saved(tmp_path, method):
    front = run(
        method,
        seed=np.int64(3),
        population=np.int64(8),
        generations=np.int64(3),
        bound=np.float64(BOUNDS[method]),
    )
    assert exactly(front) == exactly(run(method, seed=3, population=8, generations=3))
    front.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front


# -- seeds --


@METHODS
def test_the_seed_decides(method):
    again, other = run(method, seed=0), found(method, seed=1)
    assert again == found(method)
    assert exactly(again) == exactly(found(method))
    assert {p.coefficients for p in other.points}.isdisjoint(
        p.coefficients for p in found(method).points
    )


@METHODS
def test_two_threads_find_the_same(method):
    # more than a block of 200, lest there is nothing to share
    one, two = (run(method, population=250, generations=3, threads=n) for n in (1, 2))
    assert exactly(one) == exactly(two)


@METHODS
def test_numpys_own_generator_does_not_matter(method):
    np.random.seed(1)  # noqa: NPY002
    random.seed(1)
    assert exactly(run(method)) == exactly(found(method))


# -- selecting --


@METHODS
def test_selecting(method):
    front = found(method)
    points = front.points
    assert front.stillest() is min(points, key=lambda p: p.residual)
    assert front.cheapest() is min(points, key=lambda p: p.energy)
    middle = points[len(points) // 2]
    assert front.cheapest(middle.residual) is middle
    assert front.cheapest(math.nextafter(middle.residual, 0)) is points[len(points) // 2 - 1]
    with pytest.raises(ValueError, match="at least that of the stillest") as caught:
        front.cheapest(points[0].residual / 2)
    assert f"{points[0].residual:.3g} m" in str(caught.value)
    one_line(caught)
    # farthest from the straight line between the ends, both objectives scaled to [0, 1]
    F = np.column_stack([front.residuals, front.energies])
    scaled = (F - F.min(axis=0)) / np.ptp(F, axis=0)
    assert front.knee() is points[int(np.argmin(scaled.sum(axis=1)))]
    assert scaled[points.index(front.knee())].sum() < 1


# -- memory --

LARGE = """
import math
from quietarm.metaheuristics import search
from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import PointToPoint

task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
front = search(task, "nsga2", bound=0.5, population=10_000, generations=1)
# not ru_maxrss, which over fork and exec starts from the peak of the parent
(peak,) = [line for line in open("/proc/self/status") if line.startswith("VmHWM")]
print(front.evaluations, peak.split()[1])
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="peaks are read from /proc")
def test_a_population_of_ten_thousand_needs_little_memory():
    # pymoo's duplicate elimination held 10,000 x 10,000 distances: 1.8 GB. Measured: 0.14 GB.
    command = [sys.executable, "-c", LARGE]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=600)
    evaluations, kilobytes = map(int, done.stdout.split())
    assert evaluations == 10_000
    assert kilobytes < 400_000


# -- bad input --


@METHODS
def test_a_missing_bound_names_the_papers(method):
    # Eqs (12) and (17).
    with pytest.raises(ValueError, match="bound") as caught:
        search(TASKS[method], method)
    assert "0.2 for single-link" in str(caught.value)
    assert "0.5 for arm-on-flexible-link" in str(caught.value)
    one_line(caught)


def _cancel(progress):
    if progress.generation > 20:
        raise RuntimeError("the search went on in spite of its odd settings")


@METHODS
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("population", 0),
        ("population", -5),
        ("population", 10.5),
        ("population", "20"),
        ("population", math.nan),
        ("generations", 0),
        ("generations", -1),
        ("generations", 2.5),
        ("generations", math.inf),
        ("generations", math.nan),
        ("generations", "3"),
        ("seed", -1),
        ("seed", 1.5),
        ("seed", None),
        ("bound", 0),
        ("bound", -0.5),
        ("bound", math.nan),
        ("bound", math.inf),
        ("threads", 0),
        ("threads", -2),
        ("threads", 1.5),
    ],
)
def test_odd_settings_are_named_with_a_remedy(method, name, value):
    settings = {"population": 4, "generations": 2, name: value}
    with pytest.raises(ValueError, match=f"{name}.* is .*; give ") as caught:
        run(method, **settings, report=_cancel)
    assert str(value) in str(caught.value)
    one_line(caught)


@METHODS
def test_a_population_of_one_is_too_small(method):
    # what was typed, not what the algorithm calls it
    with pytest.raises(ValueError, match=r"population is 1; give a whole number from 2") as caught:
        run(method, population=1)
    one_line(caught)


def test_an_unknown_method_is_named_with_the_known_ones():
    with pytest.raises(ValueError, match=r"'pso'.*vepso.*nsga2"):
        search(HALF, "pso", bound=0.5)


@pytest.mark.parametrize("algorithm", [NSGA2, None, 3])
def test_what_is_no_algorithm_is_named(algorithm):
    words = r"algorithm is .*; give vepso, nsga2, .* or an instance of one of pymoo's"
    with pytest.raises(ValueError, match=words) as caught:
        search(HALF, algorithm, bound=0.5, generations=3)
    one_line(caught)


def test_an_algorithm_of_your_own_needs_generations_and_has_its_population():
    with pytest.raises(ValueError, match="number of generations for NSGA2"):
        search(HALF, NSGA2(pop_size=10), bound=0.5)
    with pytest.raises(ValueError, match="population is set in the algorithm"):
        search(HALF, NSGA2(pop_size=10), bound=0.5, generations=3, population=10)


@METHODS
def test_a_profile_without_coefficients_is_refused(method):
    with pytest.raises(ValueError, match="0 terms has nothing to choose"):
        run(method, profile=CycloidPolynomial(0))


@pytest.mark.parametrize(("method", "terms"), [("vepso", 1), ("nsga2", 8)])
def test_any_number_of_terms(method, terms):
    front = run(method, profile=CycloidPolynomial(terms), generations=5)
    assert front.profile == CycloidPolynomial(terms)
    assert {len(point.coefficients) for point in front.points} == {terms}
    assert front.evaluations == SWARMS[method] * 100
    assert_is_a_front(front)


def test_a_plant_of_two_modes(two_links):
    # docs/physics.md, 'A third plant'
    task = PointToPoint(two_links, pi / 2, 0.9)
    front = search(task, "nsga2", bound=0.3, population=30, generations=30)
    assert_is_a_front(front)
    stillest, cheapest = (
        resimulate(task, front.profile, point.coefficients)
        for point in (front.stillest(), front.cheapest())
    )
    plain = resimulate(task, CycloidPolynomial(0), [])
    assert stillest.residual < plain.residual / 4
    assert cheapest.energy < plain.energy
