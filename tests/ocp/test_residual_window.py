"""The window after arrival of a residual: by default a whole swing of the slowest mode."""

import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import quietarm as qa
from quietarm.ocp import FreeVibration
from quietarm.ocp.window import DefaultWindow, default_window

# 0.1 Hz, 3 t of which 2 t swing
CRANE = qa.LinearAxis(omega1=0.6283, zeta1=0.002, mass=3000.0, load=2000.0, friction=0.0)
TWO = qa.LinearAxis(omega1=3.0, omega2=9.0, share1=0.5, share2=0.5, mode_count=2.0)
LINK, ARM = qa.SingleLinkManipulator(), qa.ArmOnFlexibleLink()


def move(plant, **others):
    return qa.PointToPoint(plant, math.pi / 2, 1.0, **others)


def arms_frequency(target):
    """Eq (13) at rest: (1 + alpha1 cos theta) W'' + omega^2 W = 0, by the numbers of eq (15)."""
    return 7.320 / math.sqrt(1 - 1.055e-1 * math.cos(target))


@pytest.mark.parametrize(
    ("plant", "seconds"),
    [
        (LINK, 4 * math.pi / 10.43),  # eq (10)
        (ARM, 4 * math.pi / arms_frequency(math.pi / 2)),
        (qa.DualLinkManipulator(), 4 * math.pi / (10.71 * 0.993)),  # docs/physics.md
        (qa.FlexibleBeam(omega=0.5, mode_count=3.0), 4 * math.pi / 0.5),
        (qa.LinearAxis(), 1.0),  # 12 Hz: eq (11)'s second is longer
        (qa.LinearAxis(omega1=4 * math.pi), 1.0),  # two periods of 0.5 s
        (CRANE, 4 * math.pi / 0.6283),
        (TWO, 4 * math.pi / 3.0),
        (qa.SingleLinkManipulator(omega=0.5, zeta=1.5), 1.0),  # creeps back, and does not swing
        (replace(TWO, zeta1=1.5), 4 * math.pi / 9.0),  # only its second mode swings
    ],
)
def test_it_is_a_second_or_two_periods_of_the_slowest_mode_that_swings(plant, seconds):
    assert move(plant).residual_window == pytest.approx(seconds, rel=1e-12)


def test_it_sees_a_whole_swing_of_the_slowest_scenario():
    plant = qa.SingleLinkManipulator(omega=1.0, zeta=0.0)
    task = move(plant, uncertainty=qa.Uncertainty({"frequency": 0.5}))
    assert task.residual_window == task.certain.residual_window == pytest.approx(4 * math.pi)
    for factor, vibrating in zip((1.0, 0.5, 1.5), task.perturbed_plants, strict=True):
        vibration = FreeVibration(vibrating, task.target, task.residual_window)
        for phase in np.linspace(0.0, 2 * math.pi, 25):
            state = 0.01 * math.cos(phase), 0.01 * factor * math.sin(phase)
            assert vibration.peak(state) == pytest.approx(2.28 * 0.01, rel=1e-7)


def test_a_mode_that_is_far_faster_leaves_a_window_that_can_be_resolved():
    fast = replace(TWO, omega1=0.2, omega2=900.0)
    task = move(fast, uncertainty=qa.Uncertainty({"frequency": 0.9}))
    for plant in task.perturbed_plants:
        assert FreeVibration(plant, task.target, task.residual_window).window > 1.0
    # eq (11) has 1 s, and no more than a task takes
    assert move(qa.LinearAxis(omega1=3999.0)).residual_window == 1.0
    slow = move(qa.LinearAxis(omega1=1e-6))
    assert replace(slow, residual_window=float(slow.residual_window)) == slow


@pytest.mark.parametrize("ranges", [{}, {"frequency": 0.5}])
@pytest.mark.parametrize("omega", [2500.0, 4001.0, math.tau * 2400, 1e5])
def test_a_default_window_can_always_be_resolved(omega, ranges):
    # 4000 radians of the fastest mode are as many as can be.
    errors = {"uncertainty": qa.Uncertainty(ranges)} if ranges else {}
    task = move(qa.LinearAxis(omega1=omega), **errors)
    for plant in task.perturbed_plants:
        FreeVibration(plant, task.target, task.residual_window)
    assert 1000 <= omega * task.residual_window <= 4000


def test_another_plant_or_target_has_its_own_and_a_window_that_was_given_stays():
    task = move(LINK)
    assert replace(task, plant=CRANE) == move(CRANE)
    assert replace(replace(task, plant=CRANE), plant=LINK) == task
    turned = replace(move(ARM), target=2.0)
    assert turned.residual_window == pytest.approx(4 * math.pi / arms_frequency(2.0), rel=1e-12)
    # also where it is the number of the default
    for seconds in (1.0, float(task.residual_window)):
        given = move(LINK, residual_window=seconds)
        assert replace(given, plant=CRANE, target=2.0).residual_window == seconds
        assert replace(given, residual_window=None, plant=CRANE) == move(CRANE)


def test_the_number_is_in_files_and_stays_when_they_are_loaded(tmp_path):
    plan = qa.evaluate_coefficients(move(CRANE), [0.1])
    plan.save(tmp_path / "plan.json")
    loaded = qa.Plan.load(tmp_path / "plan.json")
    assert loaded == plan
    document = json.loads((tmp_path / "plan.json").read_text())
    assert document["task"]["residual_window"] == plan.task.residual_window
    assert replace(loaded.task, plant=LINK).residual_window == loaded.task.residual_window
    copied = pickle.loads(pickle.dumps(plan.task))
    assert replace(copied, plant=LINK) == move(LINK)


def test_many_vibrations_have_windows_of_their_own():
    targets, windows = [0.3, -1.2, 2.0], [0.05, 1.0, 2.0]
    states = np.random.default_rng(4).uniform(-0.1, 0.1, (3, 2))
    together = FreeVibration(ARM, targets, windows).peak(states)
    for i, (target, window) in enumerate(zip(targets, windows, strict=True)):
        alone = FreeVibration(ARM, target, window).peak(states[i])
        assert together[i] == pytest.approx(float(alone), rel=5e-8)


def test_moves_that_are_planned_together_keep_their_residuals_within_their_windows():
    tasks = [replace(move(ARM), target=target) for target in (0.5, 1.0, 2.0)]
    assert len({task.residual_window for task in tasks}) == 3
    found = qa.plan_moves(tasks, qa.CycloidPolynomial(4))
    for task, coefficients, residual in zip(tasks, found.coefficients, found.residual, strict=True):
        alone = qa.evaluate_coefficients(task, coefficients)
        assert residual == pytest.approx(alone.residual, abs=1e-8)  # docs/accuracy.md
    assert found.tasks == tuple(tasks)


def test_the_longest_default_of_several_moves_is_resolved_by_all_of_them():
    moves = [(CRANE, 8.0), (qa.LinearAxis(), 8.0)]
    assert default_window(moves) == move(CRANE).residual_window
    assert isinstance(default_window(moves), DefaultWindow)
    fast = qa.LinearAxis(omega1=900.0)
    window = default_window([*moves, (fast, 8.0)])
    assert 1.0 < window < move(CRANE).residual_window
    FreeVibration(fast, 8.0, window)


# What a second told of slow machines, and what they leave


def amplitude(plan):
    """Return the amplitude of the free vibration on arrival, in closed form, undamped [m]."""
    W, dW = np.ravel(plan.candidate.arrival)
    return math.hypot(W, dW / plan.task.plant.omega1)


def test_a_crane_leaves_84_mm_where_a_second_tells_65():
    # by 2.0.0.dev0 for errors of 10 %, with 1.2 m/s and 0.3 m/s^2
    coefficients = [
        -0.0027561958, -0.0696571836, 0.0562427553, -0.2906706716, -0.2244831091, 1.0653215475,
        -2.9048021312, -20.6263254244, 22.1805916324, 75.5410294311, -61.480022965, -108.4854061855,
        84.2977495472, 54.8610750065, -57.6541377871, 11.505324435, 15.7563255148, -14.2953827688,
    ]  # fmt: skip
    task = qa.PointToPoint(CRANE, 8.0, 16.0, uncertainty=qa.Uncertainty({"frequency": 0.1}))
    told = qa.evaluate_coefficients(replace(task, residual_window=1.0), coefficients)
    left = qa.evaluate_coefficients(task, coefficients)
    assert told.worst.residual == pytest.approx(0.0654, abs=5e-5)
    nominal = qa.evaluate_coefficients(task.certain, coefficients)
    assert nominal.residual == pytest.approx(0.0841, abs=5e-5)
    # it decays by zeta a radian until its first peak, half a period at most
    assert amplitude(nominal) * math.exp(-0.002 * math.pi) < nominal.residual < amplitude(nominal)
    assert left.worst.residual >= nominal.residual


def test_a_second_tells_105_mm_of_a_crane_that_leaves_146():
    omega, distance, duration = 1.566, 6.0, 9.0
    rate = 2 * math.pi / duration

    def swing(t, state):
        # the plain cycloid's acceleration: eqs (1) and (4)
        push = distance * rate / duration * math.sin(rate * t)
        return [state[1], -(omega**2) * state[0] - push]

    arrival = solve_ivp(swing, (0, duration), [0.0, 0.0], rtol=1e-11, atol=1e-13, method="DOP853")
    W, dW = arrival.y[:, -1]
    task = qa.PointToPoint(qa.LinearAxis(omega1=omega, zeta1=0.0), distance, duration)
    plan = qa.evaluate_coefficients(task, [])
    assert plan.residual == pytest.approx(math.hypot(W, dW / omega), rel=1e-7)
    assert plan.residual == pytest.approx(0.146, abs=5e-4)
    second = qa.evaluate_coefficients(replace(task, residual_window=1.0), [])
    assert second.residual == pytest.approx(0.105, abs=6e-4)


@pytest.mark.slow
def test_the_points_of_a_front_are_what_they_leave():
    # limits are kept within a thousandth, and 1e-7 of the 0.97 m that the plain cycloid leaves
    told, left = [1e-4, 1e-3, 5e-3, 0.158], [0.32e-3, 3.2e-3, 16.1e-3, 0.511]
    plant = replace(CRANE, zeta1=0.0)
    task, profile = qa.PointToPoint(plant, 8.0, 16.0), qa.CycloidPolynomial(6)

    def front_of(task):
        front = qa.epsilon_front(task, profile, points=2, at=told)
        return [front.points[np.abs(front.residuals - limit).argmin()] for limit in told]

    for point, told_here, left_here in zip(
        front_of(replace(task, residual_window=1.0)), told, left, strict=True
    ):
        plan = qa.evaluate_coefficients(task, point.coefficients, profile=profile)
        assert point.residual == pytest.approx(told_here, rel=2e-3)
        assert plan.residual == pytest.approx(left_here, rel=2e-2)  # two digits
        assert plan.residual == pytest.approx(amplitude(plan), rel=1e-6)
    for point, limit in zip(front_of(task), told, strict=True):
        plan = qa.evaluate_coefficients(task, point.coefficients, profile=profile)
        assert point.residual == pytest.approx(limit, rel=2e-3)
        assert amplitude(plan) == pytest.approx(limit, rel=2e-3)


def test_two_modes_that_lie_close_beat_for_longer():
    # docs/arrival.md: 2.09 s of 6 and 6.6 rad/s, whose beat takes 10.5 s
    plant = qa.LinearAxis(
        omega1=6.0, zeta1=0.002, share1=0.5, omega2=6.6, zeta2=0.002, share2=0.5, mode_count=2.0
    )
    task = qa.PointToPoint(plant, 1.0, 2.0)
    within = qa.evaluate_coefficients(task, []).residual
    beat = qa.evaluate_coefficients(replace(task, residual_window=10.5), []).residual
    assert (1e3 * within, 1e3 * beat) == pytest.approx((11.6, 14.7), abs=0.05)
