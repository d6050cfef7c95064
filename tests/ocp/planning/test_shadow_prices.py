"""Shadow prices: the slopes of the least energy, carried by plans and fronts."""

from math import pi

import casadi as ca
import pytest

import quietarm as qa
from quietarm.ocp import symbolic_rollout

TASK = qa.PointToPoint(qa.SingleLinkManipulator(), target=pi / 6, duration=0.8, torque_limit=0.14)


def test_the_price_of_the_residual_is_the_slope_of_the_least_energy(tmp_path):
    below, plan, above = (
        qa.plan_move(TASK, residual_limit=limit, bound=0.2, starts=1)
        for limit in (9e-3, 10e-3, 11e-3)
    )
    slope = (below.energy - above.energy) / 2e-3  # J/m
    assert plan.shadow_prices["residual"] == pytest.approx(slope, rel=0.02)
    plan.save(tmp_path / "plan.json")
    assert qa.Plan.load(tmp_path / "plan.json").shadow_prices == plan.shadow_prices


@pytest.mark.slow
def test_a_notebook_shows_plans_and_fronts_as_tables():
    plan = qa.plan_move(TASK, starts=1)
    shown = plan._repr_html_()
    assert f"<td>{plan.energy:.5g} J</td>" in shown
    assert "<td>at rest</td>" in shown  # at rest
    front = qa.epsilon_front(TASK, bound=0.2, points=3)
    assert front._repr_html_().count("<tr>") == 1 + len(front.points)
    assert all("residual" in point.shadow_prices for point in front.points[:-1])


@pytest.mark.parametrize("symbols", [ca.SX, ca.MX])
def test_a_rollout_takes_a_column_of_symbols_and_gives_weights(symbols):
    """The weighted powers add up to the net work that CVODES finds."""
    a = symbols.sym("a", 6)
    found = symbolic_rollout(TASK.plant, qa.CycloidPolynomial(6), a, TASK.move, steps=60)
    pairs = zip(found.weights, found.power, strict=True)
    work = ca.Function("work", [a], [sum(ca.dot(*pair) for pair in pairs)])
    plan = qa.evaluate_coefficients(TASK, [0.02, -0.1, 0.01, 0.1, 0.05, -0.5])
    assert float(work(plan.coefficients)) == pytest.approx(plan.motion.net_work, rel=1e-5)
