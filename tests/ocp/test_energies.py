"""Energies, held against SciPy, closed forms and differences, the same in every answer."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from fixed_steps import rollout
from numpy.polynomial import Polynomial
from scipy.integrate import quad
from third_opinion import ThirdOpinion

import quietarm as qa
from quietarm.models import JointMotion
from quietarm.ocp import Mix, PositivePower
from quietarm.ocp.checks import known
from quietarm.ocp.sample import Sample
from quietarm.ocp.simulation.collocation import GAUSS_NODES
from quietarm.ocp.simulation.objective import spent

SIX = [-0.05, -0.14, 0.04, 0.2, 0.05, -0.3]


@dataclass(frozen=True)
class Recovering(qa.Energy):
    """Positive power, less a share of the braking power; and friction that grows with speed."""

    name = "recovering"
    share: float = 0.0
    drag: float = 0.01

    @property
    def absolute(self):
        return (1 - self.share) / 2

    def smooth(self, torque, speed):
        return (1 + self.share) / 2 * torque * speed + self.drag * speed**4


ENERGIES = {
    "absolute": qa.AbsolutePower(),
    "positive": PositivePower(),
    "copper": qa.CopperLoss(0.12),
    "mixed": 0.5 * PositivePower() + qa.CopperLoss(0.3),
    "own": Recovering(0.6),
}
WATTS = {
    "absolute": lambda torque, speed: abs(torque * speed),
    "positive": lambda torque, speed: max(torque * speed, 0.0),
    "copper": lambda torque, speed: (torque / 0.12) ** 2,
    "mixed": lambda torque, speed: 0.5 * max(torque * speed, 0.0) + (torque / 0.3) ** 2,
    "own": lambda torque, speed: (
        max(torque * speed, 0.0) + 0.6 * min(torque * speed, 0.0) + 0.01 * speed**4
    ),
}
"""What each spends at one time, written out."""


@pytest.fixture(params=ENERGIES)
def name(request):
    return request.param


@pytest.fixture
def task(tasks, name):
    return replace(tasks["single link"], energy=ENERGIES[name])


@pytest.mark.slow_after(4)
@pytest.mark.parametrize("plant", ["single link", "arm", "two links"])
def test_cvodes_and_the_rollout_spend_what_scipy_finds(tasks, name, plant):
    task = replace(tasks[plant], energy=ENERGIES[name])
    opinion = ThirdOpinion(plant, SIX, *task.move)

    def watts(t):
        joint = opinion.joint(t)
        return WATTS[name](float(opinion.torque(joint, opinion.during.sol(t))), float(joint[1]))

    edges = np.linspace(0.0, task.duration, 201)
    spent = sum(quad(watts, *edges[k : k + 2], epsrel=1e-9)[0] for k in range(200))
    profile = qa.CycloidPolynomial(6)
    assert qa.JudgedMotion.of_profile(task, profile, SIX).energy == pytest.approx(spent, rel=1e-7)
    assert rollout(task, profile, SIX).motion.energy == pytest.approx(spent, rel=1e-5)


@pytest.mark.slow
def test_both_solvers_and_the_floor_agree_with_the_plan(task, solved):
    plan, other = solved(task), solved(task, solver=qa.Ipopt())
    assert (plan.verification.agrees, plan.residual < 1e-8) == (True, True)
    assert plan.energy == pytest.approx(other.energy, rel=1e-6)
    plain = qa.evaluate_coefficients(task, []).energy
    floor = qa.energy_floor(task, starts=1, energy_tolerance=0.02)
    assert floor.energy < plan.energy < plain
    assert floor.energy == pytest.approx(floor.levels[-1].energy, rel=1e-3)


def test_a_plan_is_cheapest_by_the_energy_it_was_asked_for(tasks, solved):
    tasks = [replace(tasks["single link"], energy=energy) for energy in ENERGIES.values()]
    spent = np.array([
        [qa.evaluate_coefficients(by, solved(task).coefficients).energy for task in tasks]
        for by in tasks
    ])  # fmt: skip
    assert np.argmin(spent, axis=1).tolist() == list(range(len(tasks)))


def test_copper_loss_of_a_rigid_body():
    # torque = J theta''; the plain cycloid's is a sine: 2 pi^2 (J span / k)^2 / T^3. The least of
    # all motions has a parabola as its speed: 12 in the place of 2 pi^2.
    rigid = qa.SingleLinkManipulator(alpha1=0.02, alpha2=0.0, c=0.0)
    task = qa.PointToPoint(rigid, math.pi / 6, 0.8, energy=qa.CopperLoss(0.12))
    unit = (0.02 * task.span / 0.12) ** 2 / task.duration**3
    motion = qa.JudgedMotion.of_profile(task, qa.CycloidPolynomial(0), []).motion
    assert motion.energy == pytest.approx(2 * math.pi**2 * unit, rel=1e-9)
    # The link still has to arrive at rest, which takes a little more than the parabola.
    assert 12 * unit <= qa.energy_floor(task, starts=1).energy < 2 * math.pi**2 * unit


def test_positive_power_of_a_rigid_body_is_what_it_takes_to_start():
    rigid = qa.SingleLinkManipulator(alpha1=0.02, alpha2=0.0, c=0.0)
    task = qa.PointToPoint(rigid, math.pi / 6, 0.8, energy=PositivePower())
    spent = qa.JudgedMotion.of_profile(task, qa.CycloidPolynomial(0), []).energy
    assert spent == pytest.approx(0.02 * (2 * (math.pi / 6) / 0.8) ** 2 / 2, rel=1e-9)


def test_energies_are_values():
    a, b = qa.AbsolutePower(), qa.CopperLoss(0.12)
    assert known(qa.Energy)["recovering"] is Recovering
    assert 2 * (a + 0.5 * b) == Mix(((2.0, a), (1.0, b)))
    assert (2 * (a + 3 * b)).label == "2*absolute+6*copper:0.12"
    assert hash(a + b) == hash(a + b)
    assert Recovering(0.6).label == "recovering:0.6,0.01"
    for wrong in (lambda: qa.CopperLoss(0.0), lambda: -1 * a):
        with pytest.raises(ValueError, match="give a positive number"):
            wrong()


def _driven(torque, speed):
    """A sample of one joint of which energies read torque and speed."""
    joint = JointMotion(0.0, speed, 0.0)
    nothing = {"W": [], "dW": [], "ddW": [], "tips": []}
    return Sample(path=joint, joints=[joint], torques=[torque], **nothing)


def test_a_smooth_step_is_integrated_exactly_up_to_degree_five():
    # Torque and speed of degree 2 in time: torque^2 has degree 4.
    torque, speed = Polynomial([0.3, -1.0, 2.0]), Polynomial([1.0, 0.5])
    nodes = [_driven(ca.DM(torque(x)), ca.DM(speed(x))) for x in GAUSS_NODES]
    found = spent(qa.CopperLoss(0.5), nodes, ca.DM(1.0))
    assert float(found) == pytest.approx((torque**2).integ()(1.0) / 0.25, rel=1e-12)


WRONG = {
    "less than none": ({"absolute": -1.0}, "absolute of energy 'wrong' is -1; give 0 or more"),
    "no number": ({"absolute": "1"}, "absolute of energy 'wrong' is '1'; give a number"),
    "math": ({"smooth": lambda e, t, v: math.exp(t)}, r"smooth fails .* with casadi\.exp"),
    "two": ({"smooth": lambda e, t, v: (t, v)}, r"smooth fails .*returns one expression"),
    "other arguments": (
        {"smooth": lambda e, t: t},
        r"smooth fails .*write \(self, torque, speed\)",
    ),
    # a sum over the candidates, which was planned
    "mixed": ({"smooth": lambda e, t, v: ca.sum1(t * t)}, "among other candidates and .* alone"),
    "not finite": ({"smooth": lambda e, t, v: ca.log(t)}, "write operations with finite values"),
}


@pytest.mark.parametrize(("members", "told"), WRONG.values(), ids=WRONG)
def test_an_energy_that_is_wrong_is_refused_when_it_is_asked_for(members, told):
    energy = dataclass(frozen=True)(type("Wrong", (qa.Energy,), {"name": "wrong", **members}))()
    with pytest.raises(ValueError, match=told):
        qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 0.8, energy=energy)


PLAN_OF_BEFORE = Path(__file__).parents[1] / "fixtures" / "2.0.0" / "plan.json"


@pytest.mark.usefixtures("what_is_made_up_is_forgotten")
def test_an_energy_with_the_name_of_a_shipped_one_is_refused():
    @dataclass(frozen=True)
    class Mine(qa.Energy):
        name = "copper"

    refusal = "name 'copper' of Mine is that of quietarm's CopperLoss; give Mine another"
    with pytest.raises(ValueError, match=refusal):
        qa.Plan.load(PLAN_OF_BEFORE)
