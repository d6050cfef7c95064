"""Moves that begin while the structure rings, or arrive in a state that is asked for."""

from dataclasses import replace

import numpy as np
import pytest
from fixed_steps import rollout
from third_opinion import ThirdOpinion

import quietarm as qa
from quietarm.ocp import FreeVibration, ModalState, perturb_plant
from quietarm.ocp.simulation.evaluator import Evaluator

SIX = qa.CycloidPolynomial(6)


@pytest.fixture(params=["single link", "arm", "two links"])
def name(request):
    return request.param


def _back(task):
    """A move back from where another has ended, which begins with what that has left."""
    modes = task.plant.modes
    ringing = ModalState(W=(0.008,) * modes, dW=(-0.06,) * modes)
    return qa.PointToPoint(task.plant, 0.2, 0.8, task.target, initial=ringing)


@pytest.fixture
def ringing(tasks, name):
    return _back(tasks[name])


def _third_opinion(task, name, a):
    return ThirdOpinion(name, list(a), *task.move, task.initial_state)


@pytest.mark.slow_after(2)
def test_a_move_that_begins_ringing_arrives_still_and_scipy_agrees(ringing, name):
    plan = qa.plan_move(ringing, SIX, starts=1)
    still = max(
        1e-8, 1e-7 * qa.JudgedMotion.of_profile(ringing, qa.CycloidPolynomial(0), []).residual
    )
    assert plan.residual < still
    other = _third_opinion(ringing, name, plan.coefficients)
    assert plan.energy == pytest.approx(other.energy, rel=1e-9)
    assert other.residual < 1.01 * still
    # what it takes depends on what rings
    assert plan.energy != pytest.approx(
        qa.plan_move(replace(ringing, initial=None), SIX, starts=1).energy, rel=0.01
    )


def test_searches_see_what_cvodes_does(ringing):
    population = np.random.default_rng(3).uniform(-0.2, 0.2, (5, 6))
    found = Evaluator(ringing, SIX, steps=140)(population)
    figures = zip(population, found.sampled_residual[:, 0], found.energy[:, 0], strict=True)
    for a, residual, energy in figures:
        exact = qa.JudgedMotion.of_profile(ringing, SIX, a).motion
        assert energy == pytest.approx(exact.energy, rel=1e-5)
        assert residual == pytest.approx(exact.residual, rel=3e-4)
        fixed = rollout(ringing, SIX, a)
        assert fixed.motion.energy == pytest.approx(exact.energy, rel=1e-5)
        assert fixed.motion.residual == pytest.approx(exact.residual, rel=3e-4)


def test_errors_of_the_plant_begin_in_the_same_state(ringing):
    profile, a, errors = qa.CycloidPolynomial(3), [0.05, -0.1, 0.02], {"frequency": 0.07}
    candidate = qa.JudgedMotion.of_profile(ringing, profile, a)
    figures = qa.evaluate_robustness(candidate, errors, samples=1).sweeps[0].figures
    wrong = replace(ringing, plant=perturb_plant(ringing.plant, errors))
    exact = qa.JudgedMotion.of_profile(wrong, profile, a).motion
    assert figures.residual[-1] == pytest.approx(exact.residual, rel=1e-4)
    assert figures.energy[-1] == pytest.approx(exact.energy, rel=1e-5)


@pytest.mark.slow
def test_both_solvers_fronts_and_the_floor_begin_in_the_same_state(tasks):
    task = _back(tasks["single link"])
    profile, settings = qa.CycloidPolynomial(4), {"bound": 0.3, "starts": 1}
    plans = [qa.plan_move(task, profile, solver=by, **settings) for by in (qa.Sqp(), qa.Ipopt())]
    assert plans[0].energy == pytest.approx(plans[1].energy, rel=1e-5)
    front = qa.epsilon_front(task, profile, points=3, **settings)
    assert front.points[0].energy == pytest.approx(plans[0].energy, rel=1e-5)
    for point in front.points:
        exact = qa.JudgedMotion.of_profile(task, profile, point.coefficients).motion
        assert point.energy == pytest.approx(exact.energy, rel=1e-6)
        assert point.residual == pytest.approx(exact.residual, rel=1e-6, abs=1e-8)
    floor = qa.energy_floor(replace(task, acceleration_limit=40.0), starts=1, energy_tolerance=0.05)
    limited = qa.plan_move(replace(task, acceleration_limit=40.0), SIX, starts=1)
    assert floor.residual < 1e-6
    assert 0 < floor.energy < limited.energy
    many = qa.plan_moves([task, replace(task, initial=None)], profile, bound=0.3)
    assert many.energy[0] == pytest.approx(plans[0].energy, rel=1e-5)


def _wanted(plant):
    return ModalState(W=(0.004,) * plant.modes, dW=(-0.05,) * plant.modes)


def test_a_wanted_state_is_reached_and_scipy_agrees(tasks, name):
    task = replace(tasks[name], final=_wanted(tasks[name].plant))
    plan = qa.plan_move(task, SIX, starts=1)
    wanted = np.array(task.final_state)
    other = _third_opinion(task, name, plan.coefficients)
    assert other.during.y[:, -1] == pytest.approx(wanted, abs=1e-6)
    assert plan.energy == pytest.approx(other.energy, rel=1e-9)
    # it rings on as from the wanted state: at rest the same motion would count as loud
    assert plan.residual < 1e-6
    assert qa.JudgedMotion.of_profile(tasks[name], SIX, plan.coefficients).residual > 2e-3


def test_the_residual_is_the_distance_from_the_wanted_free_vibration(tasks, name):
    task = replace(tasks[name], final=_wanted(tasks[name].plant))
    a, n = [0.05, -0.1], task.plant.modes
    other = _third_opinion(task, name, a)
    wanted = other._solve(lambda t: (task.target, 0.0, 0.0), 0.0, 1.0, np.array(task.final_state))
    times = np.linspace(0.0, 1.0, 8001)
    apart = other.after.sol(task.duration + times)[:n] - wanted.sol(times)[:n]
    expected = other.phi * np.abs(apart).max()
    profile = qa.CycloidPolynomial(2)
    assert qa.JudgedMotion.of_profile(task, profile, a).residual == pytest.approx(
        expected, rel=3e-6
    )
    assert rollout(task, profile, a).motion.residual == pytest.approx(expected, rel=1e-4)
    found = Evaluator(task, profile, steps=140)([a])
    assert found.sampled_residual == pytest.approx(expected, rel=1e-4)
    assert found.residual == pytest.approx(expected, rel=1e-5)
    vibration = FreeVibration(task.plant, task.target, task.residual_window)
    peak = vibration.peak(task.missed(other.during.y[:, -1]))
    assert peak == pytest.approx(expected, rel=3e-6)


def test_what_rings_adds_to_what_a_move_leaves_on_a_linear_link():
    # Undamped and of constant stiffness, in a time of one period: what rang at the start rings
    # again as it did on arrival, and where that is wanted only what the move adds is left.
    link = qa.SingleLinkManipulator(zeta=0.0, beta2=0.0)
    task, plain = qa.PointToPoint(link, 0.5, 2 * np.pi / link.omega), qa.CycloidPolynomial(0)
    state = ModalState((0.01,), (0.2,))
    own = qa.JudgedMotion.of_profile(task, plain, []).residual
    kept = qa.JudgedMotion.of_profile(replace(task, initial=state, final=state), plain, []).residual
    assert kept == pytest.approx(own, rel=1e-8)


@pytest.mark.slow
def test_a_deflection_held_before_the_move_saves_energy(tasks):
    # As Abe (2024) says: bent back before the start, the structure gives its work to the joint.
    task = replace(tasks["single link"], acceleration_limit=40.0)
    from_rest = qa.plan_move(task).energy
    bent = {W: qa.plan_move(replace(task, initial=ModalState((W,), (0.0,)))).energy
            for W in (-0.02, 0.02)}  # fmt: skip
    assert bent[-0.02] < 0.75 * from_rest < from_rest < bent[0.02]
