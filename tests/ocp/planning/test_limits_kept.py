"""No limit is passed between the samples: ten plans against SciPy's DOP853, sampled densely."""

from math import pi

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from quietarm.ocp import CycloidPolynomial, PointToPoint, plan_move
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.sample import sample_plant

MOVES = {
    "single link, back": ("single link", 0.2, -1.0, 0.7),
    "arm, 135deg": ("arm", -pi / 2, pi / 4, 1.0),
    "two links, 30deg": ("two links", 0.0, pi / 6, 0.6),
}
SHARES = {"torque": 0.7, "speed": 0.9, "acceleration": 0.6, "jerk": 0.6, "deflection": 0.85}
"""Limits as shares of what the plan without limits reaches, so that each has to give way."""
OF_TWO_LINKS = {**SHARES, "torque": 0.99, "speed": 0.97, "deflection": 0.95}
"""Less room: with these shares there is a plan of six terms."""


def follow(plan):
    """Return what samples every quantity between two times, by DOP853."""
    task, modes = plan.task, plan.task.plant.modes
    t, x = ca.SX.sym("t"), ca.SX.sym("x", 2 * modes)
    W, dW = ca.vertsplit(x)[:modes], ca.vertsplit(x)[modes:]
    move = [ca.SX(value) for value in task.move]
    coefficients = [ca.SX(value) for value in plan.coefficients]
    joint = plan.profile.motion(coefficients, t / task.duration, *move, jerk=True)
    ddW = task.plant.modal_accelerations(joint, W, dW)
    rates = ca.Function("rates", [t, x], [ca.vertcat(*dW, *ddW)])
    sample = sample_plant(task.plant, joint, W, dW, ddW)
    rows = {name: ca.vertcat(*q.values(sample)) for name, q in QUANTITIES.items()}
    values = ca.Function("values", [t, x], list(rows.values()))
    run = solve_ivp(
        lambda at, state: rates(at, state).full()[:, 0], (0.0, task.duration),
        np.zeros(2 * modes), "DOP853", rtol=1e-11, atol=1e-14, dense_output=True,
        max_step=task.duration / 100,
    )  # fmt: skip

    def sampled(begin, end):
        times = np.linspace(begin, end, 4001)
        found = values.map(len(times))(ca.DM(times).T, ca.DM(run.sol(times)))
        return times, {name: row.full() for name, row in zip(rows, found, strict=True)}

    return sampled


def densely(plan):
    """Largest absolute value of every quantity, by samples beside the largest."""
    sampled = follow(plan)
    times, coarse = sampled(0.0, plan.task.duration)
    peaks = {}
    for name, row in coarse.items():
        k = int(np.abs(row).max(axis=0).argmax())
        finer = sampled(times[max(k - 1, 0)], times[min(k + 1, 4000)])[1]
        peaks[name] = np.abs(finer[name]).max()
    return peaks


CASES = [
    *(("two links, 30deg", quantity) for quantity in SHARES),
    *(("single link, back", quantity) for quantity in ("torque", "acceleration")),
    ("arm, 135deg", "jerk"),
]


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(("move", "quantity"), CASES)
def test_a_limit_is_kept_and_its_peak_told(plants, solved, move, quantity):
    plant, start, target, duration = MOVES[move]
    free = solved(PointToPoint(plants[plant], target, duration, start), starts=1)
    share = (OF_TWO_LINKS if plant == "two links" else SHARES)[quantity]
    limit = share * free.motion.peak(quantity)
    task = PointToPoint(
        plants[plant], target, duration, start, **{QUANTITIES[quantity].limit: limit}
    )
    plan = plan_move(task, CycloidPolynomial(6), starts=1)
    assert plan.residual < 1e-7
    assert plan.energy > free.energy
    peaks = densely(plan)
    assert peaks[quantity] <= limit
    for name, peak in peaks.items():  # the README's tolerance
        assert plan.motion.peak(name) == pytest.approx(peak, rel=1e-8)


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(("start", "target"), [(-pi / 2, pi / 4), (pi / 4, -pi / 2)])
def test_bounds_of_one_direction_and_of_the_speed_hold(plants, start, target):
    forward = np.sign(target - start)
    task = PointToPoint(
        plants["arm"], target, 1.0, start, acceleration_limit=sorted(forward * np.array([-40, 20])),
        torque_speed=[(0.4, 0.0), (0.3, 2.0), (0.05, 4.0)],
    )  # fmt: skip
    plan = plan_move(task, CycloidPolynomial(10), starts=1)
    assert plan.residual < 1e-7
    (found,) = follow(plan)(0.0, 1.0)[1:]
    acceleration = forward * found["acceleration"]
    assert acceleration.min() >= -40 * (1 + 1e-8)
    assert 19.9 < acceleration.max() <= 20 * (1 + 1e-8)
    torque, speed = np.abs(found["torque"]), np.abs(found["speed"])
    room = np.minimum(0.4 - 0.05 * speed, 0.55 - 0.125 * speed) - torque
    assert -1e-8 <= room.min() < 0.01
    ends = found["acceleration"].min(), found["acceleration"].max()
    assert plan.figures.range_of(QUANTITIES["acceleration"]) == pytest.approx(ends, rel=1e-5)
