"""No limit is passed between the samples: ten plans against SciPy's DOP853, sampled densely."""

from math import pi

import casadi as ca
import numpy as np
import pytest
from quietarm.ocp import CycloidPolynomial, PointToPoint, plan_move
from quietarm.ocp.task import QUANTITIES
from scipy.integrate import solve_ivp

MOVES = {
    "single link, back": ("single link", 0.2, -1.0, 0.7),
    "arm, 135deg": ("arm", -pi / 2, pi / 4, 1.0),
    "two links, 30deg": ("two links", 0.0, pi / 6, 0.6),
}
SHARES = {"torque": 0.7, "speed": 0.9, "acceleration": 0.6, "jerk": 0.6, "deflection": 0.85}
"""Limits as shares of what the plan without limits reaches, so that each has to give way."""
OF_TWO_LINKS = {**SHARES, "torque": 0.99, "speed": 0.97, "deflection": 0.95}
"""Less room: with these shares there is a plan of six terms."""


def densely(plan):
    """Largest absolute value of every quantity, by DOP853 and samples beside the largest."""
    task, modes = plan.task, plan.task.plant.modes
    t, x = ca.SX.sym("t"), ca.SX.sym("x", 2 * modes)
    W, dW = ca.vertsplit(x)[:modes], ca.vertsplit(x)[modes:]
    move = [ca.SX(value) for value in task.move]
    coefficients = [ca.SX(value) for value in plan.coefficients]
    joint = plan.profile.motion(coefficients, t / task.duration, *move, jerk=True)
    ddW = task.plant.modal_accelerations(joint, W, dW)
    rates = ca.Function("rates", [t, x], [ca.vertcat(*dW, *ddW)])
    torque, tips = task.plant.torque(joint, W, dW, ddW), task.plant.tip_displacements(W)
    rows = {name: ca.vertcat(*q.of(joint, tips, torque)) for name, q in QUANTITIES.items()}
    values = ca.Function("values", [t, x], list(rows.values()))
    run = solve_ivp(
        lambda at, state: rates(at, state).full()[:, 0], (0.0, task.duration),
        np.zeros(2 * modes), "DOP853", rtol=1e-11, atol=1e-14, dense_output=True,
        max_step=task.duration / 100,
    )  # fmt: skip

    def sampled(begin, end):
        times = np.linspace(begin, end, 4001)
        found = values.map(len(times))(ca.DM(times).T, ca.DM(run.sol(times)))
        return times, [np.abs(row.full()).max(axis=0) for row in found]

    times, coarse = sampled(0.0, task.duration)
    peaks = {}
    for i, (name, row) in enumerate(zip(rows, coarse, strict=True)):
        k = int(row.argmax())
        peaks[name] = sampled(times[max(k - 1, 0)], times[min(k + 1, 4000)])[1][i].max()
    return peaks


CASES = [
    *(("two links, 30deg", quantity) for quantity in SHARES),
    *(("single link, back", quantity) for quantity in ("torque", "acceleration")),
    ("arm, 135deg", "jerk"),
]


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
