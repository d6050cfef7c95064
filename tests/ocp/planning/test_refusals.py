"""Tasks that cannot be are refused before anything is solved; a bound is below what can be."""

import math
from dataclasses import replace

import pytest

import quietarm as qa
from quietarm.models import LinearAxis, SingleLinkManipulator
from quietarm.ocp import InfeasibleTaskError, PointToPoint
from quietarm.ocp.planning.plan_along import refuse_far_beyond
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.rigid_pass import least_duration
from quietarm.ocp.planning.too_short import refuse_too_short
from quietarm.ocp.profiles.networks import CycloidGaussians

SPAN = math.radians(30)
LINK = PointToPoint(SingleLinkManipulator(c=0.0), SPAN, 0.8)
# alpha1 of eq (10) [kg m^2], which a joint without vibration has to move.
INERTIA = 2.383e-2


@pytest.fixture
def solves(monkeypatch):
    """Count the problems that a solver was given."""
    counted = []
    solve = qa.Sqp.solve

    def counting(self, problems, *args, **kwargs):
        counted.extend(problems)
        return solve(self, problems, *args, **kwargs)

    monkeypatch.setattr(qa.Sqp, "solve", counting)
    return counted


@pytest.mark.parametrize(
    ("limit", "least"),
    [
        # From rest to rest: T^2 = 4 d / a, T = d / v, T^3 = 32 d / j.
        ({"torque_limit": 0.02}, math.sqrt(4 * SPAN * INERTIA / 0.02)),
        ({"torque_limit": (-0.02, 0.06)}, math.sqrt(8 * SPAN * INERTIA / 0.08 * 4 / 3)),
        ({"acceleration_limit": 2.0}, math.sqrt(4 * SPAN / 2.0)),
        ({"speed_limit": 0.5}, SPAN / 0.5),
    ],
)
def test_the_least_duration_is_that_of_a_rigid_joint(limit, least):
    assert least_duration(replace(LINK, **limit), True) == pytest.approx(least, rel=3e-3)


def test_a_deflection_needs_what_the_mode_bends_by_at_constant_acceleration():
    # W = beta1 / omega^2 times the acceleration, 2.28 of which is seen at the tip (eqs (9), (10)).
    bent = 2.28 * 2.555e-1 / 10.43**2
    task = replace(LINK, deflection_limit=0.005)
    expected = math.sqrt(4 * SPAN * bent / 0.005)
    assert least_duration(task, True) == pytest.approx(expected, rel=0.02)
    assert least_duration(task, False) < 1e-9  # a tip that may swing after arrival need not bend


def test_where_the_tip_may_swing_only_the_hub_has_to_be_moved():
    # alpha1 - alpha2 beta1 of eq (10), and nothing has to brake: d = a T^2 / 2.
    hub = INERTIA - 9.261e-2 * 2.555e-1
    task = replace(LINK, torque_limit=1e-4)
    expected = math.sqrt(2 * SPAN * hub / 1e-4)
    assert least_duration(task, False) == pytest.approx(expected, rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    "limit",
    [
        {"torque_limit": 30.0},
        {"torque_limit": (-10.0, 40.0)},
        {"deflection_limit": 0.02},
        {"torque_speed": ((60.0, 0.0), (20.0, 0.5))},
        {"speed_limit": 0.3, "torque_limit": 60.0},
    ],
)
def test_what_is_planned_takes_no_less(limit):
    task = PointToPoint(LinearAxis(), 0.3, 1.0, **limit)
    fastest = qa.fastest_move(task, duration_tolerance=0.02)
    assert least_duration(task, True) <= fastest.duration


@pytest.mark.parametrize(
    "limit",
    [
        {"torque_limit": 1e-4},
        {"torque_limit": 1e-30},
        {"torque_limit": (-1e-4, 2e-4)},
        {"speed_limit": 1e-30},
        {"acceleration_limit": 1e-30},
        {"jerk_limit": 1e-30},
        {"deflection_limit": 1e-30},
        pytest.param({"torque_speed": ((1e-3, 0.0), (5e-4, 3.0))}, marks=pytest.mark.slow),
        {"torque_limit": {"joint": 1e-9}},
    ],
)
def test_a_limit_far_too_narrow_is_refused_before_it_is_solved(solves, limit):
    task = replace(LINK, **limit)
    with pytest.raises(InfeasibleTaskError, match=r"^0\.8 s is too short: .* takes \S+ s"):
        qa.plan_move(task)
    assert len(solves) <= 4  # of the remedy alone, where it is looked for


@pytest.mark.parametrize("name", ["torque", "speed", "acceleration", "jerk", "deflection"])
def test_the_width_that_is_named_is_the_least(name):
    task = replace(LINK, **{f"{name}_limit": 1e-3})
    with pytest.raises(InfeasibleTaskError, match=r"in 0\.8 s it takes (\S+) ") as error:
        refuse_too_short(task, True)
    least = float(str(error.value).split("it takes ")[1].split()[0])
    wider = replace(task, **{f"{name}_limit": 1.002 * least})
    assert max(least_duration(wider, True), 0.0) <= task.duration
    refuse_too_short(wider, True)


def test_many_moves_are_refused_each_for_itself(solves):
    tasks = [replace(LINK, torque_limit=limit) for limit in (1e-4, 0.5)]
    moves = qa.plan_moves(tasks, qa.CycloidPolynomial(6))
    assert [status.value for status in moves.status] == ["infeasible", "optimal"]
    assert "even a rigid joint takes" in moves.reasons[0]
    assert len(solves) < 20


def test_a_motion_named_in_words_arrives_at_rest():
    task = replace(LINK, torque_limit=0.083)
    with pytest.raises(InfeasibleTaskError, match="with the tip at rest on arrival, torque <= "):
        qa.plan_move(task, qa.CycloidPolynomial(2), starts=1)


@pytest.mark.parametrize("profile", [None, qa.CycloidPolynomial(6)])
def test_a_machine_that_cannot_hold_itself_is_told_what_it_takes(pendulum, solves, profile):
    task = PointToPoint(pendulum, math.pi / 2, 1.0, torque_limit=5.0)
    words = r"^to stand still at its target .* torque 9\.81 N m, above .* at least 9\.82 N m, or"
    with pytest.raises(InfeasibleTaskError, match=words):
        qa.plan_move(task, profile)
    assert not solves  # what holds it is known at once


@pytest.mark.slow
def test_the_joint_of_a_robot_that_cannot_hold_itself_is_named():
    from robots import straight, ur5_with_bar

    limits = {"shoulder_pan_joint": 150.0, "shoulder_lift_joint": 30.0, "elbow_joint": 150.0}

    words = r"torque 4\d\.\d+ N m at shoulder_lift_joint, above its limit of 30 N m; give a "
    words += r"torque limit of at least 4\d\.\d+ N m at shoulder_lift_joint, or"
    with pytest.raises(InfeasibleTaskError, match=words):  # 45.9 N m at most, by MuJoCo
        qa.plan_move(ur5_with_bar().task(straight(), 1.0, torque_limit=limits))


@pytest.fixture
def pendulum():
    """An arm of 1 kg m that gravity pulls down, with a mode beside."""
    import casadi as ca

    from quietarm.models import Plant

    class Pendulum(Plant):
        name = "pendulum-of-a-test"
        modes = 1

        def modal_accelerations(self, joint, W, dW):
            return [-100.0 * W[0] - 0.1 * dW[0] - 0.5 * joint.acceleration]

        def torque(self, joint, W, dW, ddW):
            return joint.acceleration + 0.5 * ddW[0] + 9.81 * ca.sin(joint.angle)

        def tip_displacements(self, W):
            return [W[0]]

    from dataclasses import dataclass

    return dataclass(frozen=True)(Pendulum)()


OUT_OF_REACH = PointToPoint(
    SingleLinkManipulator(), SPAN, 0.5, torque_limit=0.2, jerk_limit=400, band=1e-4
)


@pytest.mark.slow
@pytest.mark.parametrize("profile", [qa.CycloidPolynomial(8), CycloidGaussians()])
def test_a_named_profile_far_from_a_robust_limit_is_refused_without_a_solver(solves, profile):
    with pytest.raises(InfeasibleTaskError, match="limits of torque and jerk wider by ") as error:
        qa.plan_move(OUT_OF_REACH, profile)
    assert not solves
    wider = 1 + float(str(error.value).split("wider by ")[1].split()[0]) / 100
    limits = {"torque_limit": 1.02 * wider * 0.2, "jerk_limit": 1.02 * wider * 400}
    if profile.size == 8:  # on Gaussians linear programs find a motion near the start alone
        refuse_far_beyond(Request(replace(OUT_OF_REACH, **limits), profile).stating(None))


@pytest.mark.slow
def test_limits_far_out_of_reach_are_refused_with_a_duration_that_will_do(solves):
    with pytest.raises(InfeasibleTaskError, match=r"a duration of (\S+) s will do") as error:
        qa.plan_move(OUT_OF_REACH)
    assert len(solves) < 20  # of the remedy and of the plan by which it is confirmed
    longer = float(str(error.value).split("duration of ")[1].split()[0])
    assert 0.5 < longer < 1.5
