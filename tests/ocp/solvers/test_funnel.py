"""The sequential quadratic programs on small problems whose answers are known in closed form.

"HS" are problems of Hock and Schittkowski, Test Examples for Nonlinear Programming Codes (1981),
with their published minima.
"""

from functools import partial
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from quietarm.ocp.solvers.funnel import SHARP, Course, End, minimise
from quietarm.ocp.solvers.quadratic import Model
from quietarm.ocp.solvers.sqp import Sqp

INF = np.inf


class Problem:
    """min f(x) with c(x) = 0 and lower <= v(x) <= upper, by casadi's derivatives, in rows."""

    def __init__(self, n, f, c=(), v=(), lower=(), upper=()):
        self.lower, self.upper, self.calls = np.array(lower), np.array(upper), []
        x = ca.SX.sym("x", n)
        entries = ca.vertsplit(x)
        f, c, v = (
            f(*entries),
            *(ca.vertcat(ca.SX(0, 1), *(g(*entries) for g in of)) for of in (c, v)),
        )
        of_c, of_v = ca.SX.sym("of_c", c.numel()), ca.SX.sym("of_v", v.numel())
        second = ca.hessian(f + ca.dot(of_c, c) + ca.dot(of_v, v), x)[0]
        results = [f, ca.gradient(f, x), c, ca.jacobian(c, x), v, ca.jacobian(v, x), second]
        self.function = ca.Function("p", [x, of_c, of_v], [ca.densify(one) for one in results])

    def evaluate(self, rows, x, multipliers, width):
        self.calls.append(rows.tolist())
        found = [
            [part.full() for part in self.function(*one)]
            for one in zip(x, *multipliers, strict=True)
        ]
        f, gradient, c, by_c, v, by_v, second = (
            np.array(part) for part in zip(*found, strict=True)
        )
        return Model(f[:, 0, 0], gradient[..., 0], c[..., 0], by_c, v[..., 0], by_v, second)

    def solved(self, starts, **settings):
        starts = np.atleast_2d(np.array(starts, dtype=float))
        course = Course(Sqp(), settings.pop("widths", SHARP), settings.pop("reach", 0.25))
        programs = SimpleNamespace(
            evaluate=self.evaluate,
            equalities=self.function.size1_in(1),
            linear=settings.pop("linear", 0),
            lower=np.tile(self.lower, (len(starts), 1)),
            upper=np.tile(self.upper, (len(starts), 1)),
        )
        return minimise(programs, starts, course, **settings)

    def objective(self, found):
        rows = np.arange(len(found.x))
        return self.evaluate(rows, found.x, found.multipliers, np.zeros(len(rows))).objective


def _rosenbrock(x, y):
    return 100 * (y - x**2) ** 2 + (1 - x) ** 2


# Problem, start, where the minimum is, its f.
KNOWN = {
"HS 7": (
        partial(
            Problem, 2, lambda x, y: ca.log(1 + x**2) - y, [lambda x, y: (1 + x**2) ** 2 + y**2 - 4]
        ),
        [2, 2], [0, np.sqrt(3)], -np.sqrt(3),
    ),
"HS 71": (
        partial(
            Problem, 4, lambda x, y, z, w: x * w * (x + y + z) + z,
            [lambda x, y, z, w: x**2 + y**2 + z**2 + w**2 - 40],
            [lambda x, y, z, w: x * y * z * w, *(lambda *x, i=i: x[i] for i in range(4))],
            [25, 1, 1, 1, 1], [INF, 5, 5, 5, 5],
        ),
        [1, 5, 5, 1], [1, 4.7429994, 3.8211503, 1.3794082], 17.0140173,
    ),
"linear on a disc": (
        partial(
            Problem, 2, lambda x, y: -3 * x - 4 * y, [], [lambda x, y: x**2 + y**2], [-INF], [1]
        ),
        [0, 0], [0.6, 0.8], -5.0,
    )
}  # fmt: skip


@pytest.fixture(params=KNOWN)
def known(request):
    return KNOWN[request.param]


def test_it_finds_the_published_minimum(known):
    make, start, at, f = known
    problem = make()
    found = problem.solved(start, reach=1.0)
    assert found.ends == [End.SOLVED]
    assert problem.objective(found)[0] == pytest.approx(f, abs=1e-7)
    assert found.violation[0] < 1e-9
    assert found.x[0] == pytest.approx(np.array(at), abs=1e-4)


def test_multipliers_satisfy_stationarity(known):
    make, start, *_ = known
    problem = make()
    found = problem.solved(start, reach=1.0)
    at = problem.evaluate(np.zeros(1, dtype=int), found.x, found.multipliers, np.zeros(1))
    equality, bounded = (part[0] for part in found.multipliers)
    lagrangian = at.gradient[0] + at.equality_jacobian[0].T @ equality
    lagrangian = lagrangian + at.bounded_jacobian[0].T @ bounded
    size = 1 + np.abs(at.gradient).max()
    assert lagrangian == pytest.approx(np.zeros(len(start)), abs=1e-4 * size)
    # Positive at an upper bound, negative at a lower one, none away from both.
    above, below = problem.upper - at.bounded[0], at.bounded[0] - problem.lower
    assert (bounded[above > 1e-4] <= 1e-9).all()
    assert (bounded[below > 1e-4] >= -1e-9).all()


def test_a_step_that_only_restores_feasibility_is_not_the_last():
    # One step meets y = 2, which costs f more than the step gains along x: it is not done then.
    problem = Problem(2, lambda x, y: ca.exp(x) - 2 * x + 10 * y + 50, [lambda x, y: y - 2])
    found = problem.solved([3.0, 0.0], reach=1.0)
    assert found.ends == [End.SOLVED]
    assert found.x[0] == pytest.approx(np.array([np.log(2), 2.0]), abs=1e-4)


def test_what_cannot_be_met_ends_at_the_least_largest_violation():
    # x^2 + y^2 <= 1 and x >= 3: at (x, 0) both are missed alike where x^2 - 1 = 3 - x.
    problem = Problem(
        2, lambda x, y: x + y, [], [lambda x, y: x**2 + y**2, lambda x, y: x], [-INF, 3], [1, INF]
    )
    found = problem.solved([0.5, 1.0])
    x = (np.sqrt(17) - 1) / 2
    assert found.ends == [End.INFEASIBLE]
    assert found.violation[0] == pytest.approx(3 - x, abs=1e-5)
    assert found.x[0] == pytest.approx(np.array([x, 0.0]), abs=1e-2)


def test_rows_end_independently():
    make, *_ = KNOWN["HS 7"]
    problem, starts = make(), [[2.0, 2.0], [0.0, 1.7], [-1.5, 0.5]]
    together = problem.solved(starts)
    assert together.ends == [End.SOLVED] * 3
    assert len(set(together.iterations)) > 1
    assert len(problem.calls[-1]) < 3  # those that have ended are not evaluated
    for row, start in enumerate(starts):
        alone = make().solved(start)
        assert alone.x[0] == pytest.approx(together.x[row], abs=1e-12)
        assert alone.iterations[0] == together.iterations[row]


def _above_zero(x, y):
    return 1 + _rosenbrock(x, y)


def test_rows_of_a_group_are_left_once_half_of_them_agree():
    starts, of_one = [[1.1, 1.2], [0.95, 0.9], [-1.2, 1.0], [-1.9, 2.0]], np.zeros(4, dtype=int)
    problem = Problem(2, _above_zero)
    alone = problem.solved(starts)
    assert alone.ends == [End.SOLVED] * 4
    grouped = problem.solved(starts, groups=of_one)
    assert grouped.ends == [End.SOLVED, End.SOLVED, End.AGREED, End.AGREED]
    first, second = problem.objective(alone), problem.objective(grouped)
    assert second[:2] == pytest.approx(first[:2], rel=1e-9)
    # Rows of other groups are other programs, however alike.
    apart = Problem(2, _above_zero).solved(starts, groups=np.arange(4))
    assert apart.ends == alone.ends
