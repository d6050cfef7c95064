"""Tasks that cannot be met: a clear error, and a remedy that is feasible when asked for."""

import math
import re

import numpy as np
import pytest
from fixed_steps import rollout

import quietarm as qa

# Name, terms, task's limits, settings of the solve.
CASES = {
    "one term, single link": ("single link", 1, {}, {}),
    "one term, arm": ("arm", 1, {}, {}),
    "torque, arm": ("arm", 6, {"torque_limit": 0.05}, {"starts": 1}),
    "torque, in the box": ("single link", 6, {"torque_limit": 0.05}, {"bound": 0.2, "starts": 1}),
    "acceleration": ("arm", 4, {"acceleration_limit": 2.0}, {"starts": 1}),
    "jerk": ("arm", 6, {"jerk_limit": 100.0}, {"starts": 1}),
    "torque and speed": ("arm", 4, {"torque_limit": 0.05, "speed_limit": 20.0}, {"starts": 1}),
}
ALLOWED = 1e-3
"""Share of a limit by which a verified peak may pass it, if there is no room (`OVERRUN`)."""
QUOTED = re.compile(
    r"(residual|torque|speed|acceleration|jerk|deflection) limit (\S+) (?:N m|rad|m)"
)


@pytest.fixture(scope="module")
def refused(tasks):
    """The text of a case's error, solved once."""
    texts = {}

    def of(case):
        if case not in texts:
            name, terms, limits, settings = CASES[case]
            task = qa.PointToPoint(
                tasks[name].plant, tasks[name].target, tasks[name].duration, **limits
            )
            with pytest.raises(qa.InfeasibleTaskError) as error:
                qa.plan_move(task, qa.CycloidPolynomial(terms), **settings)
            texts[case] = str(error.value)
        return texts[case]

    return of


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("case", CASES)
def test_what_the_error_offers_is_feasible(refused, tasks, case):
    name, terms, limits, settings = CASES[case]
    offers = QUOTED.findall(refused(case).split("feasible with all else unchanged")[1])
    assert offers
    for quantity, text in offers:
        value = float(text)
        if quantity == "residual":
            relaxed, asked = limits, {**settings, "residual_limit": value}
        else:
            relaxed, asked = {**limits, f"{quantity}_limit": value}, settings
        task = qa.PointToPoint(
            tasks[name].plant, tasks[name].target, tasks[name].duration, **relaxed
        )
        plan = qa.plan_move(task, qa.CycloidPolynomial(terms), **asked)
        assert plan.motion.peak(quantity) <= value * (1 + ALLOWED)
        assert not plan.motion.exceeded(task.limits, ALLOWED)
        if "bound" in settings:
            assert np.abs(plan.coefficients).max() <= settings["bound"] * (1 + 1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["single link", "arm"])
def test_the_residual_offered_for_one_term_is_the_least_there_is(refused, tasks, name):
    # Coefficients from -2 to 2 in turn, then twice around the best; the error leaves a room of
    # 0.1 %.
    task, profile = tasks[name], qa.CycloidPolynomial(1)

    def least(coefficients):
        return min((rollout(task, profile, [a]).motion.residual, a) for a in coefficients)

    ((_, text),) = QUOTED.findall(refused(f"one term, {name}").split("with all else unchanged")[1])
    _, best = least(np.linspace(-2.0, 2.0, 81))
    for step in (0.05, 0.0025):
        scan, best = least(best + np.linspace(-step, step, 41))
    assert scan * 0.9999 <= float(text) <= scan * 1.002


def test_an_overdamped_plant_is_brought_to_rest_from_its_motion_of_least_residual():
    # The plain cycloid and random starts lead nowhere; 1e-8 m counts as at rest (docs/accuracy.md).
    plant = qa.SingleLinkManipulator(zeta=5.0)
    task = qa.PointToPoint(plant, math.pi / 6, 0.8)
    plan = qa.plan_move(task, qa.CycloidPolynomial(3), starts=1)
    assert plan.residual < 1e-8
