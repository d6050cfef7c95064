"""Every derivative of the fast solver against CasADi's own, of the same symbolic rollout."""

import casadi as ca
import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp import CycloidGaussians, CycloidNetwork, perturb_plant
from quietarm.ocp.energy import ABSOLUTE_POWER, CopperLoss, PositivePower
from quietarm.ocp.limits import QUANTITIES, Limit, TorqueSpeedLine
from quietarm.ocp.simulation.objective import integrated, resolved_energy
from quietarm.ocp.simulation.rollout import Simulation, symbolic_rollout
from quietarm.ocp.solvers.batch import MotionMultipliers, batch_of

STEPS = 10
LINE = Limit.of_line(TorqueSpeedLine(((1.5, 0.0), (1.2, 2.0), (0.2, 4.0))))
MOVE = [0.1, 1.3, 0.8]
PROFILES = {
    "polynomial": qa.CycloidPolynomial(4),
    "spline": qa.CycloidSpline(5),
    "gaussians": CycloidGaussians(2),
    "network": CycloidNetwork(2),
}
ENERGIES = {"absolute": ABSOLUTE_POWER, "mixed": 0.5 * PositivePower() + CopperLoss(0.3)}
CASES = [
    ("single link", "polynomial", "absolute", ()),
    ("arm", "polynomial", "mixed", ("frequency", "damping")),
    ("arm", "gaussians", "absolute", ()),
    ("arm", "spline", "mixed", ("omega",)),
    ("two links", "network", "absolute", ("frequency",)),
    ("two links", "polynomial", "absolute", ()),
]
ERRORS = [0.08, -0.2]


@pytest.fixture(params=CASES, ids=lambda case: f"{case[0]} {case[1]} {case[2]} {case[3]}")
def case(request, plants):
    """A batch, and energy, arrival and limited quantities as CasADi differentiates them.

    The plant has errors and is ringing when the move begins.
    """
    plant, profile, energy, names = request.param
    plant, profile, energy = plants[plant], PROFILES[profile], ENERGIES[energy]
    quantities = (*QUANTITIES.values(), LINE.quantity)
    made = batch_of(Simulation(plant, profile, STEPS, quantities, names, energy))
    plant = perturb_plant(plant, dict(zip(names, ERRORS, strict=False)))
    a, width = ca.MX.sym("a", profile.size), ca.MX.sym("width")
    rollout = symbolic_rollout(
        plant, profile, a, MOVE, STEPS, jerk=True, initial=_ringing(plant.modes)
    )
    smooth = integrated(
        [energy.smooth(node.torques[0], node.path.speed) for node in rollout.samples], rollout.h
    )
    rounded = integrated([ca.sqrt(p * p + width**2) for p in rollout.power], rollout.h)
    # the fast solver's steps do not ask their neighbours
    sharp = resolved_energy(rollout.power, rollout.h)
    values = ca.veccat(*(
        ca.MX.zeros(1, STEPS) + quantity.values(node)[i]
        for quantity in quantities
        for i in range(quantity.rows(plants[request.param[0]]))
        for node in rollout.samples
    ))  # fmt: skip
    symbols = {
        "a": a,
        "width": width,
        "sharp": energy.absolute * sharp + smooth,
        "rounded": energy.absolute * rounded + smooth,
        "arrival": rollout.arrival.T,
        "limited": values,
    }
    return made, symbols


def _ringing(modes):
    return [0.01, -0.02, 0.1, 0.2][: 2 * modes]


@pytest.fixture
def candidate(case):
    made, _ = case
    random = np.random.default_rng(0)
    return made.simulation.profile.plain + random.uniform(-0.3, 0.3, made.simulation.profile.size)


def _found(made, candidate, width, multipliers=None):
    move = np.array([[*MOVE, *_ringing(made.simulation.plant.modes)]])
    errors = np.array([ERRORS[: len(made.simulation.errors)]])
    return made.derivatives(candidate[None], move, errors, np.array([width]), multipliers)


def _expected(symbols, expressions, candidate, width):
    function = ca.Function("expected", [symbols["a"], symbols["width"]], expressions)
    return [part.full() for part in function.call([candidate, width])]


@pytest.mark.slow_after(4)
@pytest.mark.parametrize(("name", "width"), [("sharp", 0.0), ("rounded", 0.3)])
def test_values_and_first_derivatives(case, candidate, name, width):
    made, symbols = case
    found, a = _found(made, candidate, width), symbols["a"]
    outputs = [symbols[name], symbols["arrival"], symbols["limited"]]
    expected = _expected(
        symbols, [*outputs, *(ca.jacobian(one, a) for one in outputs)], candidate, width
    )
    energy, arrival, limited, gradient, arrival_jacobian, limited_jacobian = expected
    for one, other in (
        (found.energy, energy),
        (found.arrival, arrival),
        (found.limited, limited),
        (found.gradient, gradient),
        (found.arrival_jacobian, arrival_jacobian),
        (found.limited_jacobian, limited_jacobian),
    ):
        scale = np.abs(other).max()
        assert one.ravel() == pytest.approx(other.ravel(), rel=1e-9, abs=1e-10 * scale)


@pytest.mark.parametrize(("share", "width"), [(1.0, 0.3), (0.0, 0.0)])
def test_the_hessian_of_the_lagrangian(case, candidate, share, width):
    # Rounded off: of the sharp energy CasADi's second derivatives have no bound where zeros meet.
    made, symbols = case
    random, a = np.random.default_rng(3), symbols["a"]
    weights = {name: random.normal(size=symbols[name].numel()) for name in ("arrival", "limited")}
    multipliers = MotionMultipliers(
        np.full(1, share), weights["arrival"][None], weights["limited"][None]
    )
    lagrangian = share * symbols["rounded"] + sum(
        ca.dot(ca.DM(weight), symbols[name]) for name, weight in weights.items()
    )
    (expected,) = _expected(symbols, [ca.hessian(lagrangian, a)[0]], candidate, width)
    found = _found(made, candidate, width, multipliers).hessian[0]
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-9 * np.abs(expected).max())
