"""Free motions: their kinematics, and their figures against other integrators."""

import numpy as np
import pytest
from third_opinion import followed

import quietarm as qa
from quietarm.models import JointMotion
from quietarm.ocp.profiles.free_motion import FreeMotion


def simulate(task, free):
    return qa.JudgedMotion.of_free_motion(task, free)


COARSE = np.array([0.0, 0.01, 0.3, 0.45, 0.8])


@pytest.fixture(params=["free acceleration", "smooth"])
def free(request):
    """A motion of a few intervals whose torque jumps, or bends, and whose power changes sign."""
    if request.param == "smooth":
        acceleration = np.array([0.0, 12.0, -15.0, -2.0, 0.0])
        return FreeMotion(COARSE, acceleration[:-1], np.diff(acceleration) / np.diff(COARSE))
    return FreeMotion(COARSE, [150.0, 2.0, -14.0, 0.5], np.zeros(4))


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_figures_are_those_of_scipy(tasks, free, name):
    task = tasks[name]
    plant, modes = task.plant, task.plant.modes
    angle, speed = free.boundaries(task.start)

    def joint(t):
        k = min(np.searchsorted(free.times, t, side="right") - 1, free.steps - 1)
        a, j, t = free.acceleration[k], free.jerk[k], t - free.times[k]
        return JointMotion(
            angle[k] + speed[k] * t + a * t**2 / 2 + j * t**3 / 6,
            speed[k] + a * t + j * t**2 / 2,
            a + j * t,
        )

    # just short of a corner the interval before it counts
    ends = np.where(free.times > 0, np.nextafter(free.times, 0), 0.0)
    z, _ = followed(plant, joint, ends, rtol=1e-10, atol=1e-12)
    found = simulate(task, free)
    # SciPy's own error, whose |power| has a corner where the power changes its sign.
    assert found.motion.energy == pytest.approx(z[-1], rel=1e-6)
    assert found.motion.net_work == pytest.approx(z[-2], rel=1e-7, abs=1e-9)
    assert np.all(np.diff(found.trajectory.time) >= 0)
    arrival = np.flatnonzero(found.trajectory.time <= task.duration)[-1]
    assert found.trajectory.modes[arrival] == pytest.approx(z[:modes], abs=1e-9)
