"""A casadi function of numbers, on arrays that hold an entry for each row and step."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
from quietarm.models import Expression


def elementwise(function: ca.Function, *inputs: Sequence[Expression]) -> list[list[ca.MX]]:
    """Apply a function of SX entry by entry: every operation is done for all entries at once.

    Parameters
    ----------
    function : Function
        Of SX columns.
    inputs : sequence of Expression
        For each argument its entries: arrays of one shape, or scalars.

    Returns
    -------
    list of list of MX
        For each result its nonzeros, in the order of its sparsity.
    """
    shape = next((x.shape for of in inputs for x in of if isinstance(x, ca.MX)), (1, 1))
    results = [[ca.MX()] * function.nnz_out(i) for i in range(function.n_out())]
    work: dict[int, ca.MX] = {}
    for k in range(function.n_instructions()):
        operation, where = function.instruction_id(k), function.instruction_output(k)
        of = function.instruction_input(k)
        if operation == ca.OP_OUTPUT:
            value = work[of[0]]
            results[where[0]][where[1]] = (
                value if value.shape == shape else ca.repmat(value, *shape)
            )
        elif operation == ca.OP_INPUT:
            work[where[0]] = ca.MX(inputs[of[0]][of[1]])
        elif operation == ca.OP_CONST:
            work[where[0]] = ca.MX(function.instruction_constant(k))
        elif len(of) == 1:
            work[where[0]] = ca.MX.unary(operation, work[of[0]])
        else:
            work[where[0]] = ca.MX.binary(operation, work[of[0]], work[of[1]])
    return results
