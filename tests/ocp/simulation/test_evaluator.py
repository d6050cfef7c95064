"""The one evaluation: candidates in scenarios by fixed steps, against CVODES one by one."""

import copy
import gc
import pickle
import weakref
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp.cost import COST
from quietarm.ocp.simulation.evaluator import Evaluator
from quietarm.ocp.simulation.rows import RowFunction, copy_rows

PROFILE = qa.CycloidPolynomial(3)
MOTIONS = np.random.default_rng(2).uniform(-0.2, 0.2, (4, 3))
RANGES = {"frequency": 0.1, "damping": 0.3}
LIMITS = {"torque_limit": 0.2, "acceleration_limit": (-30.0, 40.0), "deflection_limit": 0.03}
PLANTS = pytest.mark.parametrize("name", ["single link", "arm", "two links"])


def _uncertain(task, **limits):
    return replace(task, uncertainty=qa.Uncertainty(RANGES), **limits)


@PLANTS
def test_every_candidate_in_every_scenario_is_what_cvodes_finds(tasks, name):
    task = _uncertain(tasks[name])
    evaluation = Evaluator(task, PROFILE)(MOTIONS)
    assert evaluation.energy.shape == evaluation.residual.shape == (4, 5)
    for i, a in enumerate(MOTIONS):
        exact = qa.JudgedMotion.of_profile(task, PROFILE, a)
        # 140 steps keep energies within 1e-5, and states on arrival within 1e-7 m
        assert evaluation.energy[i] == pytest.approx(
            [one.energy for one in exact.scenarios], rel=1e-5
        )
        residuals = [exact.perturbed(one.errors).residual for one in exact.scenarios]
        assert evaluation.residual[i] == pytest.approx(residuals, rel=1e-4, abs=1e-7)
        assert evaluation.arrival[i] == pytest.approx(exact.arrival, rel=1e-4, abs=1e-5)


@PLANTS
def test_the_sampled_residual_misses_little_and_exceeds_nothing(tasks, name):
    evaluation = Evaluator(_uncertain(tasks[name]), PROFILE)(MOTIONS)
    # rows every 0.02 rad of the fastest mode miss 5e-5 of a peak
    assert np.all(evaluation.sampled_residual <= evaluation.residual * (1 + 1e-7))
    assert evaluation.sampled_residual == pytest.approx(evaluation.residual, rel=5e-5)


@PLANTS
def test_errors_that_are_passed_are_scenarios_as_those_of_the_task(tasks, name):
    task = _uncertain(tasks[name])
    own = Evaluator(task, PROFILE)(MOTIONS)
    passed = Evaluator(task.certain, PROFILE, 140, error_names=list(RANGES))
    evaluation = passed(MOTIONS, task.scenarios)
    assert evaluation.energy == pytest.approx(own.energy, rel=1e-12)
    # peaks are sampled at other times, of which each may miss 3e-8 (`FreeVibration.peak`)
    assert evaluation.residual == pytest.approx(own.residual, rel=6e-8, abs=1e-12)
    assert passed.residuals(MOTIONS, task.scenarios) == pytest.approx(
        evaluation.residual, rel=1e-12
    )


@PLANTS
def test_several_tasks_of_a_plant_have_a_candidate_each(tasks, name):
    task = _uncertain(tasks[name], **LIMITS)
    durations = [0.7, 0.8, 0.9, 1.1]
    moves = [replace(task, duration=duration, residual_window=1.0) for duration in durations]
    moves[2] = replace(moves[2], torque_limit=0.4)
    together = Evaluator(moves, PROFILE, 140)(MOTIONS)
    for i, (move, a) in enumerate(zip(moves, MOTIONS, strict=True)):
        alone = Evaluator(move, PROFILE, 140)([a])
        assert together.energy[i] == pytest.approx(alone.energy[0], rel=1e-12)
        assert together.residual[i] == pytest.approx(alone.residual[0], rel=1e-9, abs=1e-12)
        assert together.violations[i] == pytest.approx(alone.violations[0], abs=1e-12)


@PLANTS
def test_a_limit_counts_in_the_scenarios_where_it_holds_and_by_its_direction(tasks, name):
    task = _uncertain(tasks[name], **LIMITS)
    evaluation = Evaluator(task, PROFILE, 60)(MOTIONS)
    least, largest = np.moveaxis(evaluation.ranges["acceleration"], -1, 0)
    sided = np.maximum(least / (-30.0 / 40.0), largest)[:, 0]
    expected = [
        evaluation.largest("torque")[:, 0] / 0.2 - 1,
        sided / 40.0 - 1,
        evaluation.largest("deflection").max(axis=1) / 0.03 - 1,
    ]
    names = [limit.name for limit in task.limits]
    assert names == ["torque", "acceleration", "deflection"]
    assert evaluation.violations == pytest.approx(np.transpose(expected), abs=1e-12)


def test_it_can_be_copied_and_sent(tasks):
    evaluator = Evaluator(_uncertain(tasks["arm"]), PROFILE, 40)
    expected = evaluator(MOTIONS).residual
    for other in (copy.deepcopy(evaluator), pickle.loads(pickle.dumps(evaluator))):
        assert np.array_equal(other(MOTIONS).residual, expected)


def test_no_candidates_have_no_figures(tasks):
    evaluation = Evaluator(_uncertain(tasks["arm"], **LIMITS), PROFILE, 40)(MOTIONS[:0])
    assert evaluation.energy.shape == (0, 5)
    assert evaluation.violations.shape == (0, 3)


@pytest.mark.parametrize(
    ("coefficients", "words"),
    [(MOTIONS[:, :2], r"\(motions, 3\)"), (MOTIONS[0], r"\(motions, 3\)"), ("six", "give a row")],
)
def test_what_is_no_table_of_coefficients_is_refused(tasks, coefficients, words):
    with pytest.raises(ValueError, match=words):
        Evaluator(tasks["arm"], PROFILE, 40)(coefficients)


@pytest.mark.slow
def test_a_free_motion_has_no_fixed_steps(tasks):
    floor = qa.energy_floor(tasks["single link"], starts=1)
    with pytest.raises(ValueError, match="has no profile"):
        qa.evaluate_robustness(floor.candidate, {"frequency": 0.1})


def test_functions_of_rows_go_as_soon_as_they_are_forgotten():
    def build(rows):
        x = ca.MX.sym("x", rows, 2)
        return ca.Function("twice", [x], [2 * x])

    function = RowFunction(build, sizes=(4,))
    (values,) = function([np.ones((3, 2))], copy_rows)
    assert np.array_equal(values, 2 * np.ones((3, 2)))
    reference = weakref.ref(function)
    gc.disable()  # Python looks for cycles of references when it likes
    try:
        del function
        assert reference() is None
    finally:
        gc.enable()


def test_rows_take_smaller_blocks_for_a_while_before_a_larger_one_is_built():
    def build(rows):
        x = ca.MX.sym("x", rows, 2)
        return ca.Function("twice", [x], [2 * x])

    function = RowFunction(build, sizes=(1, 4), patience=5)
    rows = np.arange(12.0).reshape(6, 2)
    for built in ([1], [1, 4], [1, 4]):  # the first six rows take all five
        (values,) = function([rows], copy_rows)
        assert np.array_equal(values, 2 * rows)
        assert function.built == built


def test_a_few_tasks_that_come_in_turn_are_compiled_once(tasks):
    evaluators = [Evaluator(task, PROFILE) for task in tasks.values()]

    def evaluate_all():
        return [evaluator(MOTIONS).energy for evaluator in evaluators]

    first = evaluate_all()
    built = COST.builds
    assert np.array_equal(first, evaluate_all())
    assert COST.builds == built
