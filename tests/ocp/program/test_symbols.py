"""Functions of scalars, evaluated for many columns at once."""

import casadi as ca
import numpy as np
import pytest

from ocp.program.symbols import over_columns

COLUMNS = 5


def test_all_columns_at_once_give_what_one_by_one_gives():
    x, shared = ca.SX.sym("x", 3), ca.SX.sym("shared", 2)
    sparse = ca.SX(2, 3)
    sparse[0, 1], sparse[1, 2] = x[0] ** shared[0], ca.if_else(x[1] > 0.5, ca.sin(x[2]), 0)
    outputs = [sparse, ca.vertcat(x[1] / x[2], shared[1] ** 2, 4), ca.SX(2, 2)]
    one = ca.Function("one", [x, shared], outputs)
    arguments = np.random.default_rng(0).uniform(0.1, 1.0, (3, COLUMNS)), np.array([2.0, 3.0])
    found = over_columns(one, COLUMNS, [1])(*arguments)
    expected = one.map("mapped", "serial", COLUMNS, [1], [])(*arguments)
    for value, other in zip(found, expected, strict=True):
        assert value.sparsity() == other.sparsity()
        assert value.full() == pytest.approx(other.full(), rel=1e-15)
