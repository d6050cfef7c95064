"""Candidates in rows: their figures against the rollout, and the sharp energy's curvature."""

import math
from dataclasses import replace

import numpy as np
import pytest
from fixed_steps import rollout

import quietarm as qa
from quietarm.ocp import ModalState, perturb_plant
from quietarm.ocp.limits import QUANTITIES as BY_NAME
from quietarm.ocp.simulation.evaluator import simulate
from quietarm.ocp.simulation.rollout import Simulation
from quietarm.ocp.solvers.batch import MotionMultipliers, batch_of

QUANTITIES = tuple(BY_NAME.values())
LIMITS = tuple(one.limit for one in QUANTITIES)
MOVES = np.array([[0.0, math.pi / 2, 0.8], [-0.4, 1.1, 0.7], [0.3, -1.0, 1.0]])
ERRORS = {"frequency": 0.1, "damping": -0.3}


def _candidates(rows, simulation, seed=0):
    """Coefficients, moves that begin in a ringing state and errors, others in every row."""
    random = np.random.default_rng(seed)
    shape = rows, simulation.profile.size
    coefficients = simulation.profile.plain + random.uniform(-0.3, 0.3, shape)
    moves = MOVES[np.arange(rows) % len(MOVES)] * random.uniform(0.9, 1.1, (rows, 1))
    errors = random.uniform(-0.1, 0.1, (rows, len(simulation.errors)))
    ringing = random.uniform(-0.02, 0.02, (rows, 2 * simulation.plant.modes))
    return coefficients, np.hstack([moves, ringing]), errors


def _weights(made, rows, energy=1.0, seed=1):
    random = np.random.default_rng(seed)
    return MotionMultipliers(
        np.full(rows, energy),
        random.normal(size=(rows, 2 * made.simulation.plant.modes)),
        random.normal(size=(rows, made.limited)),
    )


def _derivatives(made, candidates, width=0.0, weights=None):
    rows = len(candidates[0])
    weights = _weights(made, rows) if weights is None else weights
    return made.derivatives(*candidates, np.full(rows, width), weights)


@pytest.mark.slow_after(4)
@pytest.mark.parametrize("errors", [{}, ERRORS], ids=["as assumed", "with errors"])
def test_figures_are_those_of_the_rollout(task, errors):
    profile, steps = qa.CycloidPolynomial(4), 40
    ringing = ModalState(*np.reshape([0.01, -0.1, 0.02, 0.05][: 2 * task.plant.modes], (2, -1)))
    task = replace(task, start=-0.2, initial=ringing, **dict.fromkeys(LIMITS, 1.0))
    made = batch_of(Simulation(task.plant, profile, steps, QUANTITIES, tuple(errors)))
    a = _candidates(1, made.simulation)[0]
    inputs = a, np.array([task.row]), np.array([list(errors.values())])
    wrong = replace(task, plant=perturb_plant(task.plant, errors))
    expected = rollout(wrong, profile, a[0], steps=steps)
    for found in (simulate(made.simulation, *inputs), _derivatives(made, inputs)):
        assert found.arrival[0] == pytest.approx(np.array(expected.arrival), rel=1e-8, abs=1e-12)
        for name, part in made.places.items():
            peak = np.abs(found.limited[0, part]).max()
            assert peak == pytest.approx(expected.motion.peak(name), rel=1e-8)
    energy = expected.motion.energy
    assert simulate(made.simulation, *inputs).energy[0] == pytest.approx(energy, rel=1e-9)
    # Without what neighbouring steps tell, of fourth order in their length: up to 25/steps^4.
    assert _derivatives(made, inputs).energy[0] == pytest.approx(energy, rel=25 / steps**4)


@pytest.mark.parametrize(("rows", "threads"), [(3, 1), (20, 2)])
def test_rows_are_independent_of_how_many_there_are(plants, rows, threads):
    profile = qa.CycloidPolynomial(4)
    made = batch_of(Simulation(plants["arm"], profile, 12, (BY_NAME["torque"],), ("frequency",)))
    candidates = _candidates(rows, made.simulation)
    weights = _weights(made, rows)
    together = _derivatives(made, candidates, 0.1, weights)
    valued = simulate(made.simulation, *candidates, threads=threads)
    for row in {0, rows // 2, rows - 1}:
        only = slice(row, row + 1)
        alone = [one[only] for one in candidates]
        own = MotionMultipliers(**{name: one[only] for name, one in vars(weights).items()})
        expected = _derivatives(made, alone, 0.1, own)
        for name, part in vars(together).items():
            whole = vars(expected)[name][0]
            size = np.abs(whole).max()
            assert part[row] == pytest.approx(whole, rel=1e-10, abs=1e-12 * size), name
        for name, part in vars(simulate(made.simulation, *alone)).items():
            assert vars(valued)[name][row] == pytest.approx(part[0], rel=1e-10, abs=1e-13)


@pytest.mark.parametrize("name", ["arm", "two links"])
def test_the_sharp_energys_curvature_counts_zeros_of_the_power_that_move(plants, name):
    made = batch_of(Simulation(plants[name], qa.CycloidPolynomial(3), 30))
    candidates = _candidates(2, made.simulation, seed=5)
    none = np.zeros((2, 2 * made.simulation.plant.modes))
    weights = MotionMultipliers(np.ones(2), none, np.zeros((2, 0)))
    found = _derivatives(made, candidates, 0.0, weights).hessian
    (a, *others), h = candidates, 1e-6
    expected = np.stack([
        sum(weight * _derivatives(made, (a + away * h * e, *others), 0.0, weights).gradient
            for away, weight in ((-2, 1), (-1, -8), (1, 8), (2, -1))) / (12 * h)
        for e in np.eye(a.shape[1])
    ], axis=-1)  # fmt: skip
    assert found == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("limits", [("torque",), ("torque", "deflection")])
def test_scenarios_are_rows_whose_arrivals_alone_count_where_no_limit_needs_more(limits):
    """As all rows with all derivatives: two candidates in three scenarios, the first assumed."""
    plant, profile = qa.ArmOnFlexibleLink(), qa.CycloidPolynomial(4)
    quantities = tuple(BY_NAME[name] for name in limits)
    made = batch_of(Simulation(plant, profile, 24, quantities, tuple(ERRORS)))
    coefficients, moves, _ = _candidates(2, made.simulation)
    errors = np.random.default_rng(2).uniform(-0.1, 0.1, (2, 3, len(ERRORS)))
    errors[:, 0] = 0.0
    weights = _weights(made, 6)
    weights.energy[[1, 2, 4, 5]] = 0.0
    weights.limited[[1, 2, 4, 5]] = 0.0
    rows = (np.repeat(table, 3, axis=0) for table in (coefficients, moves))
    expected = made.derivatives(*rows, np.concatenate(errors), np.full(6, 0.1), weights)
    by_scenario = MotionMultipliers(
        **{name: part.reshape(2, 3, *part.shape[1:]) for name, part in vars(weights).items()}
    )
    found = made.in_scenarios(coefficients, moves, errors, np.full(2, 0.1), by_scenario)
    for name, part in vars(expected.by_scenario(3)).items():
        value = getattr(found, name)
        assert value == pytest.approx(part[:, : value.shape[1]], rel=1e-9, abs=1e-9), name
    assert found.energy.shape[1] == (3 if "deflection" in limits else 1)
