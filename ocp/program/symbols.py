"""Small helpers around casadi's symbols."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import casadi as ca
import numpy as np


def split(vector: ca.MX, sizes: Sequence[int]) -> list[ca.MX]:
    """Cut a column into parts of these sizes, which add up to its length."""
    return ca.vertsplit(vector, [0, *np.cumsum(sizes).tolist()])


def over_columns(function: ca.Function, columns: int, shared: Collection[int] = ()) -> ca.Function:
    """`function.map`, with every operation done for all columns at once: four times as fast.

    Parameters
    ----------
    function : Function
        Of SX columns.
    columns : int
        How many of each argument stand side by side.
    shared : collection of int
        Arguments of which there is one for all columns.

    Returns
    -------
    Function
        Its results stand side by side, too.
    """
    arguments = [
        ca.MX.sym(function.name_in(i), function.size1_in(i), 1 if i in shared else columns)
        for i in range(function.n_in())
    ]
    rows = [ca.vertsplit(argument) for argument in arguments]
    results = [[ca.MX()] * function.nnz_out(i) for i in range(function.n_out())]
    work: dict[int, ca.MX] = {}
    for k in range(function.n_instructions()):
        operation, where = function.instruction_id(k), function.instruction_output(k)
        of = function.instruction_input(k)
        if operation == ca.OP_OUTPUT:
            value = work[of[0]]
            copies = columns // value.numel()  # as many as there are columns, or one for all
            results[where[0]][where[1]] = ca.repmat(value, 1, copies)
        elif operation == ca.OP_INPUT:
            work[where[0]] = rows[of[0]][of[1]]
        elif operation == ca.OP_CONST:
            work[where[0]] = ca.MX(function.instruction_constant(k))
        elif len(of) == 1:
            work[where[0]] = ca.MX.unary(operation, work[of[0]])
        else:
            work[where[0]] = ca.MX.binary(operation, work[of[0]], work[of[1]])
    patterns = [ca.repmat(function.sparsity_out(i), 1, columns) for i in range(function.n_out())]
    outputs = [
        ca.MX(pattern, ca.vec(ca.vertcat(*result))) if result else ca.MX(pattern)
        for pattern, result in zip(patterns, results, strict=True)
    ]
    return ca.Function(f"{function.name()}_all", arguments, outputs)
