"""Two ways through the same program: sequential quadratic programs, and IPOPT."""

from dataclasses import replace

import numpy as np
import pytest
from quietarm.ocp.solvers.program import Program
from quietarm.ocp.solvers.solution import RESIDUAL, Scalarization
from quietarm.ocp.solvers.solving import SOLVERS, Row, solve

import quietarm as qa

TERMS = 6
PROFILE = qa.CycloidPolynomial(TERMS)
AT_REST = {RESIDUAL: 0.0}
LIMITED = Scalarization({RESIDUAL: 2e-3})


def _solved(program, ask, solver="sqp", start=PROFILE.plain, **settings):
    (found,), complete = solve([Row(program, ask, np.array(start))], solver, **settings)
    assert complete
    return found


@pytest.fixture(scope="module")
def link_and_arm(tasks, program):
    """Both programs with the box of the paper, and those with a limit of the torque."""
    made = {"single link": 0.2, "arm": 0.5}
    limited = {name: replace(tasks[name], torque_limit=1.0) for name in made}
    return {name: (program(tasks[name]), program(limited[name]), box) for name, box in made.items()}


@pytest.mark.parametrize("name", ["single link", "arm"])
@pytest.mark.parametrize("what", ["rest", "residual", "box", "torque", "peak"])
def test_both_solvers_agree(link_and_arm, name, what):
    free, limited, box = link_and_arm[name]
    torque = _solved(limited, Scalarization(AT_REST)).peaks["torque"]
    program, ask = {
        "rest": (free, Scalarization(AT_REST)),
        "residual": (free, LIMITED),
        "box": (free, Scalarization(AT_REST, box)),
        "torque": (limited, Scalarization({**AT_REST, "torque": 0.9 * torque})),
        "peak": (limited, Scalarization(AT_REST, None, {"torque": 1.0})),
    }[what]
    sqp, ipopt = (_solved(program, ask, solver) for solver in SOLVERS)
    assert sqp.status is ipopt.status is qa.SolveStatus.OPTIMAL
    if what == "peak":  # of several motions of the same peak, hardly of the same energy
        assert ipopt.peaks["torque"] == pytest.approx(sqp.peaks["torque"], rel=1e-6)
        assert sqp.peaks["torque"] < torque
    else:
        assert ipopt.energy == pytest.approx(sqp.energy, rel=1e-6)
    for found in (sqp, ipopt):
        assert np.abs(found.coefficients).max() <= (ask.bound or np.inf)
        for quantity, limit in ask.limits.items():
            assert found.peaks[quantity] <= limit * (1 + 1e-6)
    for quantity, price in sqp.prices.items():
        assert ipopt.prices[quantity] == pytest.approx(price, rel=1e-3)


def test_both_solvers_meet_limits_on_every_plant(tasks):
    uncertainty = qa.Uncertainty({"frequency": 0.05})
    task = replace(tasks["arm"], uncertainty=uncertainty, deflection_limit=1.0)
    program, limits = Program(task, PROFILE, 48), {RESIDUAL: 5e-3}
    free = _solved(program, Scalarization(limits))
    limits["deflection"] = 0.95 * free.peaks["deflection"]
    found = [_solved(program, Scalarization(limits), solver) for solver in SOLVERS]
    for one in found:
        assert one.status.solved
        assert one.arrival.shape == (3, 2)
        for quantity, limit in limits.items():
            assert one.peaks[quantity] <= limit * (1 + 1e-6)
    assert found[1].energy == pytest.approx(found[0].energy, rel=1e-5)
    assert found[0].energy > free.energy


@pytest.mark.parametrize("name", ["single link", "arm"])
@pytest.mark.parametrize("quantity", [RESIDUAL, "torque"])
def test_the_price_of_a_limit_is_what_a_wider_one_saves(link_and_arm, name, quantity):
    limited = link_and_arm[name][1]
    of_torque = 0.9 * _solved(limited, Scalarization(AT_REST)).peaks["torque"]
    limits = {RESIDUAL: 2e-3} if quantity == RESIDUAL else {**AT_REST, "torque": of_torque}
    step = 0.005 * limits[quantity]
    there = _solved(limited, Scalarization(limits))
    beyond = _solved(limited, Scalarization({**limits, quantity: limits[quantity] + step}))
    price = (there.energy - beyond.energy) / step
    assert there.prices[quantity] == pytest.approx(price, rel=0.05)
    if quantity == RESIDUAL:
        assert there.slope == -there.prices[RESIDUAL] < 0


def test_rows_of_many_kinds_are_solved_as_alone(link_and_arm):
    free, limited, box = link_and_arm["arm"]
    asks = [
        (free, Scalarization(AT_REST)),
        (limited, Scalarization({**AT_REST, "torque": 0.33})),
        (free, LIMITED),
        (free, Scalarization(AT_REST, box)),
        (limited, Scalarization(AT_REST, None, {"torque": 1.0})),
        (free, Scalarization({RESIDUAL: 5e-3}, box)),
    ]
    together = solve([Row(*one, PROFILE.plain) for one in asks]).solutions
    for one, found in zip(asks, together, strict=True):
        alone = _solved(*one)
        assert found.status is alone.status
        assert found.energy == pytest.approx(alone.energy, rel=1e-9)
