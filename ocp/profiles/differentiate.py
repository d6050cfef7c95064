"""CasADi's derivatives by the fraction of the duration, of expressions and of numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

from quietarm.models import Expression

Slopes = tuple[Expression, Expression, Expression]
"""A function of the fraction of the duration, and its first two derivatives by it."""


def differentiate(
    function: Callable[[Expression], Sequence[Expression]],
    fraction: Expression,
    parameters: Sequence[Expression],
    order: int,
) -> list[Expression]:
    """Values at a fraction of the duration, and derivatives of the last one up to an order.

    Parameters
    ----------
    function : callable
        Returns the values at a fraction, computed element by element.
    fraction : Expression
        Where; numbers, or an expression.
    parameters : sequence of Expression
        What else the values depend on; SX where any of them is.
    order : int
        How often the last value is differentiated.
    """
    types = {type(x) for x in (*parameters, fraction)}
    symbol_type: Any = ca.SX if ca.SX in types else ca.MX
    place = symbol_type(fraction)
    # CasADi differentiates by symbols only: the fraction is one at first
    symbol = symbol_type.sym("t", *place.shape)
    ones = symbol_type.ones(*place.shape)
    values = [symbol_type(value) for value in function(symbol)]
    for _ in range(order):
        rate = ca.jtimes(values[-1], symbol, ones)
        values.append(rate * ones)  # a rate that is nothing has one entry
    values: Any = ca.substitute(values, [symbol], [place])
    if ca.symvar(ca.veccat(*values)):
        return values
    return [ca.evalf(value) for value in values]
