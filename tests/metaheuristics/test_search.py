"""Searches: what they find, what they promise about it, and long work that is broken off."""

import dataclasses
import json
import math
import os
import random
import re
import signal
import subprocess
import sys
import threading
import time
from functools import cache

import numpy as np
import pytest
from pymoo.algorithms.moo.moead import MOEAD
from pymoo.algorithms.moo.mopso_cd import MOPSO_CD
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.algorithms.moo.sms import SMSEMOA
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.nelder import NelderMead
from pymoo.algorithms.soo.nonconvex.pattern import PatternSearch
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.util.ref_dirs import get_reference_directions

from metaheuristics import (
    CONSTRICTION,
    INERTIA_2002,
    PRESETS,
    VEPSO,
    MoveProblem,
    PaperNSGA2,
    PopulationObjective,
    search,
)
from metaheuristics.checkpoint import load_checkpoint
from metaheuristics.population import LEAST_STEPS
from models import ArmOnFlexibleLink, SingleLinkManipulator
from ocp import CycloidPolynomial, FileFormatError, Front, PointToPoint, resimulate, rollout

module = sys.modules["metaheuristics.run"]
pi = math.pi
SINGLE_LINK, ARM = SingleLinkManipulator(), ArmOnFlexibleLink()
SIXTH, HALF = PointToPoint(SINGLE_LINK, pi / 6, 0.8), PointToPoint(ARM, pi / 2, 0.8)
TASKS = {"nsga2": HALF, "vepso": SIXTH}
BOUNDS = {"nsga2": 0.5, "vepso": 0.2}  # eqs (17) and (12)
SWARMS = {"nsga2": 1, "vepso": 2}  # how many times the population is evaluated in a generation
METHODS = pytest.mark.parametrize("method", ["nsga2", "vepso"])


def run(method, task=None, **settings):
    """A small search with what a test does not care about filled in."""
    given = {"bound": BOUNDS[method], "population": 20, "generations": 15, **settings}
    return search(TASKS[method] if task is None else task, method, **given)


@cache
def found(method, seed=0):
    """The small search, done once."""
    return run(method, seed=seed)


def exactly(front):
    """All of a front but its time, to the last bit."""
    return json.dumps({**front.to_document(), "seconds": None})


def assert_is_a_front(front):
    """Sorted, finite, mutually non-dominated."""
    F = np.column_stack([front.residuals, front.energies])
    assert np.isfinite(F).all()
    assert np.all(np.diff(front.residuals) > 0)
    assert np.all(np.diff(front.energies) < 0)


def one_line(caught):
    assert "\n" not in str(caught.value)


# -- the paper --

# Tables 3 and 6: conditions, F2 [J]. Residual: physics.md, max |W| of the paper's own N = 6
# coefficients for the first condition of each plant (a_5 mended), times phi.
STILL = {"vepso": 1.58e-4 * 2.28, "nsga2": 6.6e-4 * 0.508}
VEPSO_ROWS = [(pi / 6, 0.8, 0.0515), (pi / 2, 1.0, 0.296), (pi / 2, 1.1, 0.223)]
ARM_ROWS = [(0.0, pi / 2, 0.8, 0.149), (-pi / 2, pi / 4, 1.0, 0.143), (-pi / 2, pi / 2, 1.2, 0.200)]


def assert_reaches(front, energy):
    point = front.cheapest(STILL[front.method])
    assert point.energy <= energy
    motion = resimulate(front.task, front.profile, point.coefficients)
    assert motion.energy <= energy * (1 + 1e-5)
    assert motion.residual <= STILL[front.method] * (1 + 1e-3)


@pytest.mark.parametrize(("target", "duration", "energy"), VEPSO_ROWS)
def test_vepso_reaches_the_papers_energy_with_the_papers_settings(target, duration, energy):
    front = search(PointToPoint(SINGLE_LINK, target, duration), "vepso", bound=0.2)
    assert front.evaluations == 2 * 100 * 200  # section 3.1: particles, iterations
    assert_reaches(front, energy)


def test_nsga2_reaches_the_papers_energy_with_the_papers_settings():
    front = search(HALF, "nsga2", bound=0.5)
    assert front.evaluations == 200 * 500  # section 3.2
    assert len(front.history) == 500
    assert_reaches(front, 0.149)


@pytest.mark.parametrize(("start", "target", "duration", "energy"), ARM_ROWS)
def test_nsga2_reaches_the_papers_energy_with_a_tenth_of_its_budget(
    start, target, duration, energy
):
    task = PointToPoint(ARM, target, duration, start)
    assert_reaches(search(task, "nsga2", bound=0.5, population=80, generations=120), energy)


def test_vepso_reaches_the_papers_energy_with_a_third_of_its_budget():
    assert_reaches(search(SIXTH, "vepso", bound=0.2, population=60, generations=100), 0.0515)


# -- what a front is --


@METHODS
@pytest.mark.parametrize("seed", [0, 1])
def test_points_are_sorted_and_none_is_better_than_another(method, seed):
    front = found(method, seed)
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
    # physics.md, 'NSGA-II settings'
    stated = found("nsga2").settings
    assert stated["crossover"] == "SBX(prob=0.8, prob_var=0.5, eta=15)"
    assert stated["mutation"] == "PM(prob=1, prob_var=0.01, eta=20)"
    assert {"sampling", "selection", "survival", "duplicates"} <= stated.keys()


def test_the_constants_of_vepso_are_in_the_front():
    stated = dict(found("vepso").settings)
    assert dataclasses.asdict(CONSTRICTION).items() <= stated.items()
    assert (stated["boundary"], stated["velocity_limit"]) == ("clip", 1.0)


def test_the_papers_settings_are_the_defaults():
    # Sections 3.1 and 3.2.
    assert dataclasses.astuple(PRESETS["vepso"]) == (100, 200)
    assert dataclasses.astuple(PRESETS["nsga2"]) == (200, 500)


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
        if array.flags.writeable:  # then a copy
            array[:] = 0.0
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


# -- history and reports --


@METHODS
@pytest.mark.parametrize(("population", "generations"), [(20, 15), (7, 3), (2, 1), (201, 2)])
def test_evaluations_are_exact(monkeypatch, method, population, generations):
    asked = []
    evaluate = PopulationObjective.__call__

    def counting(self, coefficients):
        if self.steps == LEAST_STEPS:  # not the finer one, for the points of the front
            asked.append(len(coefficients))
        return evaluate(self, coefficients)

    monkeypatch.setattr(PopulationObjective, "__call__", counting)
    front = run(method, population=population, generations=generations)
    each = SWARMS[method] * population
    assert sum(asked) == front.evaluations == each * generations
    expected = [each * (k + 1) for k in range(generations)]
    assert [entry.evaluations for entry in front.history] == expected


def _hypervolume(front):
    """Share of the reference box by a sweep along the front."""
    inside = (front.residuals < front.reference[0]) & (front.energies < front.reference[1])
    F = np.column_stack([front.residuals, front.energies])[inside] / front.reference
    right = np.append(F[1:, 0], 1.0)
    return float(((right - F[:, 0]) * (1.0 - F[:, 1])).sum())


@METHODS
def test_hypervolume_by_generation(method):
    front = found(method)
    assert len(front.history) == 15
    shares = [entry.hypervolume for entry in front.history]
    assert 0 <= min(shares) < max(shares) < 1
    # the search's steps are coarser than those of the figures in the front: 1e-4 in energy
    assert shares[-1] == pytest.approx(_hypervolume(front), rel=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_the_hypervolume_of_vepsos_archive_never_falls(seed):
    shares = [entry.hypervolume for entry in found("vepso", seed).history]
    assert np.all(np.diff(shares) >= 0)
    assert shares[-1] > shares[0]


def test_a_plain_cycloid_that_is_still_leaves_a_reference_of_a_millimetre():
    slow = PointToPoint(SINGLE_LINK, 0.01, 20.0)
    assert rollout(slow, CycloidPolynomial(0), []).motion.residual < 1e-6
    front = search(slow, "nsga2", bound=0.05, population=20, generations=15)
    assert front.reference[0] == 1e-3
    assert 0 < front.history[-1].hypervolume < 1


def test_the_reference_is_the_residual_of_the_plain_cycloid_and_twice_its_energy():
    # physics.md: max |W| 3.382e-2 m (times phi) and 0.09115 J; 2.947e-2 m and 0.12457 J.
    assert found("vepso").reference == pytest.approx((2.28 * 3.382e-2, 2 * 0.09115), rel=2e-4)
    assert found("nsga2").reference == pytest.approx((0.508 * 2.947e-2, 2 * 0.12457), rel=2e-4)


@METHODS
def test_a_report_comes_after_every_generation(method):
    seen = []
    front = run(method, report=seen.append)
    assert exactly(front) == exactly(found(method))
    assert [progress.generation for progress in seen] == list(range(1, 16))
    assert {progress.generations for progress in seen} == {15}
    assert [p.evaluations for p in seen] == [entry.evaluations for entry in front.history]
    assert [p.hypervolume for p in seen] == [entry.hypervolume for entry in front.history]
    assert np.all(np.diff([progress.seconds for progress in seen]) >= 0)
    assert seen[-1].residual == pytest.approx(front.stillest().residual, rel=1e-3)
    assert seen[-1].energy == pytest.approx(front.cheapest().energy, rel=1e-3)
    for name in ("residual", "energy"):
        values = [getattr(progress, name) for progress in seen]
        assert values == sorted(values, reverse=True)  # the extremes of a front are kept


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
    with pytest.raises(ValueError, match="the stillest has") as caught:
        front.cheapest(points[0].residual / 2)
    assert f"{points[0].residual:.3g} m" in str(caught.value)
    one_line(caught)
    # farthest from the straight line between the ends, both objectives scaled to [0, 1]
    F = np.column_stack([front.residuals, front.energies])
    scaled = (F - F.min(axis=0)) / np.ptp(F, axis=0)
    assert front.knee() is points[int(np.argmin(scaled.sum(axis=1)))]
    assert scaled[points.index(front.knee())].sum() < 1


# -- limits --

LIMITED = {
    "nsga2": dataclasses.replace(HALF, torque_limit=0.3, acceleration_limit=75.0),
    "vepso": dataclasses.replace(SIXTH, torque_limit=0.16, speed_limit=0.99, deflection_limit=0.03),
}
IMPOSSIBLE = {
    method: dataclasses.replace(task, torque_limit=1e-4) for method, task in LIMITED.items()
}


@METHODS
def test_every_point_keeps_the_limits(method):
    free = [
        rollout(TASKS[method], CycloidPolynomial(6), point.coefficients).motion
        for point in found(method).points
    ]
    task = LIMITED[method]
    for name, limit in task.limits.items():
        assert max(motion.peak(name) for motion in free) > limit  # it bites
    front = run(method, task, population=40, generations=40)
    assert len(front.points) > 3
    assert_is_a_front(front)
    for point in front.points:
        motion = rollout(task, front.profile, point.coefficients).motion
        independent = resimulate(task, front.profile, point.coefficients)
        for name, limit in task.limits.items():
            assert motion.peak(name) <= limit * (1 + 1e-6)
            # a peak between two of the 420 nodes: (2 pi 5/420)^2/8 of a fifth harmonic
            assert independent.peak(name) <= limit * (1 + 7e-4)


@METHODS
def test_limits_that_nothing_keeps_leave_an_empty_front(tmp_path, method):
    task, seen = IMPOSSIBLE[method], []
    front = run(method, task, generations=3, report=seen.append)
    assert front.points == ()
    assert front.evaluations == SWARMS[method] * 60
    assert front.failed == 0
    assert front.infeasible == front.evaluations
    assert [progress.infeasible for progress in seen] == [e.evaluations for e in front.history]
    assert [entry.hypervolume for entry in front.history] == [0.0] * 3
    assert all(math.isnan(progress.residual) for progress in seen)
    words = (
        f"{front.evaluations} of {front.evaluations} candidates break the limits .*torque 0.0001"
    )
    with pytest.raises(ValueError, match=words):
        front.stillest()
    for select in (front.stillest, front.cheapest, front.knee, lambda: front.cheapest(1.0)):
        with pytest.raises(ValueError, match="the front has no point") as caught:
            select()
        one_line(caught)
    front.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front


@METHODS
def test_candidates_that_break_a_limit_are_counted(monkeypatch, method):
    counts, evaluate = [], PopulationObjective.__call__

    def counting(self, coefficients):
        values = evaluate(self, coefficients)
        if self.steps == LEAST_STEPS:
            counts.append(sum(any(v > 0 for v in row) for row in values.violations.tolist()))
        return values

    monkeypatch.setattr(PopulationObjective, "__call__", counting)
    seen = []
    front = run(method, LIMITED[method], report=seen.append)
    assert 0 < front.infeasible < front.evaluations
    assert [progress.infeasible for progress in seen] == np.cumsum(counts).tolist()
    assert front.infeasible == seen[-1].infeasible
    assert found(method).infeasible == 0  # a task without limits


# -- candidates that fail --


def _failing(monkeypatch, value, column="energy"):
    """Half of the candidates, those with a_1 > 0, get `value`; returns how many were, by call."""
    evaluate, counts = PopulationObjective.__call__, []

    def failing(self, coefficients):
        values = evaluate(self, coefficients)
        bad = np.asarray(coefficients)[:, 0] > 0
        if self.steps == LEAST_STEPS:
            counts.append(int(bad.sum()))
        getattr(values, column)[bad] = value
        return values

    monkeypatch.setattr(PopulationObjective, "__call__", failing)
    return counts


@METHODS
@pytest.mark.parametrize(
    ("value", "column"),
    [
        (math.nan, "energy"),
        (math.nan, "residual"),
        (math.inf, "energy"),
        (-math.inf, "residual"),
        (math.nan, "violations"),
    ],
)
def test_failed_candidates_are_counted_and_never_enter_a_front(monkeypatch, method, value, column):
    task = dataclasses.replace(LIMITED[method], torque_limit=0.4)
    counts = _failing(monkeypatch, value, column)
    front = run(method, task, population=12, generations=6)
    assert front.failed == sum(counts) > 6  # more than half of the first generation's half
    assert front.evaluations == SWARMS[method] * 72
    assert len(front.points) > 0
    assert all(point.coefficients[0] <= 0 for point in front.points)
    assert_is_a_front(front)
    assert all(0 <= entry.hypervolume < 1 for entry in front.history)


@METHODS
def test_when_all_candidates_fail_the_front_is_empty(method):
    # motions of 1e200 turns overflow
    front = run(method, bound=1e200, generations=4)
    assert front.points == ()
    assert front.failed == front.evaluations == SWARMS[method] * 80
    assert [entry.hypervolume for entry in front.history] == [0.0] * 4
    with pytest.raises(ValueError, match=r"no point; .* all \d+ .* overflow; give a smaller bound"):
        front.stillest()


@METHODS
def test_failed_candidates_count_on_after_a_resume(tmp_path, monkeypatch, method):
    _failing(monkeypatch, math.nan)
    monkeypatch.setattr(module, "CHECKPOINT_SECONDS", 0.0)
    path = tmp_path / "checkpoint"

    def stop(progress):
        if progress.generation == 5:
            raise KeyboardInterrupt

    whole = run(method)
    part = run(method, checkpoint=path, report=stop)
    assert 0 < part.failed <= whole.failed
    assert exactly(run(method, resume=path)) == exactly(whole)


# -- other algorithms --


def _moead():
    return MOEAD(get_reference_directions("uniform", 2, n_partitions=9), n_neighbors=4)


OTHERS = {
    "SMSEMOA": lambda: SMSEMOA(pop_size=10),
    "MOEAD": _moead,
    "MOPSO_CD": lambda: MOPSO_CD(pop_size=10),
    "NSGA2": lambda: NSGA2(pop_size=10),
    "VEPSO": lambda: VEPSO(particles=5, rule=INERTIA_2002, boundary="reflect"),
}
OTHER = pytest.mark.parametrize("name", OTHERS)


@OTHER
def test_any_algorithm_of_pymoo(tmp_path, name):
    seen = []
    front = search(HALF, OTHERS[name](), bound=0.5, generations=5, seed=2, report=seen.append)
    assert front.method == name
    assert front.complete
    assert len(front.points) > 0
    assert_is_a_front(front)
    assert front.evaluations >= 50  # pymoo's MOPSO-CD evaluates a second population at its start
    assert seen[-1].evaluations == front.evaluations == front.history[-1].evaluations
    front.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front


@OTHER
def test_generations_of_any_algorithm_are_counted_as_asked_for(name):
    # 'history: hypervolume by generation'; a report is one 'after every generation'
    seen = []
    front = search(HALF, OTHERS[name](), bound=0.5, generations=5, seed=2, report=seen.append)
    assert [progress.generation for progress in seen] == [1, 2, 3, 4, 5]
    assert len(front.history) == 5


@OTHER
def test_the_seed_decides_for_any_algorithm(name):
    fronts = [search(HALF, OTHERS[name](), bound=0.5, generations=4, seed=s) for s in (2, 2, 3)]
    assert exactly(fronts[0]) == exactly(fronts[1])
    assert fronts[0].points != fronts[2].points


@OTHER
def test_an_algorithm_may_be_given_twice(name):
    algorithm = OTHERS[name]()
    first, second = (search(HALF, algorithm, bound=0.5, generations=4, seed=2) for _ in range(2))
    assert exactly(first) == exactly(second)


@pytest.mark.parametrize("name", ["SMSEMOA", "MOPSO_CD", "NSGA2", "VEPSO"])
def test_any_algorithm_keeps_the_limits(name):
    task = dataclasses.replace(LIMITED["nsga2"], torque_limit=0.5)
    front = search(task, OTHERS[name](), bound=0.5, generations=6, seed=2)
    assert len(front.points) > 0
    for point in front.points:
        motion = rollout(task, front.profile, point.coefficients).motion
        assert motion.peak_acceleration <= 75.0 * (1 + 1e-6)
        assert motion.peak_torque <= 0.5 * (1 + 1e-6)


@pytest.mark.parametrize("make", [GA, DE, PSO, NelderMead, PatternSearch])
def test_an_algorithm_for_one_objective_is_refused_before_the_work(make):
    seen = []
    with pytest.raises(ValueError, match=f"{make.__name__} minimises one objective") as caught:
        search(HALF, make(), bound=0.5, generations=3, report=seen.append)
    one_line(caught)
    assert seen == []


@OTHER
@pytest.mark.parametrize("steps", [0, 2])
def test_an_algorithm_that_was_set_up_or_run_is_refused(name, steps):
    problem = MoveProblem(PopulationObjective(HALF, CycloidPolynomial(6)), 0.5)
    algorithm = OTHERS[name]().setup(problem, termination=("n_gen", 9), seed=1)
    for _ in range(steps):
        algorithm.next()
    with pytest.raises(ValueError, match=f"this {name} was set up or run before; give a new one"):
        search(HALF, algorithm, bound=0.5, generations=3)


def test_an_algorithm_that_cannot_keep_limits_is_refused():
    task = dataclasses.replace(LIMITED["nsga2"], torque_limit=0.5)
    with pytest.raises(ValueError, match=r"MOEAD|constraint|limit") as caught:
        search(task, _moead(), bound=0.5, generations=3)
    one_line(caught)


@pytest.mark.parametrize("name", ["SMSEMOA", "MOEAD", "MOPSO_CD", "NSGA2"])
@pytest.mark.parametrize("option", ["checkpoint", "resume"])
def test_checkpoints_are_for_the_two_that_have_a_state(tmp_path, name, option):
    with pytest.raises(ValueError, match=f"checkpoints are for nsga2 and vepso, not for {name}"):
        search(HALF, OTHERS[name](), bound=0.5, generations=2, **{option: tmp_path / "file"})
    assert list(tmp_path.iterdir()) == []


def test_failed_candidates_never_enter_the_front_of_any_algorithm(monkeypatch):
    counts = _failing(monkeypatch, math.nan)
    for make in OTHERS.values():
        counts.clear()
        front = search(HALF, make(), bound=0.5, generations=4, seed=2)
        assert front.failed == sum(counts) > 0
        assert all(point.coefficients[0] <= 0 for point in front.points)


# -- Ctrl-C --


def _stop_after(generations):
    def report(progress):
        if progress.generation == generations:
            raise KeyboardInterrupt

    return report


@METHODS
@pytest.mark.parametrize("stop", [1, 6, 15])
def test_ctrl_c_keeps_what_was_found(tmp_path, method, stop):
    front = run(method, report=_stop_after(stop))
    assert not front.complete
    assert len(front.history) == stop
    assert front.history == found(method).history[:stop]
    assert front.evaluations == SWARMS[method] * 20 * stop
    assert len(front.points) > 0
    assert_is_a_front(front)
    front.save(tmp_path / "front.json")
    loaded = Front.load(tmp_path / "front.json")
    assert loaded == front
    assert not loaded.complete


@METHODS
def test_an_interrupt_before_anything_was_found_gives_an_empty_front(monkeypatch, method):
    def interrupted(self, coefficients):
        if len(coefficients):
            raise KeyboardInterrupt
        return evaluate(self, coefficients)

    evaluate = PopulationObjective.__call__
    monkeypatch.setattr(PopulationObjective, "__call__", interrupted)
    front = run(method)
    assert (front.points, front.history, front.complete) == ((), (), False)


@METHODS
@pytest.mark.parametrize("times", [1, 2])
def test_ctrl_c_while_the_front_is_worked_out_loses_nothing(tmp_path, monkeypatch, method, times):
    evaluate, interrupted = PopulationObjective.__call__, []

    def interrupting(self, coefficients):
        if self.steps != LEAST_STEPS:
            interrupted.append(1)
            for _ in range(times):
                signal.raise_signal(signal.SIGINT)
        return evaluate(self, coefficients)

    path = tmp_path / "checkpoint"
    with monkeypatch.context() as patch:
        patch.setattr(PopulationObjective, "__call__", interrupting)
        front = run(method, checkpoint=path)
    assert interrupted
    assert not front.complete  # the caller is told, as by a Ctrl-C in the last generation
    assert front.points == found(method).points
    assert front.history == found(method).history
    assert exactly(run(method, resume=path)) == exactly(found(method))


@METHODS
@pytest.mark.parametrize("moment", range(4))
@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="Ctrl-C is sent as a signal")
def test_ctrl_c_at_any_moment(method, moment):
    delay = np.random.default_rng(moment).uniform(0.001, 0.1)
    main = threading.main_thread().ident
    timer = threading.Timer(delay, lambda: signal.pthread_kill(main, signal.SIGINT))

    def begin(progress):
        if progress.generation == 1:
            timer.start()
        if progress.seconds > 20:
            raise RuntimeError("the search went on after Ctrl-C")

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        front = run(method, generations=100_000, report=begin)
        timer.join()
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    assert not front.complete
    assert 1 <= len(front.history) < 100_000
    assert len(front.points) > 0
    assert_is_a_front(front)
    for point in front.points[:3]:
        motion = rollout(front.task, front.profile, point.coefficients).motion
        assert point.energy == pytest.approx(motion.energy, rel=1e-12)


# -- checkpoints --


@pytest.fixture
def always(monkeypatch):
    """A checkpoint after every generation."""
    monkeypatch.setattr(module, "CHECKPOINT_SECONDS", 0.0)


def test_a_checkpoint_is_written_every_few_seconds():
    # Issue 3, item 5.
    assert 1 <= module.CHECKPOINT_SECONDS <= 10


@METHODS
def test_a_checkpoint_changes_nothing(tmp_path, always, method):
    front = run(method, checkpoint=tmp_path / "checkpoint")
    assert exactly(front) == exactly(found(method))
    assert [entry.name for entry in tmp_path.iterdir()] == ["checkpoint"]


class CrashError(Exception):
    """What a test breaks a run off with, when it is not Ctrl-C."""


@METHODS
@pytest.mark.parametrize("limited", [False, True], ids=["free", "limits"])
@pytest.mark.parametrize("stop", [2, 3, 9, 15])
def test_a_run_resumed_after_any_generation_ends_with_the_same_front(
    tmp_path, always, method, limited, stop
):
    task = LIMITED[method] if limited else TASKS[method]
    path = tmp_path / "checkpoint"
    part = run(method, task, checkpoint=path, report=_stop_after(stop))
    assert not part.complete
    seen = []
    front = run(method, task, resume=path, report=seen.append)
    assert front.complete
    assert exactly(front) == exactly(run(method, task) if limited else found(method))
    assert [progress.generation for progress in seen] == list(range(stop + 1, 16))
    assert len(front.history) == 15


@METHODS
def test_ctrl_c_within_an_evaluation_leaves_a_checkpoint_to_go_on_from(
    tmp_path, monkeypatch, always, method
):
    calls, evaluate = [], PopulationObjective.__call__

    def interrupting(self, coefficients):
        if self.steps == LEAST_STEPS:
            calls.append(1)
            if len(calls) == 5:
                signal.raise_signal(signal.SIGINT)
        return evaluate(self, coefficients)

    path = tmp_path / "checkpoint"
    monkeypatch.setattr(PopulationObjective, "__call__", interrupting)
    part = run(method, checkpoint=path)
    assert not part.complete
    assert len(part.history) in (4, 5)
    assert part.evaluations == part.history[-1].evaluations
    assert part.history == found(method).history[: len(part.history)]
    assert exactly(run(method, resume=path)) == exactly(found(method))


@METHODS
@pytest.mark.parametrize("where", ["evaluation", "report"])
def test_an_error_leaves_a_checkpoint_to_go_on_from(tmp_path, monkeypatch, always, method, where):
    calls, evaluate = [], PopulationObjective.__call__

    def crash(*arguments):
        calls.append(1)
        if len(calls) == 5:
            raise CrashError
        return evaluate(*arguments) if where == "evaluation" else None

    path, seen = tmp_path / "checkpoint", []
    options = {"report": crash} if where == "report" else {}
    with monkeypatch.context() as patch:
        if where == "evaluation":
            patch.setattr(PopulationObjective, "__call__", crash)
        with pytest.raises(CrashError):
            run(method, checkpoint=path, **options)
    front = run(method, resume=path, report=seen.append)
    assert seen[0].generation in (5, 6)
    assert exactly(front) == exactly(found(method))


@METHODS
def test_limits_that_nothing_keeps_yet_can_be_saved_and_resumed(tmp_path, always, method):
    task = IMPOSSIBLE[method]
    path = tmp_path / "checkpoint"
    run(method, task, generations=6, checkpoint=path, report=_stop_after(4))
    front = run(method, task, generations=6, resume=path)
    assert exactly(front) == exactly(run(method, task, generations=6))


@METHODS
def test_a_run_may_be_broken_off_and_resumed_again_and_again(tmp_path, always, method):
    path = tmp_path / "checkpoint"
    run(method, checkpoint=path, report=_stop_after(4))
    run(method, checkpoint=path, resume=path, report=_stop_after(8))
    run(method, checkpoint=path, resume=path, report=_stop_after(12))
    front = run(method, checkpoint=path, resume=path)
    assert exactly(front) == exactly(found(method))


@METHODS
def test_time_adds_up_over_runs(tmp_path, always, method):
    path = tmp_path / "checkpoint"

    def slow(progress):
        time.sleep(0.05)
        _stop_after(3)(progress)

    run(method, checkpoint=path, report=slow)
    seen = []
    front = run(method, resume=path, report=seen.append)
    assert seen[0].seconds > 0.1  # two generations were in the checkpoint
    assert front.seconds >= seen[-1].seconds


@METHODS
def test_resuming_a_run_that_was_over_gives_its_front(tmp_path, method):
    path = tmp_path / "checkpoint"
    run(method, checkpoint=path)
    seen = []
    assert exactly(run(method, resume=path, report=seen.append)) == exactly(found(method))
    assert seen == []


@METHODS
def test_threads_may_differ_when_a_run_is_resumed(tmp_path, always, method):
    path = tmp_path / "checkpoint"
    settings = {"population": 210, "generations": 4}
    run(method, **settings, checkpoint=path, report=_stop_after(3))
    assert exactly(run(method, **settings, resume=path, threads=2)) == exactly(
        run(method, **settings)
    )


@pytest.mark.parametrize("make", [lambda: VEPSO(particles=8), lambda: PaperNSGA2(8)])
def test_the_two_given_as_objects_can_be_resumed(tmp_path, always, make):
    path = tmp_path / "checkpoint"
    settings = {"bound": 0.5, "generations": 8, "seed": 4}
    whole = search(HALF, make(), **settings)
    search(HALF, make(), **settings, checkpoint=path, report=_stop_after(5))
    assert exactly(search(HALF, make(), **settings, resume=path)) == exactly(whole)


def test_a_checkpoint_that_cannot_be_written_is_found_before_the_work(tmp_path):
    seen = []
    for path in (tmp_path / "missing" / "checkpoint", tmp_path):
        with pytest.raises(ValueError, match="folder") as caught:
            run("nsga2", checkpoint=path, report=seen.append)
        one_line(caught)
    assert seen == []


# -- checkpoints of something else --


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory):
    """One finished checkpoint for each method."""
    folder = tmp_path_factory.mktemp("checkpoints")
    for method in TASKS:
        run(method, generations=3, checkpoint=folder / method)
    return folder


def _refused(path, error, *words, **call):
    before, seen = (path.read_bytes(), path.stat().st_mtime_ns), []
    method, task = call.pop("method"), call.pop("task")
    with pytest.raises(error) as caught:
        run(method, task, resume=path, checkpoint=path, report=seen.append, **call)
    for word in (str(path), *words):
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)
    assert seen == []
    assert (path.read_bytes(), path.stat().st_mtime_ns) == before


@METHODS
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"target": 1.25}, ["target", "1.25"]),
        ({"start": 0.125}, ["start", "0.125"]),
        ({"duration": 0.75}, ["duration", "0.75", "0.8"]),
        ({"residual_window": 0.5}, ["residual_window", "0.5"]),
        ({"torque_limit": 0.625}, ["limits", "torque", "0.625"]),
        ({"plant": SingleLinkManipulator(omega=11.5)}, ["plant", "11.5"]),
        ({"plant": ArmOnFlexibleLink(omega=8.5)}, ["plant", "8.5"]),
    ],
)
def test_a_checkpoint_of_another_task_is_refused(checkpoints, method, change, words):
    task = dataclasses.replace(TASKS[method], **change)
    other_plant = type(task.plant) is not type(TASKS[method].plant)
    words = ["plant", task.plant.name, TASKS[method].plant.name] if other_plant else words
    _refused(checkpoints / method, ValueError, *words, method=method, task=task, generations=3)


@METHODS
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"bound": 0.375}, ["bound", "0.375"]),
        ({"population": 22}, ["population", "20", "22"]),
        ({"generations": 33}, ["generations", "3", "33"]),
        ({"seed": 77}, ["seed", "0", "77"]),
        ({"profile": CycloidPolynomial(5)}, ["profile", "5", "6"]),
    ],
)
def test_a_checkpoint_with_other_settings_is_refused(checkpoints, method, change, words):
    call = {"method": method, "task": TASKS[method], "generations": 3, **change}
    _refused(checkpoints / method, ValueError, *words, **call)


@METHODS
def test_a_checkpoint_of_the_other_method_is_refused(checkpoints, method):
    other = {"nsga2": "vepso", "vepso": "nsga2"}[method]
    call = {"task": TASKS[method], "bound": BOUNDS[method], "generations": 3}
    _refused(checkpoints / method, ValueError, "method", "nsga2", "vepso", method=other, **call)


@pytest.mark.parametrize(
    ("one", "other", "words"),
    [
        (
            VEPSO(particles=8, rule=INERTIA_2002),
            VEPSO(particles=8, rule=CONSTRICTION),
            ["rule"],
        ),
        (
            VEPSO(particles=8, boundary="clip"),
            VEPSO(particles=8, boundary="reflect"),
            ["boundary", "clip", "reflect"],
        ),
        (VEPSO(particles=8), VEPSO(particles=9), ["particles", "8", "9"]),
        (PaperNSGA2(8), PaperNSGA2(9), ["population", "8", "9"]),
    ],
    ids=["rule", "boundary", "particles", "population"],
)
def test_a_checkpoint_of_the_same_algorithm_with_other_settings_is_refused(
    tmp_path, one, other, words
):
    path = tmp_path / "checkpoint"
    search(HALF, one, bound=0.5, generations=3, checkpoint=path)
    before = path.read_bytes()
    with pytest.raises(ValueError, match=re.escape(str(path))) as caught:
        search(HALF, other, bound=0.5, generations=3, resume=path)
    for word in words:
        assert word in str(caught.value)
    one_line(caught)
    assert path.read_bytes() == before


@METHODS
def test_a_truncated_checkpoint_is_refused(tmp_path, checkpoints, method):
    path = tmp_path / "checkpoint"
    path.write_bytes((checkpoints / method).read_bytes()[:-400])
    _refused(path, FileFormatError, method=method, task=TASKS[method], generations=3)


@METHODS
def test_a_front_is_not_a_checkpoint(tmp_path, method):
    path = tmp_path / "front.json"
    found(method).save(path)
    _refused(path, FileFormatError, "not a checkpoint", method=method, task=TASKS[method])


def test_a_missing_checkpoint_is_named(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        run("nsga2", resume=tmp_path / "missing")


@METHODS
@pytest.mark.parametrize("package", ["quietarm", "casadi", "numpy", "pymoo"])
def test_a_checkpoint_of_other_software_is_refused(checkpoints, monkeypatch, method, package):
    others = {**module.versions(), "pymoo": module.pymoo.__version__, package: "0.0.7"}
    monkeypatch.setattr(module, "_versions", lambda: others)
    words = [f"its version of {package} is", "not '0.0.7'", "begin anew"]
    call = {"method": method, "task": TASKS[method], "generations": 3}
    _refused(checkpoints / method, ValueError, *words, **call)


# -- memory --

LARGE = """
import math, resource
from metaheuristics import search
from models import ArmOnFlexibleLink
from ocp import PointToPoint

task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
front = search(task, "nsga2", bound=0.5, population=10_000, generations=2)
print(front.evaluations, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="ru_maxrss is in other units elsewhere")
def test_a_population_of_ten_thousand_needs_little_memory():
    # pymoo's duplicate elimination held 10,000 x 10,000 distances: 1.8 GB. Measured: 0.15 GB.
    command = [sys.executable, "-c", LARGE]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    evaluations, kilobytes = map(int, done.stdout.split())
    assert evaluations == 20_000
    assert kilobytes < 400_000


# -- SIGKILL --

KILLED = """
import math, sys
from metaheuristics import search
from models import ArmOnFlexibleLink, SingleLinkManipulator
from ocp import PointToPoint

method, path = sys.argv[1:]
sys.modules["metaheuristics.run"].CHECKPOINT_SECONDS = 0.0
task, bound = {
    "nsga2": (PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), 0.5),
    "vepso": (PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8), 0.2),
}[method]
search(
    task, method, bound=bound, population=20, generations=200, seed=5, checkpoint=path,
    report=lambda progress: print(progress.generation, flush=True),
)
"""


def _kill_at(script, method, path, generation, delay):
    """Run until the generation, wait a little longer, kill; the last generation that it told."""
    command = [sys.executable, str(script), method, str(path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        last = 0
        for line in process.stdout:
            last = int(line)
            if last >= generation:
                break
        time.sleep(delay)
        process.send_signal(signal.SIGKILL)
        rest = process.stdout.read().split()
        assert process.wait(30) == -signal.SIGKILL  # it had not ended by itself
    finally:
        process.kill()
        process.stdout.close()
        process.wait()
    return int(rest[-1]) if rest else last


@METHODS
@pytest.mark.skipif(os.name == "nt", reason="there is no SIGKILL")
def test_a_run_that_was_killed_ends_bit_for_bit_as_one_that_was_not(tmp_path, method):
    # Issue 3, item 5: at any moment.
    script, path = tmp_path / "script.py", tmp_path / "checkpoint"
    script.write_text(KILLED)
    moment = random.Random()
    generation, delay = moment.randint(2, 80), moment.uniform(0, 0.02)
    print(f"killed {delay} s after generation {generation}")  # pytest shows it on failure
    told = _kill_at(script, method, path, generation, delay)
    # The checkpoint comes after the report of its generation, and is whole whenever it came.
    saved = len(load_checkpoint(path)[1]["hypervolume"])
    assert told - 1 <= saved <= told < 200
    settings = {"seed": 5, "generations": 200}
    seen = []
    front = run(method, **settings, resume=path, report=seen.append)
    assert seen[0].generation == saved + 1
    assert front.complete
    assert exactly(front) == exactly(run(method, **settings))


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
        ("bound", "0.5"),
        ("threads", 0),
        ("threads", -2),
        ("threads", 1.5),
    ],
)
def test_odd_settings_are_named_with_a_remedy(method, name, value):
    settings = {"population": 4, "generations": 2, name: value}
    with pytest.raises(ValueError, match=r"; give ") as caught:
        run(method, **settings, report=_cancel)
    names = {"population": "population|particles", "seed": "seed"}
    assert re.search(names.get(name, name), str(caught.value))
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
    with pytest.raises((ValueError, TypeError), match=r"[Aa]lgorithm|method") as caught:
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
    # physics.md, 'A third plant'
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
