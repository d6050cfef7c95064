"""The shortest duration within limits: on a spline that can cruise, and along a given profile."""

import re
from dataclasses import replace
from math import pi, radians, sqrt

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import linprog

from quietarm.models import ArmOnFlexibleLink, FlexibleBeam, LinearAxis, SingleLinkManipulator
from quietarm.models.dimensions import SECOND, TIP, Words
from quietarm.ocp import (
    CycloidPolynomial,
    InfeasibleTaskError,
    JointSpline,
    ModalState,
    Plan,
    PointToPoint,
    Uncertainty,
    evaluate_coefficients,
    fastest_move,
    plan_move,
)
from quietarm.ocp.limits import Quantity, add_quantity, remove_quantity
from quietarm.ocp.planning.fastest import fastest_residual_limit

LINK = PointToPoint(SingleLinkManipulator(), pi / 6, 0.8, torque_limit=0.15)
SIX = CycloidPolynomial(6)
AXIS = PointToPoint(LinearAxis(), 1.5, 1.0, speed_limit=1.0, acceleration_limit=2.0)
CRANE = PointToPoint(LinearAxis(omega1=1.566), 6.0, 9.0, speed_limit=1.2, acceleration_limit=0.4)
WITHIN = 1.015
"""Of the linear program's least time: what `fastest` promises."""


def trapezoid(task):
    """Least time of a rigid joint within a speed and an acceleration that it reaches [s]."""
    speed, acceleration = task.speed_limit, task.acceleration_limit
    return abs(task.span) / speed + speed / acceleration


def half_period(plant):
    """By which a ZV shaper prolongs a motion [s]."""
    return pi / (plant.omega1 * sqrt(1 - plant.zeta1**2))


def keeps_its_limits(plan):
    """By CVODES, with what a drive does not notice."""
    return not plan.motion.exceeded(plan.task.limits, 1e-3)


@pytest.fixture(scope="module")
def fastest():
    return fastest_move(LINK, SIX)


@pytest.mark.slow
def test_along_a_profile_the_plan_keeps_its_limits_and_a_shorter_one_fails(fastest):
    plan = fastest.plan
    assert plan.residual < 1e-8
    assert plan.motion.peak_torque <= 0.15 * (1 + 1e-6)
    duration, why = fastest.failed[0]
    assert fastest.duration / (1 + 1e-3) <= duration < fastest.duration
    assert "torque limit" in why
    with pytest.raises(InfeasibleTaskError):
        plan_move(replace(LINK, duration=duration), SIX)
    # and neither do others farther below it, of which linear programs say how far beyond they are
    assert min(shorter for shorter, _ in fastest.failed) < 0.85 * fastest.duration
    for _, reason in fastest.failed[1:]:
        assert re.search(r"exceeds a limit by \d+ % or more", reason)


def test_what_has_no_shortest_duration_is_refused():
    with pytest.raises(ValueError, match="nothing limits how fast the move may be; give a"):
        fastest_move(replace(LINK, torque_limit=None))
    with pytest.raises(ValueError, match="tolerance is 0"):
        fastest_move(LINK, duration_tolerance=0)
    # 4e-7 rad/s^2 at most: the move takes half an hour, 17000 radians of the link's swing
    with pytest.raises(InfeasibleTaskError, match="no duration was found: duration"):
        fastest_move(replace(LINK, torque_limit=None, acceleration_limit=7e-7))


@pytest.mark.slow
def test_a_move_that_cruises_is_within_the_linear_programs_time_and_no_slower_than_zv():
    # the axis swings at 12 Hz: its linear program needs no longer than a rigid joint, 2 s
    fastest = fastest_move(AXIS)
    plan = fastest.plan
    least = trapezoid(AXIS)
    assert least <= fastest.duration <= min(WITHIN * least, least + half_period(AXIS.plant))
    assert plan.residual < 1e-6
    assert keeps_its_limits(plan)
    assert isinstance(plan.profile, JointSpline)
    duration, _ = fastest.failed[0]
    assert fastest.duration / 1.01 <= duration < fastest.duration


@pytest.mark.slow
def test_a_plan_on_a_spline_is_saved_and_loaded(tmp_path):
    plan = fastest_move(CRANE).plan
    plan.save(tmp_path / "plan.json")
    assert Plan.load(tmp_path / "plan.json") == plan


def least_time_by_a_linear_program(task, intervals=240):
    """Find the least time of a linear axis by bisection [s], with accelerations of steps.

    The state, position, speed and the load's swing, is propagated by matrix exponentials.
    """
    plant = task.plant
    system = np.zeros((5, 5))  # position, speed, W, W' and the constant acceleration
    system[0, 1] = system[1, 4] = system[2, 3] = 1.0
    system[3, 2:] = -(plant.omega1**2), -2 * plant.zeta1 * plant.omega1, -plant.share1

    def feasible(duration):
        step = expm(system * duration / intervals)
        rows, arrival = [], np.zeros((4, intervals))
        for k in range(intervals):
            arrival = step[:4, :4] @ arrival
            arrival[:, k] = step[:4, 4]
            rows.append(arrival[1].copy())
        found = linprog(
            np.zeros(intervals),
            A_ub=np.vstack([rows, -np.array(rows)]),
            b_ub=np.full(2 * intervals, task.speed_limit),
            A_eq=arrival,
            b_eq=[task.target, 0, 0, 0],
            bounds=(-task.acceleration_limit, task.acceleration_limit),
        )
        return found.status == 0

    low, high = trapezoid(task), 1.5 * trapezoid(task)
    while high / low > 1 + 1e-4:
        middle = (low + high) / 2
        low, high = (low, middle) if feasible(middle) else (middle, high)
    return high


def test_a_crane_is_as_fast_as_the_linear_program_says():
    least = least_time_by_a_linear_program(CRANE)
    assert least == pytest.approx(8.498, rel=1e-3)  # another program's, with 400 intervals
    fastest = fastest_move(CRANE)
    assert fastest.duration <= WITHIN * least
    assert keeps_its_limits(fastest.plan)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("task", "most"),
    [
        # linear programs with a jerk limit, by the reviewer who reported these moves
        (PointToPoint(LinearAxis(omega1=60.0), 1e-3, 0.1, jerk_limit=100.0), WITHIN * 0.1070),
        (PointToPoint(LinearAxis(omega1=60.0), 1e-5, 0.1, jerk_limit=100.0), WITHIN * 0.0440),
        (replace(AXIS, target=0.8), WITHIN * 1.3),
        (replace(AXIS, target=1.0), WITHIN * 1.5),
        # ZV over the rigid joint's time-optimal motion
        (
            PointToPoint(
                FlexibleBeam(omega=10 * pi), pi, 1.0, speed_limit=radians(10),
                acceleration_limit=2.0,
            ),
            18 + radians(10) / 2 + 0.1 * (1 + 1e-3),
        ),
        (
            PointToPoint(
                ArmOnFlexibleLink(), pi, 1.0, speed_limit=radians(6), acceleration_limit=2.0
            ),
            30 + radians(6) / 2 + 0.452,
        ),
    ],
    ids=["1 mm", "10 um", "800 mm", "1000 mm", "a slow beam", "a slow arm"],
)  # fmt: skip
def test_moves_that_cruise_for_many_swings_and_moves_of_a_tenth_of_one(task, most):
    fastest = fastest_move(task)
    assert fastest.duration <= most
    assert fastest.plan.residual < 1e-6
    assert keeps_its_limits(fastest.plan)


@pytest.mark.slow
def test_a_heavy_load_that_its_drive_hardly_moves():
    # 3 t of 3.2 t swing at 2 Hz; a rigid axis takes 2 sqrt(8 m 3200 kg / 100 N) = 32 s without
    # friction
    plant = LinearAxis(omega1=4 * pi, mass=3200.0, load=3000.0, friction=0.0)
    fastest = fastest_move(PointToPoint(plant, 8.0, 1.0, torque_limit=100.0))
    assert 32.0 <= fastest.duration <= 32.5
    assert keeps_its_limits(fastest.plan)


@pytest.mark.slow
def test_acceleration_limits_differ_by_direction():
    # speeding up with 0.4 and braking with 0.2 m/s^2, no cruise: sqrt(2 * 0.5 / 0.4 + ...)
    task = PointToPoint(LinearAxis(), 0.5, 1.0, acceleration_limit=(-0.2, 0.4))
    rigid = sqrt(2 * 0.5 * (1 / 0.2 + 1 / 0.4))
    fastest = fastest_move(task)
    assert rigid <= fastest.duration <= WITHIN * rigid
    back = fastest_move(replace(task, start=0.5, target=0.0))
    assert back.duration == pytest.approx(fastest.duration, rel=5e-3)


@pytest.mark.slow
def test_with_errors_it_arrives_still_within_a_limit_that_does_not_grow():
    # 124 mm were left in 0.45 s, by a limit that grew as the move got shorter
    task = replace(LINK, uncertainty=Uncertainty({"frequency": 0.08}))
    limit = fastest_residual_limit(task)
    assert limit == fastest_residual_limit(replace(task, duration=0.1)) < 3e-3
    nominal = fastest_move(LINK)
    fastest = fastest_move(task)
    assert fastest.duration > nominal.duration
    assert fastest.plan.residual_limit == limit
    for error in (-0.08, -0.043, 0.0, 0.017, 0.08):
        perturbed = fastest.plan.candidate.perturbed({"frequency": error})
        assert perturbed.residual <= limit * (1 + 1e-3)
    narrower = fastest_move(task, residual_limit=2e-3)
    assert 0.995 * fastest.duration <= narrower.duration <= 0.744  # the bound is 2.0.0.dev0's


@pytest.mark.slow
def test_a_line_of_torque_over_speed_is_kept():
    task = replace(LINK, torque_limit=None, torque_speed=((0.15, 2.0), (0.05, 6.0)))
    fastest = fastest_move(task)
    assert keeps_its_limits(fastest.plan)
    assert fastest.duration <= 0.64  # by bisection with 12 terms


@pytest.mark.slow
def test_between_the_last_knots_a_torque_limit_is_kept_as_well():
    # sampled by CVODES at 20000 even times: 0.3 % was passed for a tenth of a millisecond
    plan = fastest_move(LINK).plan
    times = np.linspace(0.0, plan.task.duration, 20_001)
    assert np.abs(plan.sampled(times).torque).max() <= 0.15 * (1 + 1e-3)


@pytest.mark.slow
def test_the_default_limit_of_a_robust_plan_is_kept_by_a_spline_where_terms_do_not():
    # 221 mm, the worst case of the nominal plant's plan, before a spline was tried
    plant = LinearAxis(omega1=0.6283, zeta1=0.002, mass=3000.0, load=2000.0, friction=0.0)
    task = PointToPoint(
        plant, 8.0, 16.0, speed_limit=1.2, acceleration_limit=0.3,
        uncertainty=Uncertainty({"frequency": 0.1}),
    )  # fmt: skip
    plan = plan_move(task)
    bent = evaluate_coefficients(task.certain, []).motion.peak_deflection
    assert plan.worst.residual <= 0.05 * bent * (1 + 1e-3)  # docs/robustness.md


@pytest.fixture
def tip_speed():
    """A limit of one's own, of which no motion of a rigid joint tells."""
    added = add_quantity(
        Quantity("tip_speed", TIP / SECOND, Words("tip speed"), lambda sample: sample.tip_speeds)
    )
    yield added
    remove_quantity(added.name)


@pytest.mark.usefixtures("tip_speed")
def test_a_limit_that_is_in_no_ones_way_does_not_change_what_an_uncertain_move_may_leave():
    free = replace(LINK, torque_limit=None, uncertainty=Uncertainty({"frequency": 0.05}))
    own = replace(free, tip_speed_limit=0.1)
    expected = fastest_residual_limit(own)
    assert 0 < expected < fastest_residual_limit(replace(free, torque_limit=0.15))
    for slack in ({"torque_limit": 1e3}, {"speed_limit": 1e3}):
        assert fastest_residual_limit(replace(own, **slack)) == pytest.approx(expected, rel=1e-6)


@pytest.mark.usefixtures("tip_speed")
def test_a_limit_that_no_duration_keeps_is_named():
    swinging = ModalState([0.1], [0.0])  # its tip is faster than that before the joint moves
    task = replace(LINK, torque_limit=None, tip_speed_limit=0.1, initial=swinging)
    with pytest.raises(
        InfeasibleTaskError, match=r"breaks its limits \(tip speed 0.1 m/s\) in every"
    ):
        fastest_move(task)


@pytest.mark.slow
@pytest.mark.usefixtures("tip_speed")
def test_a_very_slow_limit_of_ones_own_takes_as_long_as_it_has_to():
    # where nothing swings the tip's speed is the jerk times a constant, and that span / duration^3
    durations = [
        fastest_move(replace(LINK, torque_limit=None, tip_speed_limit=limit)).duration
        for limit in (1e-3, 1e-6)
    ]
    assert durations[1] / durations[0] == pytest.approx(10, rel=0.02)


@pytest.mark.slow
@pytest.mark.usefixtures("tip_speed")
@pytest.mark.parametrize(
    ("binding", "slack"),
    [
        ({"tip_speed_limit": 0.1}, {"torque_limit": 1e3}),
        ({"tip_speed_limit": 0.1}, {"speed_limit": 1e3}),
        ({"torque_limit": 0.15}, {"tip_speed_limit": 1e3}),
    ],
)
def test_a_limit_that_is_in_no_ones_way_does_not_change_the_least_time(binding, slack):
    alone = fastest_move(replace(LINK, **{"torque_limit": None, **binding})).duration
    both = fastest_move(replace(LINK, **{"torque_limit": None, **binding, **slack})).duration
    assert both == pytest.approx(alone, rel=1e-4)
