"""MOEA/D-DE and MO-CMA-ES on problems whose optima are known, whatever their units."""

import numpy as np
import pytest
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

from quietarm.metaheuristics.algorithms.mo_cma_es import MOCMAES, most_contributing
from quietarm.metaheuristics.algorithms.moead_de import ScaledMOEAD
from quietarm.metaheuristics.methods.building import directions

ALGORITHMS = pytest.mark.parametrize(
    "build", [lambda: ScaledMOEAD(directions(30)), lambda: MOCMAES(30)], ids=["moead", "mo-cma-es"]
)


class TwoSpheres(Problem):
    """Squared distances from (0, 0, 0) and (1, 1, 1): every optimum has three equal variables."""

    def __init__(self, unit=1.0, least=None):
        super().__init__(n_var=3, n_obj=2, n_ieq_constr=int(least is not None), xl=-2.0, xu=2.0)
        self.unit = unit
        self.least = least

    def _evaluate(self, x, out, *arguments, **options):
        out["F"] = np.column_stack([(x**2).sum(axis=1), self.unit * ((x - 1) ** 2).sum(axis=1)])
        if self.least is not None:
            out["G"] = self.least - x[:, :1]


def solved(build, problem, generations=80):
    return minimize(problem, build(), ("n_gen", generations), seed=1)


@ALGORITHMS
def test_it_finds_a_known_front_from_end_to_end(build):
    X = solved(build, TwoSpheres()).X
    # in a box of 4: a twentieth beside the front costs a hundredth of its extent
    assert np.ptp(X, axis=1).max() < 0.2
    along = np.sort(X.mean(axis=1))
    assert along[0] < 0.05
    assert along[-1] > 0.95
    assert np.diff(along).max() < 0.2


@ALGORITHMS
def test_the_unit_of_an_objective_does_not_matter(build):
    # a power of two, so that nothing is rounded otherwise
    plain = solved(build, TwoSpheres(), 20).X
    np.testing.assert_array_equal(solved(build, TwoSpheres(2.0**-20), 20).X, plain)


@ALGORITHMS
def test_a_constraint_is_kept_and_reached(build):
    # x_1 from 0.5 up: on the front x_1 = max(0.5, t) beside x_2 = x_3 = t
    result = solved(build, TwoSpheres(least=0.5))
    assert result.X[:, 0].min() >= 0.5
    first = result.X[result.F[:, 0].argmin()]
    np.testing.assert_allclose(first, [0.5, 0.0, 0.0], atol=0.1)


@ALGORITHMS
def test_where_nothing_is_feasible_the_least_violation_wins(build):
    least = solved(build, TwoSpheres(least=3.0)).algorithm.opt  # the box ends at 2
    np.testing.assert_allclose(least.get("X")[:, 0], 2.0, atol=0.05)


@ALGORITHMS
def test_what_overflows_comes_last(build):
    class Holes(TwoSpheres):
        def _evaluate(self, x, out, *arguments, **options):
            super()._evaluate(x, out)
            out["F"][x[:, 1] > 0.7] = 1e30  # as searches see a motion that is not finite

    X = solved(build, Holes()).X
    assert X[:, 1].max() <= 0.7
    assert X.mean(axis=1).min() < 0.1


def test_the_least_hypervolume_is_lost_first():
    # rectangles that the points between the ends alone dominate: 2 x 5, 1 x 1 and 5 x 1
    F = np.array([[0.0, 9.0], [1.0, 4.0], [3.0, 3.0], [4.0, 2.0], [9.0, 0.0]])
    assert most_contributing(F, 4).tolist() == [0, 1, 3, 4]
    assert most_contributing(F, 2).tolist() == [0, 4]
