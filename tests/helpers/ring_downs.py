"""Ring-downs of a small robot whose joints are held, by its own linear equations."""

import numpy as np

from quietarm.machine import RobotRecording
from quietarm.machine.held_robots.held_modes import HeldModes

POSTURE = (0.2, 0.8)
RATE = 250


def ring_down(robot, signal, seconds=2.5, noise=1e-3):
    """What two modes of a robot show, with noise as a share, by its linear equations.

    MuJoCo, which knows nothing of them, is asked in tests/benchmarks/test_identifying_robots.py.
    """
    modes = HeldModes(robot, np.array(POSTURE), signal, (0, 1, 2), 2)
    time = np.arange(round(seconds * RATE)) / RATE
    swings = np.exp(np.outer(time, modes.values)) * [0.01, 0.006]
    values = (swings @ modes.rows_at(modes.values).T).real
    random = np.random.default_rng(0)
    values = values + noise * np.abs(values).max() * random.standard_normal(values.shape)
    if signal == "torques":
        q = np.concatenate([POSTURE, robot.dynamics.sag(np.array(POSTURE))])
        values = values + robot.dynamics.at_rest(q)[0][:2]
    return RobotRecording(time, **{signal: values})
