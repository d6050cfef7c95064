"""Functions of the place on a path as polynomials between knots, in Chebyshev's basis.

The same tables are evaluated in numbers, and in CasADi's symbols entry by entry. The basis is
computed once at a place, and all functions from it by one product; which piece the place is on is
told by comparisons, whose derivatives are 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev

from quietarm.models.joint_motion import Array, Expression

NODES = 20
"""At which a piece is fitted: functions of angles that turn by a radian are then exact."""
_MOST_HALVINGS = 8
"""Of a piece that is not fitted: a corner stays one, however short the piece."""


class NoFitError(ArithmeticError):
    """A function is not smooth near a place."""

    def __init__(self, place: float) -> None:
        super().__init__(f"not smooth at {place:.4g}")
        self.place = place


@dataclass(frozen=True, eq=False)
class Piecewise:
    """Several functions of one variable.

    Attributes
    ----------
    knots : ndarray, shape (pieces + 1,)
        Ends of the pieces.
    coefficients : ndarray, shape (pieces, terms, functions)
        By Chebyshev polynomials of the share of the piece, from -1 to 1.
    """

    knots: Array
    coefficients: Array

    def __call__(self, places: Sequence[float] | Array, order: int = 0) -> Array:
        """Values or derivatives, shape (places, functions); outside the ends as they go on."""
        places = np.atleast_1d(np.asarray(places, dtype=float))
        pieces = np.clip(
            np.searchsorted(self.knots, places, side="right") - 1, 0, len(self.knots) - 2
        )
        values = np.empty((len(places), self.coefficients.shape[2]))
        for piece in np.unique(pieces):
            at = pieces == piece
            begin, end = self.knots[piece : piece + 2]
            share = (2 * places[at] - begin - end) / (end - begin)
            terms = self._differentiated(piece, order)
            values[at] = chebyshev.chebval(share, terms).T
        return values

    def derivative(self, order: int = 1) -> Piecewise:
        """Return the derivative of every function by the variable."""
        pieces = range(len(self.coefficients))
        return Piecewise(self.knots, np.array([self._differentiated(i, order) for i in pieces]))

    def on(self, knots: Array) -> Piecewise:
        """Return these functions on finer pieces, whose knots include the present ones."""
        terms = self.coefficients.shape[1]
        return Piecewise(knots, interpolate(self, knots, terms))

    def _differentiated(self, piece: int, order: int) -> Array:
        length = self.knots[piece + 1] - self.knots[piece]
        if order == 0:
            return self.coefficients[piece]
        return chebyshev.chebder(self.coefficients[piece], order) * (2 / length) ** order


def fit(
    function: Callable[[Array], Array], knots: Array, tolerances: Callable[[Array], Array]
) -> Piecewise:
    """Fit functions between knots, on more pieces where they need them.

    Parameters
    ----------
    function : callable
        Places, shape (places,) -> values, shape (places, functions).
    knots : ndarray
        Where the functions may not be smooth, and the ends.
    tolerances : callable
        Values at the nodes of all pieces -> largest error of each function.

    Raises
    ------
    NoFitError
        When a function is not smooth between two knots.
    """
    ends = list(pairwise(knots))
    largest = tolerances(np.concatenate([function(_nodes(*piece, NODES)) for piece in ends]))
    pieces = [one for piece in ends for one in _pieces(function, piece, largest, _MOST_HALVINGS)]
    found = np.array([begin for begin, _, _ in pieces] + [pieces[-1][1]])
    coefficients = np.array([terms for _, _, terms in pieces])
    return Piecewise(found, without_small_terms(coefficients, largest))


def _pieces(
    function: Callable[[Array], Array], piece: tuple[float, float], largest: Array, halvings: int
) -> list[tuple[float, float, Array]]:
    """Ends and coefficients of a piece, or of its halves where it is not fitted."""
    begin, end = piece
    nodes = _nodes(begin, end, NODES)
    fitted = chebyshev.chebfit(np.cos(_angles(NODES)), function(nodes), NODES - 1)
    terms = np.asarray(fitted, float)
    between = _nodes(begin, end, NODES + 1)
    values = chebyshev.chebval(np.cos(_angles(NODES + 1)), terms).T
    missed = np.abs(values - function(between))
    if np.all(missed <= largest / 2):
        return [(begin, end, terms)]
    if halvings == 0:
        raise NoFitError(float(between[(missed / largest).max(axis=1).argmax()]))
    middle = (begin + end) / 2
    return [
        *_pieces(function, (begin, middle), largest, halvings - 1),
        *_pieces(function, (middle, end), largest, halvings - 1),
    ]


def without_small_terms(coefficients: Array, largest: Array) -> Array:
    """Drop the last terms of each function that come to less than half its largest error."""
    tails = np.cumsum(np.abs(coefficients[:, ::-1]), axis=1)[:, ::-1]
    shortened = np.where(tails > largest / 2, coefficients, 0.0)
    used = np.flatnonzero(np.abs(shortened).max(axis=(0, 2)))
    terms = used[-1] + 1 if len(used) else 1
    return shortened[:, :terms]


def interpolate(function: Callable[[Array], Array], knots: Array, terms: int) -> Array:
    """Coefficients through a function of so many terms, shape (pieces, terms, functions)."""
    fitted = [
        chebyshev.chebfit(np.cos(_angles(terms)), function(_nodes(begin, end, terms)), terms - 1)
        for begin, end in pairwise(knots)
    ]
    return np.asarray(fitted, float)


def _angles(count: int) -> Array:
    return np.pi * (np.arange(count) + 0.5) / count


def _nodes(begin: float, end: float, count: int) -> Array:
    """Chebyshev's nodes of a piece."""
    return begin + (end - begin) * (np.cos(_angles(count)) + 1) / 2


class Place:
    """A place on the pieces, or an array of places: numbers or symbols, with the basis there.

    Values have the shape of the place. There are as many rows of the basis as pieces and terms;
    those of the pieces that a place is not on are 0.
    """

    def __init__(self, knots: Array, place: Expression, terms: int) -> None:
        self._in_numbers = isinstance(place, float | int | np.ndarray)
        self._shape = np.shape(place) if self._in_numbers else place.shape
        numbers = np.reshape(place, (1, -1)) if self._in_numbers else None
        row = ca.reshape(place, 1, -1) if numbers is None else ca.DM(numbers)
        beyond = [row >= float(knot) for knot in knots[1:-1]]
        slopes = 2 / np.diff(knots)
        offsets = -(knots[1:] + knots[:-1]) / np.diff(knots)
        share = _chosen(slopes.tolist(), beyond) * row + _chosen(offsets.tolist(), beyond)
        basis = [0 * share + 1, share]
        while len(basis) < terms:
            basis.append(2 * share * basis[-1] - basis[-2])
        on = [1 - after for after in beyond] if beyond else []
        on = [before * there for before, there in zip([1, *beyond], [*on, 1])]
        self._basis = ca.vertcat(*(here * term for here in on for term in basis[:terms]))

    def values(self, table: Array) -> Array:
        """Return values of functions of coefficients (pieces, terms, ...): an array of expressions.

        Those that are nothing on any piece are the number 0.0.
        """
        flat = table.reshape(-1, int(np.prod(table.shape[2:])))
        used = np.flatnonzero(flat.any(axis=0))
        values = np.zeros(flat.shape[1], dtype=object)
        values[:] = 0.0
        if len(used):
            rows = ca.mtimes(ca.sparsify(ca.DM(flat[:, used].T)), self._basis)
            for number, row in zip(used, ca.vertsplit(rows)):
                values[number] = self._shaped(row)
        return values.reshape(table.shape[2:])

    def takes_by_row(self, factor: Expression) -> bool:
        """Return whether a factor is an array of several columns, as the place is."""
        of_factor = getattr(factor, "shape", ())
        return not self._in_numbers and of_factor == self._shape and self._shape[1] > 1

    def values_of_sum(self, tables: Sequence[Array], factors: Sequence[Expression]) -> Array:
        """Return a sum of tables times factors, which are the same in all columns of a row.

        Tables are summed before the product with the basis: once a row, not at every place. There
        is a factor for every table but the first.
        """
        count = int(np.prod(tables[0].shape[2:]))
        flat = np.array([table.reshape(-1, count).T for table in tables])
        used = np.flatnonzero(flat.any(axis=(0, 2)))
        values = np.zeros(count, dtype=object)
        values[:] = 0.0
        if not len(used):
            return values.reshape(tables[0].shape[2:])
        filled = flat[:, used]
        pattern = ca.sparsify(ca.DM(filled.any(axis=0).astype(float))).sparsity()
        places = np.array(pattern.row()), np.array(pattern.get_col())
        entries = ca.DM(filled[:, places[0], places[1]].T)
        rows, columns = self._shape
        by_row = list[Expression]()
        for row in range(rows):
            weights = ca.vertcat(1.0, *(factor[row, 0] for factor in factors))
            sums = ca.mtimes(entries, weights)
            summed = type(sums)(pattern, sums)
            by_row.append(ca.mtimes(summed, self._basis[:, row::rows]))
        order = np.arange(rows * columns).reshape(rows, columns).T.ravel().tolist()
        for number, value in zip(used, ca.vertsplit(ca.horzcat(*by_row)[:, order])):
            values[number] = self._shaped(value)
        return values.reshape(tables[0].shape[2:])

    def _shaped(self, row: Expression) -> Expression:
        if self._in_numbers:
            numbers = row.full().reshape(self._shape)
            return numbers if numbers.ndim else float(numbers)
        return ca.reshape(row, *self._shape)


def _chosen(values: Sequence[float], beyond: Sequence[Expression]) -> Expression:
    """The value of the piece, of one for each, by the knots that are passed."""
    chosen: Expression = values[0]
    for passed, (before, after) in zip(beyond, pairwise(values)):
        chosen = chosen + passed * (after - before)
    return chosen
