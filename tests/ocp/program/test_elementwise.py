"""Functions of numbers, evaluated for all entries of arrays at once."""

import casadi as ca
import numpy as np
import pytest
from quietarm.ocp.program.node import elementwise


def test_all_entries_at_once_give_what_one_by_one_gives():
    x, shared = ca.SX.sym("x", 3), ca.SX.sym("shared", 2)
    sparse = ca.SX(2, 3)
    sparse[0, 1], sparse[1, 2] = x[0] ** shared[0], ca.if_else(x[1] > 0.5, ca.sin(x[2]), 0)
    outputs = [sparse, ca.vertcat(x[1] / x[2], shared[1] ** 2, 4)]
    one = ca.Function("one", [x, shared], outputs)
    arrays, scalars = [ca.MX.sym("x", 2, 5) for _ in range(3)], [2.0, 3.0]
    results = elementwise(one, arrays, scalars)
    assert [len(result) for result in results] == [function.nnz() for function in outputs]
    together = ca.Function("all", arrays, [entry for result in results for entry in result])
    numbers = np.random.default_rng(0).uniform(0.1, 1.0, (3, 2, 5))
    found = [value.full() for value in together(*numbers)]
    for place in np.ndindex(2, 5):
        alone = one(numbers[:, *place], scalars)
        expected = np.concatenate([np.array(value.nonzeros()) for value in alone])
        assert [value[place] for value in found] == pytest.approx(expected, rel=1e-13)
