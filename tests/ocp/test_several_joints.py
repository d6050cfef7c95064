"""Plants of several joints along one path: energies, limits, both solvers, files.

The independent figures are by SciPy's DOP853 along the planned motion, and by the trapezoidal rule
for the absolute power of every joint.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from several_joints import Gantry, TwoLinks

import quietarm as qa
from quietarm.ocp import PositivePower
from quietarm.ocp.joint_words import broken_limits, passed_words, peak_words
from quietarm.ocp.limits import Limit

LINKS = qa.PointToPoint(TwoLinks(), target=1.0, duration=0.6)
GANTRY = qa.PointToPoint(Gantry(), target=0.5, duration=0.7)


@pytest.fixture(scope="module")
def links():
    return qa.plan_move(LINKS)


@pytest.fixture(scope="module")
def gantry():
    return qa.plan_move(GANTRY)


def path_of(plan):
    """Place, speed and acceleration along the path at a time."""
    at = plan.profile.path(plan.coefficients, *plan.task.move)
    times = np.linspace(0.0, plan.task.duration, 8001)  # a spline between them errs by 1e-10
    return CubicSpline(times, np.transpose([at(times, order) for order in range(3)]))


def followed(plan, rates):
    """Times of the move and the state there, from rest."""
    times = np.linspace(0.0, plan.task.duration, 2001)
    run = solve_ivp(rates, times[[0, -1]], np.zeros(4), "DOP853", times, rtol=1e-8, atol=1e-10)
    return times, run.y


def work(torques, speeds, times):
    """Integral of the absolute power, summed over the joints."""
    return np.trapezoid(np.abs(torques * speeds), times).sum()


def nonlinear(plan):
    """Energy and state on arrival of the two links by their full equations of motion."""
    plant, path = plan.task.plant, path_of(plan)
    ways = np.array([plant.way1, plant.way2])
    stiffness = np.array([plant.stiffness1, plant.stiffness2])

    def springs(state):
        return stiffness * (state[:2] + plant.damping_time * state[2:])

    def rates(time, state):
        place, speed, acceleration = path(time)
        M11, M12, M22, h, _ = map(float, plant.inertias(
            plant.start2 + plant.way2 * place + state[1]
        ))  # fmt: skip
        v1, v2 = ways * speed + state[2:]
        centrifugal = np.array([-h * v2 * (2 * v1 + v2), h * v1 * v1])
        inertia = np.array([[M11, M12], [M12, M22]])
        links = np.linalg.solve(inertia, -springs(state) - centrifugal)
        return np.concatenate([state[2:], links - ways * acceleration])

    times, states = followed(plan, rates)
    _, speed, acceleration = path(times).T
    torques = plant.rotor * np.outer(ways, acceleration) - np.array([*map(springs, states.T)]).T
    return work(torques, np.outer(ways, speed), times), states[:, -1]


def test_two_links_take_the_energy_of_both_motors_and_arrive_still(links):
    # Planned on |sum of torque * speed| the two motors take 20.78 J, and 15.61 J seem enough.
    assert links.energy == pytest.approx(20.182, rel=1e-4)
    energy, arrival = nonlinear(links)
    assert links.energy == pytest.approx(energy, rel=1e-3)  # the plant is linear in its springs
    _, of_cycloid = nonlinear(qa.evaluate_coefficients(LINKS, []))
    assert np.abs(arrival[:2]).max() < 0.01 * np.abs(of_cycloid[:2]).max()


def test_a_gantry_takes_the_energy_of_both_carriages(gantry):
    # Planned on |sum of force * speed| it seems to be 36.155 J.
    assert gantry.energy == pytest.approx(36.252, rel=1e-4)
    plant, path = GANTRY.plant, path_of(gantry)
    shares, omegas = np.array(plant.shares), np.array([plant.omega_x, plant.omega_y])

    def swing(state, acceleration):
        forces = -omegas * (omegas * state[:2].T + 2 * plant.zeta * state[2:].T)
        return forces.T - np.multiply.outer(shares, acceleration)

    times, states = followed(
        gantry,
        lambda time, state: np.concatenate([state[2:], swing(state, path(time)[2])]),
    )
    _, speed, acceleration = path(times).T
    masses = np.array([plant.mass_x, plant.mass_y])
    forces = np.outer(masses * shares, acceleration) + plant.load * swing(states, acceleration)
    assert work(forces, np.outer(shares, speed), times) == pytest.approx(gantry.energy, rel=1e-4)
    assert np.abs(states[:2, -1]).max() < 1e-6


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("solver", [qa.Sqp(), qa.Ipopt()], ids=["sqp", "ipopt"])
@pytest.mark.parametrize(
    "energy", [PositivePower(), qa.CopperLoss(3.0)], ids=["positive", "copper"]
)
def test_every_energy_sums_over_the_joints(solver, energy):
    plan = qa.plan_move(replace(GANTRY, energy=energy), solver=solver)
    sample, times = plan.trajectory.sample, plan.trajectory.time
    on_the_way = times <= GANTRY.duration
    rates = {
        "positive": sum(np.maximum(power, 0.0) for power in sample.powers),
        "copper": sum((torque / 3.0) ** 2 for torque in sample.torques),
    }
    taken = np.trapezoid(rates[energy.name][on_the_way], times[on_the_way])
    assert plan.energy == pytest.approx(taken, rel=1e-3)


@pytest.mark.slow
def test_both_solvers_agree(links):
    assert qa.plan_move(LINKS, solver=qa.Ipopt()).energy == pytest.approx(links.energy, rel=1e-6)


@pytest.mark.slow
def test_limits_hold_for_each_joint_by_its_name(links):
    free = [float(np.abs(torque).max()) for torque in links.trajectory.sample.torques]
    assert free[0] > 36.0
    assert free[1] > 9.0
    limits = {"shoulder": 36.0, "elbow": (-6.5, 9.0)}
    task = replace(LINKS, torque_limit=limits, acceleration_limit={"shoulder": 40.0})
    plan = qa.plan_move(task)
    shoulder, elbow = plan.trajectory.sample.torques
    assert np.abs(shoulder).max() <= 36.0 * (1 + 1e-6)
    assert elbow.min() >= -6.5 * (1 + 1e-6)
    assert elbow.max() <= 9.0 * (1 + 1e-6)
    moving = plan.trajectory.sample.joints[0]
    assert np.abs(moving.acceleration).max() <= 40.0 * (1 + 1e-6)
    assert plan.figures.range_of(plan.task.limit_of("torque").quantity) == pytest.approx(
        (-1.0, 1.0), rel=1e-2
    )
    assert plan.motion.peak_torque == pytest.approx(np.abs(shoulder).max(), rel=1e-3)
    assert task.limits[0].bounds == "shoulder 36 N m; elbow -6.5 to 9 N m"


def test_a_plan_with_limits_by_joint_loads_to_an_equal_value(tmp_path):
    task = replace(GANTRY, torque_limit={"joint_1": 400.0}, speed_limit=2.0)
    plan = qa.evaluate_coefficients(task, [0.01, -0.02])
    plan.save(tmp_path / "plan.json")
    again = qa.Plan.load(tmp_path / "plan.json")
    assert again == plan
    assert (again.task.torque_limit, hash(again.task)) == ({"joint_1": 400.0}, hash(task))


def test_a_refusal_names_the_joint_that_takes_too_long_and_the_limit_that_would_do():
    task = replace(GANTRY, speed_limit={"joint_1": 9.0, "joint_2": 0.1})
    with pytest.raises(qa.InfeasibleTaskError, match="even a rigid joint_2 takes 3 s") as refused:
        qa.plan_move(task, qa.CycloidPolynomial(4), starts=1)  # 0.3 m at 0.1 m/s
    (offered,) = re.findall(r"unchanged: speed limit ([\d.]+) m/s at joint_2$", str(refused.value))
    assert 0.3 / 0.7 < float(offered) < 2 * 0.3 / 0.7  # of constant speed, of the plain cycloid


@pytest.mark.parametrize("limit", [6.0, {"elbow": 6.0, "shoulder": 90.0}])
def test_a_limit_that_is_passed_is_told_with_its_joint(limit):
    """Peaks of the plain cycloid by the samples of its trajectory."""
    motion = qa.evaluate_coefficients(replace(LINKS, torque_limit=limit), []).candidate
    shoulder, elbow = (float(np.abs(row).max()) for row in motion.moving.torques)
    assert 6.0 < elbow < shoulder < 90.0
    (asked,) = motion.task.limits
    passed = {"elbow": elbow}
    if limit == 6.0:
        passed = {"shoulder": shoulder, "elbow": elbow}
    words = [f"{peak:.4g} N m at {joint}" for joint, peak in passed.items()]
    assert peak_words(asked, motion) == " and ".join(words)
    assert passed_words(asked, motion).startswith(f"{words[0]}, above its limit of 6 N m")
    assert broken_limits(motion, [asked], 1e-3) == [f"torque at {', '.join(passed)}"]
    residual = Limit.of_residual(1e-3)  # of no joint
    assert peak_words(residual, motion) == f"{motion.residual:.4g} m"


@pytest.mark.slow
def test_a_remedy_names_the_joint_whose_limit_has_to_be_wider():
    profile = qa.CycloidPolynomial(4)
    limits = {"joint_1": 2e3, "joint_2": 44.0}  # enough for a rigid joint
    task = replace(GANTRY, torque_limit=limits)
    with pytest.raises(qa.InfeasibleTaskError) as refused:
        qa.plan_move(task, profile, starts=1)
    words = str(refused.value)
    (offered,) = re.findall(r"unchanged: force limit ([\d.]+) N at joint_2;", words)
    wider = limits | {"joint_2": float(offered)}
    plan = qa.plan_move(replace(task, torque_limit=wider), profile, starts=1)
    assert plan.motion.peak_torque < 2e3


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        ({"torque_limit": {"elbo": 3.0}}, "has no joint 'elbo'; did you mean 'elbow'?"),
        ({"torque_limit": {}}, "give a limit of one joint or more, by name"),
        ({"speed_limit": {"elbow": -1.0}}, "speed limit of elbow is -1"),
        ({"deflection_limit": {"elbow": 0.1}}, "give one for all"),
        ({"target": 1.2}, "target is 1.2 and two-links is defined from 0 to 1"),
    ],
)
def test_wrong_limits_and_places_are_refused(limit, message):
    with pytest.raises(ValueError, match=message.replace("?", r"\?")):
        replace(LINKS, **limit)


def test_rates_that_are_no_derivatives_are_refused():
    class Wrong(TwoLinks):
        name = "wrong-rates"

        def tip_speeds(self, path, W, dW):
            return self.tips_at(path, dW)

    with pytest.raises(ValueError, match=r"tip_speeds gives a rate of .* time derivatives"):
        Wrong().validate()


def test_tables_have_the_columns_of_every_joint(gantry, tmp_path):
    gantry.save_csv(tmp_path / "move.csv", 100.0)
    header, *rows = (tmp_path / "move.csv").read_text().splitlines()
    assert header == (
        "time_s,joint_1_position_m,joint_2_position_m,joint_1_speed_m_s,joint_2_speed_m_s,"
        "joint_1_acceleration_m_s2,joint_2_acceleration_m_s2,"
        "tip_1_m,tip_2_m,joint_1_force_N,joint_2_force_N,power_W"
    )
    last = [float(value) for value in rows[-1].split(",")]
    assert (last[0], last[1], last[2]) == pytest.approx((0.7, 0.4, 0.3))
