"""Expressions computed entry by entry over arrays (rows, steps), and their derivatives.

Such an expression's derivative by an array of the same shape is again such an array: the
directional derivative along ones. Small matrices of them are tables: entries by row and column,
without those that are zero whatever the symbols.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import casadi as ca

Shape = tuple[int, int]
Table = dict[tuple[int, int], ca.MX]


def symbols(count: int, shape: Shape) -> list[ca.MX]:
    """So many arrays of symbols."""
    return [ca.MX.sym("x", *shape) for _ in range(count)]


def derivative(expression: ca.MX, symbol: ca.MX) -> ca.MX:
    """The derivative by an array, entry by entry."""
    return ca.jtimes(expression, symbol, ca.MX.ones(*symbol.shape))


def jacobian(column: Sequence[ca.MX], by: Sequence[ca.MX]) -> Table:
    """First derivatives of a column of expressions."""
    return {
        (i, k): derivative(expression, symbol)
        for i, expression in enumerate(column)
        for k, symbol in enumerate(by)
        if ca.depends_on(expression, symbol)
    }


def hessian(expression: Any, by: Sequence[ca.MX]) -> Table:
    """Second derivatives of an expression."""
    gradient = jacobian([expression], by)
    upper = {
        (i, k): derivative(first, by[k])
        for (_, i), first in gradient.items()
        for (_, k) in gradient
        if i <= k and ca.depends_on(first, by[k])
    }
    return upper | transpose(upper)


def transpose(table: Table) -> Table:
    """Rows for columns."""
    return {(k, i): entry for (i, k), entry in table.items()}


def product(table: Table, column: Sequence[ca.MX], rows: int) -> list[ca.MX]:
    """A table of so many rows times a column."""
    found = dict[int, ca.MX]()
    for (i, k), entry in table.items():
        term = entry * column[k]
        found[i] = found[i] + term if i in found else term
    zero = ca.MX.zeros(*column[0].shape)
    return [found.get(i, zero) for i in range(rows)]


def repeat(entries: Iterable[ca.MX], count: int) -> list[ca.MX]:
    """Each entry so many times beside itself; numbers as they are."""
    return [ca.repmat(x, 1, count) if isinstance(x, ca.MX) else x for x in entries]


def repeat_table(table: Table, count: int) -> Table:
    """The same of a table."""
    return {place: ca.repmat(x, 1, count) for place, x in table.items()}
