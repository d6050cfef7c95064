"""Free motions: their kinematics, and their figures against other integrators."""

import numpy as np
import pytest
from quietarm.models import JointMotion
from quietarm.ocp import CycloidPolynomial, resimulate
from quietarm.ocp.floor.grid import finer
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.simulation.piecewise import PiecewiseMotion
from quietarm.ocp.simulation.resimulation import resimulated
from scipy.integrate import quad, solve_ivp


def simulate(task, free):
    return resimulated(task, PiecewiseMotion.of_free_motion(task, free))


COARSE = np.array([0.0, 0.01, 0.3, 0.45, 0.8])


@pytest.fixture(params=["free acceleration", "smooth"])
def free(request):
    """A motion of a few intervals whose torque jumps, or bends, and whose power changes sign."""
    if request.param == "smooth":
        acceleration = np.array([0.0, 12.0, -15.0, -2.0, 0.0])
        return FreeMotion(COARSE, acceleration[:-1], np.diff(acceleration) / np.diff(COARSE))
    return FreeMotion(COARSE, [150.0, 2.0, -14.0, 0.5], np.zeros(4))


def test_angle_and_speed_are_integrals_of_the_acceleration(free):
    angle, speed = free.boundaries(0.2)

    def acceleration(t):
        k = min(np.searchsorted(free.times, t, side="right") - 1, free.steps - 1)
        return free.acceleration[k] + free.jerk[k] * (t - free.times[k])

    inside = free.times[1:-1]
    by_quadrature = quad(acceleration, 0, 0.8, points=inside)[0]
    twice = quad(lambda t: (0.8 - t) * acceleration(t), 0, 0.8, points=inside)[0]
    assert speed[-1] == pytest.approx(by_quadrature, rel=1e-9)
    assert angle[-1] == pytest.approx(0.2 + twice, rel=1e-9)


def test_a_split_motion_is_the_same_motion(free):
    finer_free = free.split(np.array([1, 3, 2, 4]))
    assert finer_free.steps == 10
    at = np.isin(finer_free.times, free.times)
    assert finer_free.boundaries(0.1)[:, at] == pytest.approx(free.boundaries(0.1), abs=1e-12)


def test_refining_halves_every_interval_and_quarters_jumps_of_the_speed(free):
    # Three of the four intervals change the speed by more than 2 % of its largest; the last of
    # the free acceleration does not stand out enough: 0.5 rad/s^2 over 0.35 s do.
    changes = np.abs(np.diff(free.boundaries(0.0)[1]))
    expected = np.where(changes > 0.02 * np.abs(free.boundaries(0.0)[1]).max(), 4, 2)
    assert finer(free).steps == expected.sum()


def test_the_figures_do_not_depend_on_how_a_motion_is_cut_in_intervals(tasks):
    # A smooth jolt at either end, as in a floor: within its interval the power is a quintic.
    jerk = np.array([4e5, -1e4, 0.0, 1e4, -4e5])
    lengths = np.array([2e-3, 0.08, 0.636, 0.08, 2e-3])
    times = np.append(0.0, np.cumsum(lengths))
    free = FreeMotion(times, np.append(0.0, np.cumsum(jerk * lengths))[:-1], jerk)
    fine = free.split(np.full(5, 200))
    found, expected = simulate(tasks["arm"], free).motion, simulate(tasks["arm"], fine).motion
    for name, value in vars(expected).items():
        if name != "overshoot":
            assert getattr(found, name) == pytest.approx(value, rel=1e-8, abs=1e-12), name


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_figures_are_those_of_scipy(tasks, free, name):
    # DOP853 interval by interval, |power| integrated as a state of its own.
    task = tasks[name]
    plant, modes = task.plant, task.plant.modes
    angle, speed = free.boundaries(task.start)
    z, peak_torque = np.zeros(2 * modes + 2), 0.0
    for k in range(free.steps):

        def at(t, z, k=k):
            a, j = free.acceleration[k], free.jerk[k]
            joint = JointMotion(
                angle[k] + speed[k] * t + a * t**2 / 2 + j * t**3 / 6,
                speed[k] + a * t + j * t**2 / 2,
                a + j * t,
            )
            W, dW = list(z[:modes]), list(z[modes : 2 * modes])
            ddW = [float(x) for x in plant.modal_accelerations(joint, W, dW)]
            torque = float(plant.torque(joint, W, dW, ddW))
            return joint, dW, ddW, torque

        def derivative(t, z, at=at):
            joint, dW, ddW, torque = at(t, z)
            power = torque * joint.speed
            return [*dW, *ddW, power, abs(power)]

        h = free.lengths[k]
        run = solve_ivp(derivative, (0, h), z, "DOP853", rtol=1e-10, atol=1e-12, max_step=h / 40)
        torques = [abs(at(t, y)[3]) for t, y in zip(run.t, run.y.T, strict=True)]
        peak_torque, z = max(peak_torque, *torques), run.y[:, -1]
    found = simulate(task, free)
    # SciPy's own error, whose |power| has a corner where the power changes its sign.
    assert found.motion.energy == pytest.approx(z[-1], rel=1e-6)
    assert found.motion.net_work == pytest.approx(z[-2], rel=1e-7, abs=1e-9)
    assert found.motion.peak_torque == pytest.approx(peak_torque, rel=2e-2)
    arrival = np.flatnonzero(found.trajectory.time <= task.duration)[-1]
    assert found.trajectory.modes[arrival] == pytest.approx(z[:modes], abs=1e-9)


def test_a_fine_grid_along_a_plan_has_the_plan_s_figures(tasks):
    # The cycloid's own acceleration, linear between 2000 points: error of the order of h^2.
    task, profile = tasks["arm"], CycloidPolynomial(2)
    coefficients = [0.1, -0.2]
    path = profile.path(coefficients, *task.move)
    times = np.linspace(0, task.duration, 2001)
    acceleration = path(times, 2)
    free = FreeMotion(times, acceleration[:-1], np.diff(acceleration) / np.diff(times))
    found, expected = simulate(task, free).motion, resimulate(task, profile, coefficients)
    for name in ("energy", "residual", "net_work", "peak_torque", "peak_speed"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=2e-5)


def test_times_stand_twice_where_the_torque_jumps(tasks):
    free = FreeMotion(COARSE, [150.0, 2.0, -14.0, 0.5], np.zeros(4))
    sampled = simulate(tasks["arm"], free).trajectory
    for k, time in enumerate(free.times[1:-1], start=1):
        before, after = np.flatnonzero(np.isclose(sampled.time, time, rtol=0, atol=1e-12))
        assert sampled.joint[[before, after], 2] == pytest.approx(free.acceleration[k - 1 : k + 1])
        assert sampled.joint[before, :2] == pytest.approx(sampled.joint[after, :2])
    assert sampled.time[-1] == pytest.approx(1.8)
