"""Free motions: their kinematics, and their figures against other integrators."""

import numpy as np
import pytest
from quietarm.ocp.profiles.free_motion import FreeMotion
from scipy.integrate import solve_ivp

import quietarm as qa


def simulate(task, free):
    return qa.Candidate.of_free_motion(task, free)


COARSE = np.array([0.0, 0.01, 0.3, 0.45, 0.8])


@pytest.fixture(params=["free acceleration", "smooth"])
def free(request):
    """A motion of a few intervals whose torque jumps, or bends, and whose power changes sign."""
    if request.param == "smooth":
        acceleration = np.array([0.0, 12.0, -15.0, -2.0, 0.0])
        return FreeMotion(COARSE, acceleration[:-1], np.diff(acceleration) / np.diff(COARSE))
    return FreeMotion(COARSE, [150.0, 2.0, -14.0, 0.5], np.zeros(4))


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
            joint = qa.JointMotion(
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
