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
from scipy.interpolate import BarycentricInterpolator

Array = NDArray[np.float64]
ORDERS = (6, 4, 2)
"""Cells along an axis through which a polynomial goes, the most first."""
_JUMP = 4.0
"""Coefficients that change so many times faster than on either side are of another motion."""
_LITTLE = 0.05
"""Unless they change by less than this share of their size: so well is a flat minimum known."""
_SAME = 1e-12
"""A place this near to a cell [share, and units of the axis] is the cell."""


def find_jumps(axes: Sequence[Array], cells: Array) -> NDArray[np.int32]:
    """Marks of the cells after which coefficients jump: bit k where they do along axis k."""
    marks = np.zeros(cells.shape[:-1], np.int32)
    sizes = np.linalg.norm(cells, axis=-1)
    little = _LITTLE * np.median(sizes[np.isfinite(sizes)]) if np.isfinite(sizes).any() else 0.0
    for k, axis in enumerate(axes):
        steps = np.moveaxis(np.linalg.norm(np.diff(cells, axis=k), axis=-1), k, -1)
        slopes = steps / np.abs(np.diff(axis))
        beside = np.full_like(slopes, np.nan)  # of fewer than three none stands out
        beside[..., 1:] = slopes[..., :-1]
        beside[..., :-1] = np.fmax(beside[..., :-1], slopes[..., 1:])
        jump = (slopes > _JUMP * beside) & (steps > little)  # NaN is no jump
        np.moveaxis(marks, k, -1)[..., :-1] |= jump.astype(np.int32) << k
    return marks


class Interpolation:
    """Coefficients between cells.

    Parameters
    ----------
    axes : sequence of ndarray
        Values that rise or fall; `axes` has them rising.
    cells : ndarray, shape (*lengths, size)
        Coefficients, NaN where there is no plan; `cells` has them in the order of the axes.

    Attributes
    ----------
    orders : ndarray of uint8, shape lengths - 1
        Cells along an axis that the polynomial of each box goes through; 0 where none does. A box
        is between two neighbouring values of every axis.
    """

    def __init__(self, axes: Sequence[Array], cells: Array) -> None:
        falling = tuple(k for k, axis in enumerate(axes) if axis[-1] < axis[0])
        self.axes, self.cells = [np.sort(axis) for axis in axes], np.flip(cells, falling)
        self.lengths = [len(axis) for axis in axes]
        self.orders = np.zeros([length - 1 for length in self.lengths], np.uint8)
        marks = find_jumps(self.axes, self.cells)
        for order in ORDERS:
            usable = self._find_usable(order, marks)
            boxes = np.meshgrid(*map(np.arange, self.orders.shape), indexing="ij", sparse=True)
            first = tuple(self._first(box, order, k) for k, box in enumerate(boxes))
            self.orders[(self.orders == 0) & usable[first]] = order

    def _find_usable(self, order: int, marks: NDArray[np.int32]) -> NDArray[np.bool_]:
        """Whether windows of cells have plans and no jumps, by the place of their first cell."""
        sizes = [min(order, length) for length in self.lengths]
        inner = tuple(range(len(sizes), 2 * len(sizes)))
        planned = np.isfinite(self.cells).all(axis=-1)
        usable = np.asarray(sliding_window_view(planned, sizes).all(axis=inner))
        for axis in range(len(sizes)):
            smooth = np.delete((marks >> axis) & 1, -1, axis) == 0
            window = [size - (k == axis) for k, size in enumerate(sizes)]
            usable &= sliding_window_view(smooth, window).all(axis=inner)
        return usable

    def _first(self, box: Any, order: int, axis: int) -> Any:
        """The first of the cells along an axis through which the polynomial of a box goes."""
        size = min(order, self.lengths[axis])
        return np.clip(box - (size // 2 - 1), 0, self.lengths[axis] - size)

    def __call__(self, places: Array) -> Array:
        """Coefficients at places within the axes, shape (places, size).

        A place has a value for each axis. NaN where it has no polynomial, unless it is a cell.
        """
        found = np.full((len(places), self.cells.shape[-1]), np.nan)
        corners = np.stack([
            np.clip(np.searchsorted(axis, values, side="right") - 1, 0, len(axis) - 2)
            for axis, values in zip(self.axes, places.T, strict=True)
        ])  # fmt: skip
        boxes: Any = np.ravel_multi_index(tuple(corners), self.orders.shape)
        order = np.argsort(boxes, kind="stable")
        for rows in np.split(order, np.flatnonzero(np.diff(boxes[order])) + 1):
            if len(rows):
                found[rows] = self._through(tuple(corners[:, rows[0]]), places[rows])
        for row in np.flatnonzero(np.isnan(found[:, 0])):
            found[row] = self._cell_at(places[row])
        return found

    def _through(self, box: tuple[int, ...], places: Array) -> Array:
        """Values of the polynomial of a box; NaN where it has none."""
        order = int(self.orders[box])
        if order == 0:
            return np.full((len(places), self.cells.shape[-1]), np.nan)
        firsts = [self._first(place, order, k) for k, place in enumerate(box)]
        window = tuple(slice(first, first + order) for first in firsts)
        values = np.broadcast_to(self.cells[window], (len(places), *self.cells[window].shape))
        for axis, cut, at in zip(self.axes, window, places.T, strict=True):
            nodes = axis[cut]
            weights = BarycentricInterpolator(nodes, np.eye(len(nodes)))(at)
            values = np.einsum("pn...,pn->p...", values, weights)
        return values

    def _cell_at(self, place: Array) -> Array:
        """The cell whose place this is; NaN where it is none's."""
        near = [int(np.abs(axis - at).argmin()) for axis, at in zip(self.axes, place, strict=True)]
        values = [axis[k] for axis, k in zip(self.axes, near, strict=True)]
        same = np.allclose(values, place, rtol=_SAME, atol=_SAME)
        return self.cells[tuple(near)] if same else np.full(self.cells.shape[-1], np.nan)
