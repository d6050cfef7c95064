"""Interpolation between the cells of a grid that are of one branch.

Along each axis by the polynomial through the nearest six cells. Where some of these have no plan,
or lie beyond a jump, by that through four, then by a straight line between two.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, reduce

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]
ORDERS = (6, 4, 2)
"""Cells along an axis through which a polynomial goes, the most first."""
_AT_ONCE = 2000


class Interpolation:
    """Coefficients between cells, shape (*lengths, size), which are NaN where there is no plan.

    The values of an axis rise or fall; the marks are those of `quietarm.studies.sweep.branches`.
    """

    def __init__(self, axes: Sequence[Array], cells: Array, marks: NDArray[np.int32]) -> None:
        self.axes, self.cells, self._marks = axes, cells, marks
        self.lengths = np.array(marks.shape)

    @cached_property
    def orders(self) -> NDArray[np.uint8]:
        """Cells along an axis that the polynomial of each box goes through; 0 where none does.

        A box is between two neighbouring values of every axis; its shape is lengths - 1.
        """
        orders = np.zeros(self.lengths - 1, np.uint8)
        for order in ORDERS:
            whole = self._whole(np.minimum(order, self.lengths))
            boxes = np.meshgrid(*map(np.arange, orders.shape), indexing="ij", sparse=True)
            first = tuple(self._first(box, order, k) for k, box in enumerate(boxes))
            orders[(orders == 0) & whole[first]] = order
        return orders

    def _whole(self, sizes: Index) -> NDArray[np.bool_]:
        """Whether windows of cells have plans and no jumps, by the place of their first cell."""
        good = np.asarray(np.isfinite(self.cells).all(axis=-1))
        inner = tuple(range(len(sizes), 2 * len(sizes)))
        whole = np.asarray(sliding_window_view(good, sizes).all(axis=inner))
        for axis in range(len(sizes)):
            edges = np.delete((self._marks >> axis) & 1, -1, axis) == 0
            window = [size - (k == axis) for k, size in enumerate(sizes)]
            whole &= sliding_window_view(edges, window).all(axis=inner)
        return whole

    def _first(self, box: Index, order: int, axis: int) -> Index:
        """The first of the cells along an axis through which the polynomial of a box goes."""
        length = int(self.lengths[axis])
        size = min(order, length)
        return np.clip(box - (size // 2 - 1), 0, length - size)

    def __call__(self, places: Array) -> Array:
        """Coefficients at places, shape (places, size); NaN where there is no polynomial.

        A place has a value for each axis, within them.
        """
        found = np.full((len(places), self.cells.shape[-1]), np.nan)
        boxes = [self._box(axis, places[:, k]) for k, axis in enumerate(self.axes)]
        orders = self.orders[tuple(boxes)]
        for order in ORDERS:
            rows = np.flatnonzero(orders == order)
            for some in np.split(rows, range(_AT_ONCE, len(rows), _AT_ONCE)):
                found[some] = self._through(order, places[some], [box[some] for box in boxes])
        at_cells = self._cells_at(places, boxes)
        missing = ~np.isfinite(found[:, 0])
        found[missing] = at_cells[missing]
        return found

    def _box(self, axis: Array, values: Array) -> Index:
        rising = axis if axis[-1] > axis[0] else -axis
        signed = values if axis[-1] > axis[0] else -values
        return np.clip(np.searchsorted(rising, signed, side="right") - 1, 0, len(axis) - 2)

    def _through(self, order: int, places: Array, boxes: list[Index]) -> Array:
        firsts = [self._first(box, order, k) for k, box in enumerate(boxes)]
        sizes = np.minimum(order, self.lengths)
        index = tuple(
            (first[:, None] + np.arange(size)).reshape(-1, *self._spread(size, k))
            for k, (first, size) in enumerate(zip(firsts, sizes, strict=True))
        )
        found: Array = self.cells[index]
        for k in reversed(range(len(sizes))):
            nodes = self.axes[k][firsts[k][:, None] + np.arange(sizes[k])]
            weights = _lagrange(nodes, places[:, k])
            found = np.einsum("n...sc,ns->n...c", found, weights)
        return found

    def _spread(self, size: int, axis: int) -> list[int]:
        shape = [1] * len(self.lengths)
        shape[axis] = size
        return shape

    def _cells_at(self, places: Array, boxes: list[Index]) -> Array:
        """The cells themselves where places are theirs, else NaN."""
        found = np.full((len(places), self.cells.shape[-1]), np.nan)
        near = [box + (np.abs(axis[box + 1] - at) < np.abs(axis[box] - at))
                for axis, box, at in zip(self.axes, boxes, places.T, strict=True)]  # fmt: skip
        same = reduce(np.logical_and, [
            np.isclose(axis[k], at, rtol=1e-12, atol=1e-12)
            for axis, k, at in zip(self.axes, near, places.T, strict=True)
        ])  # fmt: skip
        found[same] = self.cells[tuple(near)][same]
        return found


def _lagrange(nodes: Array, at: Array) -> Array:
    """Weights of values at nodes for the polynomial through them; a row a place."""
    size = nodes.shape[1]
    weights = np.ones_like(nodes)
    for i in range(size):
        for j in range(size):
            if i != j:
                weights[:, i] *= (at - nodes[:, j]) / (nodes[:, i] - nodes[:, j])
    return weights
