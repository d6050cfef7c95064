"""Derivatives that a program assembles by hand, against casadi's own and against differences."""

import casadi as ca
import numpy as np
import pytest


def functions_of(program):
    """The functions that IPOPT calls, by name."""
    return {name: program._solver.get_function(name) for name in program._solver.get_function()}


def assert_jacobian_is_casadis(program, x, p):
    functions = functions_of(program)
    of_x, of_p = ca.MX.sym("x", len(x)), ca.MX.sym("p", len(p))
    g = functions["nlp_g"](of_x, of_p)
    automatic = ca.Function("automatic", [of_x, of_p], [g, ca.jacobian(g, of_x)])
    expected_g, expected = (value.full() for value in automatic(x, p))
    found_g, found = (value.full() for value in functions["nlp_jac_g"](x, p))
    assert found_g == pytest.approx(expected_g, rel=1e-13, abs=1e-13)
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-10)


def assert_jacobian_is_the_limit_of_differences(program, x, p, directions):
    """Independent of casadi's derivatives, along these directions."""
    functions, h = functions_of(program), 1e-6
    jacobian = functions["nlp_jac_g"](x, p)[1].full()
    for direction in directions:
        there, back = (functions["nlp_g"](x + s * h * direction, p).full() for s in (1, -1))
        expected = (there - back).ravel() / (2 * h)
        assert jacobian @ direction == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


def both_hessians(program, x, p, of_objective, multipliers):
    """The program's Hessian of the Lagrangian and casadi's own: their upper triangles."""
    functions = functions_of(program)
    of_x, of_p = ca.MX.sym("x", len(x)), ca.MX.sym("p", len(p))
    lagrangian = of_objective * functions["nlp_f"](of_x, of_p)
    lagrangian += ca.dot(multipliers, functions["nlp_g"](of_x, of_p))
    automatic = ca.Function("automatic", [of_x, of_p], [ca.hessian(lagrangian, of_x)[0]])
    found = functions["nlp_hess_l"](x, p, of_objective, multipliers).full()
    return found, np.triu(automatic(x, p).full())
