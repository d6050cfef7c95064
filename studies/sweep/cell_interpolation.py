"""Interpolation between the cells of a grid that are of one branch.

Along each axis by the polynomial through the nearest six cells. Where some of these have no plan,
or lie beyond a jump, by that through four, then by a straight line between two.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

Array = NDArray[np.float64]
ORDERS = (6, 4, 2)
"""Cells along an axis through which a polynomial goes, the most first."""


def find_jumps(axes: Sequence[Array], cells: Array) -> NDArray[np.int32]:
    """Marks of the cells after which coefficients jump: bit k where they do along axis k."""
    # coefficients that change so many times faster than on either side are of another motion
    much = 4.0
    # unless they change by less than this share of their size: so well is a flat minimum known
    little_share = 0.05
    marks = np.zeros(cells.shape[:-1], np.int32)
    sizes = np.linalg.norm(cells, axis=-1)
    little = (
        little_share * np.median(sizes[np.isfinite(sizes)]) if np.isfinite(sizes).any() else 0.0
    )
    for k, axis in enumerate(axes):
        steps = np.moveaxis(np.linalg.norm(np.diff(cells, axis=k), axis=-1), k, -1)
        slopes = steps / np.abs(np.diff(axis))
        beside = np.full_like(slopes, np.nan)  # of fewer than three none stands out
        beside[..., 1:] = slopes[..., :-1]
        beside[..., :-1] = np.fmax(beside[..., :-1], slopes[..., 1:])
        jump = (slopes > much * beside) & (steps > little)  # NaN is no jump
        np.moveaxis(marks, k, -1)[..., :-1] |= jump.astype(np.int32) << k
    return marks


class Interpolation:
    """Coefficients between cells.

    Parameters
    ----------
    axes : sequence of ndarray
        Values that rise.
    cells : ndarray, shape (*lengths, size)
        Coefficients, NaN where there is no plan.

    Attributes
    ----------
    orders : ndarray of uint8, shape lengths - 1
        Cells along an axis that the polynomial of each box goes through; 0 where none does. A box
        is between two neighbouring values of every axis.
    """

    most_cells = max(ORDERS)

    def __init__(self, axes: Sequence[Array], cells: Array) -> None:
        self.axes = axes
        self.cells = cells
        self.orders = np.zeros([len(axis) - 1 for axis in axes], np.uint8)
        marks = find_jumps(axes, cells)
        boxes = np.indices(self.orders.shape)
        for order in ORDERS:
            usable = self._find_usable(order, marks)
            self.orders[(self.orders == 0) & usable[self._first([*boxes], order)]] = order

    def _find_usable(self, order: int, marks: NDArray[np.int32]) -> NDArray[np.bool_]:
        """Return whether windows of cells have plans and no jumps, by their first cell's place."""
        sizes = [min(order, len(axis)) for axis in self.axes]
        inner = tuple(range(len(sizes), 2 * len(sizes)))
        planned = np.isfinite(self.cells).all(axis=-1)
        usable = np.asarray(sliding_window_view(planned, sizes).all(axis=inner))
        for axis in range(len(sizes)):
            smooth = np.delete((marks >> axis) & 1, -1, axis) == 0
            window = [size - (k == axis) for k, size in enumerate(sizes)]
            usable &= sliding_window_view(smooth, window).all(axis=inner)
        return usable

    def _first(self, box: Sequence[Any], order: int) -> tuple[Any, ...]:
        """The first of the cells along each axis through which a cell's polynomial goes."""
        sizes = [min(order, len(axis)) for axis in self.axes]
        return tuple(
            np.clip(place - (size // 2 - 1), 0, len(axis) - size)
            for place, size, axis in zip(box, sizes, self.axes)
        )

    def __call__(self, places: Array) -> Array:
        """Coefficients at places within the axes, shape (places, size).

        A place has a value for each axis. NaN where it has no polynomial, unless it is a cell.
        """
        return self.of(self.cells, places)

    def of(self, cells: Array, places: Array) -> Array:
        """Interpolate other values that the cells have, such as energies."""
        return np.array([self._at(place, cells) for place in places])

    def _at(self, place: Array, cells: Array) -> Array:
        # a place this near to a cell [share, and units of the axis] is the cell
        tolerated = 1e-12
        pairs = [*zip(self.axes, place)]
        near = tuple(int(np.abs(axis - at).argmin()) for axis, at in pairs)
        values = [axis[k] for axis, k in zip(self.axes, near)]
        if np.allclose(values, place, rtol=tolerated, atol=tolerated):
            return cells[near]
        box = tuple(
            min(np.searchsorted(axis, at, "right"), len(axis) - 1) - 1 for axis, at in pairs
        )
        if not (order := int(self.orders[box])):
            return np.full(cells.shape[-1], np.nan)
        window = tuple(slice(first, first + order) for first in self._first(box, order))
        values = cells[window]
        for (axis, at), cut in zip(pairs, window):
            values = np.tensordot(_lagrange_weights(axis[cut], at), values, axes=1)
        return values


def _lagrange_weights(nodes: Array, at: float) -> Array:
    """Return the weight of each node's value in the polynomial through all of them, at a place."""
    off_diagonal = ~np.eye(len(nodes), dtype=bool)
    distances = np.subtract.outer(nodes, nodes)
    ones = np.ones_like(distances)
    ratios = np.divide(at - nodes, distances, out=ones, where=off_diagonal)
    return ratios.prod(axis=1)
