"""Enclosures of a CasADi function over intervals of its first argument: interval arithmetic.

Every operation is rounded outwards, so that the values at all points of an interval lie within.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Interval(NamedTuple):
    """Intervals, from low to high, one for each element of the arrays."""

    low: Array
    high: Array


class NoEnclosureError(ValueError):
    """An operation of which no enclosure is known here."""


def enclose(
    function: ca.Function, first: Interval, others: Sequence[Sequence[float]]
) -> list[Interval]:
    """Return enclosures of the outputs of a function of scalars.

    Parameters
    ----------
    function : casadi.Function
        A function of SX, whose first argument is a scalar.
    first : Interval
        Intervals of the first argument.
    others : sequence of sequence of float
        The other arguments, which are numbers.

    Raises
    ------
    NoEnclosureError
        If the function has an operation that is not known here.
    """
    work = dict[int, Interval]()
    outputs = dict[int, Interval]()
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        given = function.instruction_input(k)
        into = function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            outputs[into[1]] = work[given[0]]
        elif operation == ca.OP_INPUT:
            argument, place = given
            work[into[0]] = first if argument == 0 else _point(others[argument - 1][place])
        elif operation == ca.OP_CONST:
            work[into[0]] = _point(function.instruction_constant(k))
        elif operation in _OPERATIONS:
            with np.errstate(all="ignore"):
                low, high = _OPERATIONS[operation](*(work[place] for place in given))
            # what is no number may be anything
            low = np.where(np.isnan(low), -np.inf, low)
            work[into[0]] = Interval(low, np.where(np.isnan(high), np.inf, high))
        else:
            raise NoEnclosureError(f"no enclosure of operation {operation} of CasADi is known")
    shape = first.low.shape
    return [
        Interval(np.broadcast_to(found.low, shape), np.broadcast_to(found.high, shape))
        for _, found in sorted(outputs.items())
    ]


def _point(value: float) -> Interval:
    return Interval(np.array(value), np.array(value))


def _outwards(low: Array, high: Array, ulps: int = 1) -> Interval:
    """The interval around what was rounded, by so many units in the last place on either side."""
    for _ in range(ulps):
        low = np.nextafter(low, -np.inf)
        high = np.nextafter(high, np.inf)
    return Interval(low, high)


def _added(a: Interval, b: Interval) -> Interval:
    return _outwards(a.low + b.low, a.high + b.high)


def _negative(a: Interval) -> Interval:
    return Interval(-a.high, -a.low)


def _product(a: Interval, b: Interval) -> Interval:
    corners = (a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high)
    lowest = np.minimum(np.minimum(corners[0], corners[1]), np.minimum(corners[2], corners[3]))
    highest = np.maximum(np.maximum(corners[0], corners[1]), np.maximum(corners[2], corners[3]))
    return _outwards(lowest, highest)


def _inverse(a: Interval) -> Interval:
    holds_zero = (a.low <= 0) & (a.high >= 0)
    low, high = _outwards(1 / a.high, 1 / a.low)
    return Interval(np.where(holds_zero, -np.inf, low), np.where(holds_zero, np.inf, high))


def _square(a: Interval) -> Interval:
    low, high = a.low * a.low, a.high * a.high
    holds_zero = (a.low <= 0) & (a.high >= 0)
    least = np.where(holds_zero, 0.0, np.minimum(low, high))
    found = _outwards(least, np.maximum(low, high))
    return Interval(np.maximum(found.low, 0.0), found.high)


def _increasing(call: Callable[[Array], Array]) -> Callable[[Interval], Interval]:
    """The enclosure of a function that increases, and is right to two units in the last place."""
    return lambda a: _outwards(call(a.low), call(a.high), 3)


def _sine(a: Interval) -> Interval:
    low, high = _outwards(
        np.minimum(np.sin(a.low), np.sin(a.high)), np.maximum(np.sin(a.low), np.sin(a.high)), 3
    )
    return Interval(
        np.where(_reaches(a, -np.pi / 2), -1.0, np.maximum(low, -1.0)),
        np.where(_reaches(a, np.pi / 2), 1.0, np.minimum(high, 1.0)),
    )


def _cosine(a: Interval) -> Interval:
    low, high = _outwards(
        np.minimum(np.cos(a.low), np.cos(a.high)), np.maximum(np.cos(a.low), np.cos(a.high)), 3
    )
    return Interval(
        np.where(_reaches(a, np.pi), -1.0, np.maximum(low, -1.0)),
        np.where(_reaches(a, 0.0), 1.0, np.minimum(high, 1.0)),
    )


def _reaches(a: Interval, angle: float) -> NDArray[np.bool_]:
    """True where an angle, or that and whole turns, may be in the interval."""
    slack = 1e-12 * (1 + np.maximum(abs(a.low), abs(a.high)))
    first = np.ceil((a.low - slack - angle) / (2 * np.pi))
    return angle + 2 * np.pi * first <= a.high + slack


def _absolute(a: Interval) -> Interval:
    holds_zero = (a.low <= 0) & (a.high >= 0)
    least = np.minimum(abs(a.low), abs(a.high))
    return Interval(np.where(holds_zero, 0.0, least), np.maximum(abs(a.low), abs(a.high)))


def _truth(certain: NDArray[np.bool_], possible: NDArray[np.bool_]) -> Interval:
    """A truth value, 1 or 0, which may be either where it is possible and not certain."""
    return Interval(certain.astype(float), possible.astype(float))


def _is_true(a: Interval) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return where a value certainly, and possibly, is other than 0."""
    return (a.low > 0) | (a.high < 0), (a.low != 0) | (a.high != 0)


def _equal(a: Interval, b: Interval) -> Interval:
    certain = (a.low == a.high) & (b.low == b.high) & (a.low == b.low)
    return _truth(certain, (a.low <= b.high) & (b.low <= a.high))


def _not(a: Interval) -> Interval:
    certain, possible = _is_true(a)
    return _truth(~possible, ~certain)


def _and(a: Interval, b: Interval) -> Interval:
    (certain_a, possible_a), (certain_b, possible_b) = _is_true(a), _is_true(b)
    return _truth(certain_a & certain_b, possible_a & possible_b)


def _or(a: Interval, b: Interval) -> Interval:
    (certain_a, possible_a), (certain_b, possible_b) = _is_true(a), _is_true(b)
    return _truth(certain_a | certain_b, possible_a | possible_b)


def _if_else_zero(condition: Interval, a: Interval) -> Interval:
    certain, possible = _is_true(condition)
    low = np.where(certain, a.low, np.minimum(a.low, 0.0))
    high = np.where(certain, a.high, np.maximum(a.high, 0.0))
    return Interval(np.where(possible, low, 0.0), np.where(possible, high, 0.0))


def _power(a: Interval, b: Interval) -> Interval:
    """A power with a whole exponent by products; of a positive base by its logarithm."""
    exponent = float(np.ravel(b.low)[0]) if b.low.ndim == 0 else np.nan
    if b.low.ndim == 0 and b.low == b.high and exponent == int(exponent) and 0 <= exponent < 64:
        count = int(exponent)
        found = _point(1.0)
        for _ in range(count // 2):
            found = _product(found, _square(a))
        return _product(found, a) if count % 2 else found
    logarithm = _outwards(np.log(a.low), np.log(a.high), 3)
    return _increasing(np.exp)(_product(logarithm, b))


_OPERATIONS: Mapping[int, Callable[..., Interval]] = {
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_ADD: _added,
    ca.OP_SUB: lambda a, b: _added(a, _negative(b)),
    ca.OP_MUL: _product,
    ca.OP_DIV: lambda a, b: _product(a, _inverse(b)),
    ca.OP_NEG: _negative,
    ca.OP_SQ: _square,
    ca.OP_TWICE: lambda a: Interval(2 * a.low, 2 * a.high),
    ca.OP_INV: _inverse,
    ca.OP_SQRT: lambda a: _increasing(np.sqrt)(Interval(np.maximum(a.low, 0.0), a.high)),
    ca.OP_SIN: _sine,
    ca.OP_COS: _cosine,
    ca.OP_ATAN: _increasing(np.arctan),
    ca.OP_EXP: _increasing(np.exp),
    ca.OP_LOG: _increasing(np.log),
    ca.OP_TANH: _increasing(np.tanh),
    ca.OP_FABS: _absolute,
    ca.OP_FMIN: lambda a, b: Interval(np.minimum(a.low, b.low), np.minimum(a.high, b.high)),
    ca.OP_FMAX: lambda a, b: Interval(np.maximum(a.low, b.low), np.maximum(a.high, b.high)),
    ca.OP_POW: _power,
    ca.OP_CONSTPOW: _power,
    ca.OP_LT: lambda a, b: _truth(a.high < b.low, a.low < b.high),
    ca.OP_LE: lambda a, b: _truth(a.high <= b.low, a.low <= b.high),
    ca.OP_EQ: _equal,
    ca.OP_NE: lambda a, b: _not(_equal(a, b)),
    ca.OP_NOT: _not,
    ca.OP_AND: _and,
    ca.OP_OR: _or,
    ca.OP_IF_ELSE_ZERO: _if_else_zero,
}
"""Enclosures of CasADi's operations."""
