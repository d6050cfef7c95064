"""The gradient answer: optimality, determinism, limits, other moves, a user's own plant."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    PointToPoint,
    SolveSettings,
    plan_move,
    resimulate,
    rollout,
)
from quietarm.ocp.plan.starts import PLAN_STEPS, start_coefficients
from quietarm.ocp.task.point_to_point import LIMITS

pi = math.pi


# -- terms --


@pytest.mark.parametrize("name", ["single link", "arm"])
def test_more_terms_cost_less(tasks, solved, name):
    # A family of more terms contains those of fewer; docs/physics.md: N = 8 goes lower than 6.
    energies = [solved(tasks[name], terms).energy for terms in (2, 4, 6, 8)]
    for more, fewer in itertools.pairwise(reversed(energies)):
        assert more < fewer


def test_two_terms_cancel_the_residual_of_either_plant(tasks, solved):
    # Sections 3.1 and 3.2: 'N = 2 accomplishes residual vibration suppression'.
    for name in ("single link", "arm"):
        assert solved(tasks[name], 2).residual < 1e-7


# -- the optimum is one --


@pytest.mark.parametrize("name", ["single link", "arm"])
def test_no_neighbour_that_arrives_at_rest_costs_less(tasks, solved, name):
    # Random steps, brought back to rest on arrival by Newton's method on rollout's W and W', whose
    # derivative hardly changes on the way.
    task, plan, random = tasks[name], solved(tasks[name]), np.random.default_rng(1)
    steps = plan.verification.steps

    def simulate(a):
        return rollout(task, plan.profile, a, steps=steps)

    best, at = simulate(plan.coefficients), np.array(plan.coefficients)
    columns = [np.subtract(simulate(at + e).arrival, best.arrival) for e in 1e-6 * np.eye(6)]
    back = np.linalg.pinv(np.column_stack(columns) / 1e-6)
    for _ in range(15):
        away = random.normal(size=6)
        a = at + 0.02 * away / np.linalg.norm(away)
        for _ in range(5):
            a -= back @ simulate(a).arrival
        there = simulate(a).motion
        assert there.residual < 1e-9
        assert np.linalg.norm(a - plan.coefficients) > 1e-3
        assert there.energy > best.motion.energy * (1 + 1e-5)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_other_random_starts_end_at_the_same_energy(tasks, solved, seed):
    # Else a plan would depend on luck.
    for name, box in (("single link", 0.2), ("arm", 0.5)):
        usual = solved(tasks[name], bound=box)
        other = solved(tasks[name], bound=box, starts=2, seed=seed)
        assert other.energy == pytest.approx(usual.energy, rel=1e-5)


def test_the_mirrored_move_costs_the_same(plants, tasks, solved):
    # Eqs (13), (14) are odd in (theta, W) together.
    there = solved(tasks["arm"], 4)
    back = solved(PointToPoint(plants["arm"], -pi / 2, 0.8), 4)
    assert back.energy == pytest.approx(there.energy, rel=1e-6)
    assert back.coefficients == pytest.approx(there.coefficients, abs=1e-4)


# -- the same again --


@pytest.mark.parametrize(("bound", "spread"), [(0.05, 0.05), (None, 0.2), (3.0, 3.0)])
def test_starts_are_the_plain_cycloid_and_random_ones_in_the_box(bound, spread):
    starts = start_coefficients(CycloidPolynomial(6), SolveSettings(bound=bound, starts=50, seed=3))
    assert len(starts) == 50
    assert starts[0].tolist() == [0.0] * 6
    assert 0.9 * spread < np.abs(starts).max() <= spread
    again = start_coefficients(CycloidPolynomial(6), SolveSettings(bound=bound, starts=50, seed=3))
    assert np.array_equal(starts, again)
    other = start_coefficients(CycloidPolynomial(6), SolveSettings(bound=bound, starts=50, seed=4))
    assert not np.array_equal(starts, other)


def test_a_guess_is_improved(tasks, solved):
    # Table 4, N = 6, a_5 mended: 0.14915 J (docs/physics.md) becomes 0.1315 J in the same box.
    paper = [-9.346e-2, -3.488e-1, 1.989e-1, -1.515e-1, -2.993e-2, -2.377e-1]
    plan = plan_move(tasks["arm"], bound=0.5, starts=1, guess=paper)
    assert plan.energy == pytest.approx(solved(tasks["arm"], bound=0.5).energy, rel=1e-5)
    assert plan.residual < 1e-7


# -- limits --


@pytest.mark.parametrize("limit", LIMITS)
def test_a_limit_is_kept_and_costs_energy(tasks, solved, limit):
    quantity, free = limit.removesuffix("_limit"), solved(tasks["arm"])
    value, task = 0.9 * free.motion.peak(quantity), tasks["arm"]
    limited = solved(replace(task, **{limit: value}), starts=1)
    # Kept to the solver's tolerance by the verified motion, and between its samples to the share
    # that ocp.plan.verification allows.
    assert limited.motion.peak(quantity) <= value * (1 + 1e-6)
    sampled = limited.sampled(np.linspace(0.0, task.duration, 20_001))
    peak = {
        "torque": sampled.torque,
        "speed": sampled.joint[:, 1],
        "acceleration": sampled.joint[:, 2],
        "jerk": sampled.jerk,
        "deflection": sampled.tips,
    }[quantity]
    assert np.abs(peak).max() <= value * (1 + 1e-3)
    assert limited.residual < 1e-7
    assert limited.energy > free.energy * (1 + 1e-3)


def test_a_limit_that_is_not_in_the_way_changes_nothing(tasks, solved):
    free, task = solved(tasks["arm"], 4), tasks["arm"]
    loose = dict.fromkeys(LIMITS, 1e5)
    limited = solved(PointToPoint(task.plant, task.target, task.duration, **loose), 4)
    assert limited.energy == pytest.approx(free.energy, rel=1e-6)


def test_all_limits_at_once_are_kept(tasks, solved):
    task, free = tasks["arm"], solved(tasks["arm"]).motion
    limits = {
        "torque_limit": 0.95 * free.peak_torque,
        "speed_limit": 0.97 * free.peak_speed,
        "acceleration_limit": 0.95 * free.peak_acceleration,
        "jerk_limit": 0.8 * free.peak_jerk,
        "deflection_limit": 0.98 * free.peak_deflection,
    }
    plan = solved(replace(task, **limits), starts=1)
    for limit, value in limits.items():
        assert plan.motion.peak(limit.removesuffix("_limit")) <= value * (1 + 1e-6)
    assert plan.residual < 1e-7
    assert plan.energy > free.energy


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_a_residual_limit_is_kept_and_saves_energy(tasks, solved, name):
    energies = []
    for limit in (0.0, 1e-3, 1e-2):
        plan = solved(tasks[name], 4, residual_limit=limit)
        verified = resimulate(plan.task, plan.profile, plan.coefficients)
        assert verified.residual <= max(limit, 1e-7) * (1 + 1e-6)
        energies.append(plan.energy)
    assert energies[0] > energies[1] > energies[2]


@pytest.mark.parametrize("limit", [1e-6, 1e-8])
@pytest.mark.parametrize("name", ["single link", "arm"])
def test_a_tiny_residual_limit_is_kept(tasks, solved, name, limit):
    # At rest on arrival is possible, so that any limit is.
    plan = solved(tasks[name], residual_limit=limit)
    assert plan.residual <= limit * (1 + 1e-6)
    assert plan.energy == pytest.approx(solved(tasks[name]).energy, rel=1e-3)


@pytest.mark.parametrize("name", ["single link", "arm"])
def test_a_residual_limit_that_is_not_in_the_way_is_verified_as_any_other(tasks, solved, name):
    # The cheapest motion of two terms rings by some centimetres, less than 0.2 m.
    plan = solved(tasks[name], 2, residual_limit=0.2, starts=1)
    assert 0.01 < plan.residual < 0.1
    check = plan.verification
    assert check.fixed_step_residual == pytest.approx(plan.residual, rel=1e-3)
    assert check.steps <= 2 * PLAN_STEPS


def test_the_box_is_kept_however_narrow(tasks, solved):
    plan = solved(tasks["arm"], 6, bound=0.3, residual_limit=5e-3)
    assert np.abs(plan.coefficients).max() <= 0.3 * (1 + 1e-7)
    assert plan.energy > solved(tasks["arm"], 6, residual_limit=5e-3).energy


# -- other moves --


@pytest.mark.parametrize("duration", [0.2, 5.0])
def test_fast_and_slow_moves_arrive_at_rest(duration):
    plan = plan_move(PointToPoint(SingleLinkManipulator(), pi / 6, duration), starts=1)
    assert plan.residual < 1e-7
    assert plan.energy < 2.0  # 1.85 J and 0.002 J: the figures of a run, as a guard


@pytest.mark.parametrize("span", [1e-6, 30.0])
def test_tiny_and_huge_moves_arrive_at_rest(span):
    plan = plan_move(PointToPoint(ArmOnFlexibleLink(), span, 0.8), CycloidPolynomial(4), starts=2)
    assert plan.residual < 1e-7 * max(1.0, span)


@pytest.mark.parametrize("steps", [2, 3])
@pytest.mark.parametrize("limit", [0.0, 1e-6])
def test_too_few_steps_are_doubled_until_the_integrators_agree(tasks, solved, limit, steps):
    settings = {"starts": 2, "residual_limit": limit}
    plan = plan_move(tasks["single link"], CycloidPolynomial(4), steps=steps, **settings)
    assert plan.verification.steps in [steps * 2**k for k in range(1, 8)]
    assert plan.residual <= max(limit, 1e-8) * (1 + 1e-6)
    assert plan.verification.fixed_step_energy == pytest.approx(plan.energy, rel=1e-3)
    usual = solved(tasks["single link"], 4, **settings)
    assert plan.energy == pytest.approx(usual.energy, rel=1e-5)


# -- a plant of two modes --


def test_two_links_arrive_at_rest(tasks, solved):
    # docs/physics.md's third plant and move: 0 to pi/2 in 0.9 s.
    plan = solved(tasks["two links"])
    after = plan.sampled(np.linspace(0.9, 1.9, 200))
    assert np.abs(after.tips).max() < 1e-7
    assert after.tips.shape == (200, 2)
    assert plan.energy > plan.motion.net_work > 0


def test_four_terms_still_two_modes_but_two_do_not(tasks, solved):
    # Rest of two modes is four conditions; ref. [25] uses four coefficients.
    assert solved(tasks["two links"], 4).residual < 1e-7
    assert solved(tasks["two links"], 6).energy < solved(tasks["two links"], 4).energy


# Six terms, four of them for rest, leave little: no motion has less than 0.953 of the torque.
@pytest.mark.parametrize(("limit", "share"), [("torque_limit", 0.97), ("deflection_limit", 0.95)])
def test_two_links_keep_limits(tasks, solved, limit, share):
    task, quantity = tasks["two links"], limit.removesuffix("_limit")
    value = share * solved(task).motion.peak(quantity)
    plan = solved(PointToPoint(task.plant, task.target, task.duration, **{limit: value}))
    assert plan.motion.peak(quantity) <= value * (1 + 1e-6)
    assert plan.energy > solved(task).energy


# -- bad input --


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"residual_limit": -1e-3}, "residual limit is -0.001 m"),
        ({"residual_limit": math.nan}, "residual limit is nan"),
        ({"residual_limit": math.inf}, "residual limit is inf"),
        ({"bound": 0.0}, "bound on the coefficients is 0"),
        ({"bound": -0.2}, "bound on the coefficients is -0.2"),
        ({"bound": math.nan}, "bound on the coefficients is nan"),
        ({"bound": math.inf}, "bound on the coefficients is inf"),
        ({"starts": 0}, "starts is 0"),
        ({"starts": 2.0}, "starts is 2.0"),
        ({"seed": -1}, "seed is -1"),
        ({"seed": 1.5}, "seed is 1.5"),
        ({"seed": None}, "seed is None"),
        ({"steps": 0}, "steps is 0"),
        ({"steps": 1}, "steps is 1; give a whole number from 2 up"),
        ({"steps": 10.0}, "steps is 10.0"),
        ({"solver": "simplex"}, "solver is 'simplex'; give 'sqp' or 'ipopt'"),
    ],
)
def test_a_setting_out_of_range_is_named(tasks, settings, message):
    with pytest.raises(ValueError, match=message) as error:
        plan_move(tasks["arm"], **settings)
    assert "\n" not in str(error.value)
