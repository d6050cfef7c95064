"""Functions of rows, a row a candidate: compiled for blocks of several sizes, and called."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import accumulate, repeat
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models.compiled import Compiled
from quietarm.ocp.cost import COST

Array = NDArray[np.float64]
Unpack = Callable[[list[Array], int], tuple[Array, ...]]
"""From outputs whose columns are candidates to copies with a row for each."""


class RowFunction:
    """A function of rows, compiled for a block of rows when one of that size is first needed.

    Parameters
    ----------
    build : callable
        Builds the function for so many rows.
    sizes : tuple of int
        Rows of a compiled call, increasing: to build one takes as long as hundreds of its calls.
    kept_as : sequence, optional
        All that the function follows from beside the number of rows, as of `Compiled`.
    patience : int
        Calls of the smallest block that stand in for a larger one before that is built.
    """

    def __init__(
        self,
        build: Callable[[int], ca.Function],
        sizes: tuple[int, ...],
        kept_as: Sequence[Any] | None = None,
        patience: int = 0,
    ) -> None:
        self._build = build
        self._kept_as = kept_as
        self._sizes = sizes
        self._compiled: dict[int, Compiled] = {}
        self._padded_calls = 0
        self._patience = patience

    def __call__(self, inputs: Sequence[Array], unpack: Unpack, threads: int = 1) -> list[Array]:
        """The outputs, a row each, a block for each thread at a time."""
        rows = max(len(inputs[0]), 1)
        sizes = self._split(rows)
        ends = list(accumulate(sizes))
        blocks = [[values[end - size : end] for values in inputs] for size, end in zip(sizes, ends)]
        if threads > 1 and len(blocks) > 1:
            with ThreadPoolExecutor(threads) as pool:
                parts = list(pool.map(self._evaluate, blocks, sizes, repeat(unpack)))
        else:
            parts = list(map(self._evaluate, blocks, sizes, repeat(unpack)))
        return [np.concatenate(part) for part in zip(*parts)]

    def _split(self, rows: int) -> list[int]:
        """Sizes of the blocks for so many rows, built in this thread, whose time counts."""
        sizes = list[int]()
        while rows > 0:
            sizes.append(self.prepare(rows))
            rows -= sizes[-1]
        return sizes

    @property
    def built(self) -> list[int]:
        """Sizes of the blocks that are built."""
        return sorted(self._compiled)

    def prepare(self, rows: int) -> int:
        """The size of the next block of so many rows, built; rows use another for a while."""
        size = next((size for size in self._sizes if size >= rows), self._sizes[-1])
        if size in self._compiled:
            return size
        if size > self._sizes[0] and self._patience > 0:
            self._patience -= 1
            return self.prepare(1)
        larger = [built for built in self._compiled if built > size]
        if size == 1 and larger and self._padded_calls < 200:
            self._padded_calls += 1
            return min(larger)
        # it does not refer to this object, which then goes, with its memory, when it is forgotten
        kept_as = None if self._kept_as is None else (*self._kept_as, size)
        compiled = Compiled(partial(self._build, size), side_by_side=True, kept_as=kept_as)
        with COST.timed("builds"):
            _ = compiled.function
        self._compiled[size] = compiled
        return size

    def _evaluate(self, block: Sequence[Array], size: int, unpack: Unpack) -> tuple[Array, ...]:
        rows = len(block[0])
        columns = [np.resize(values, (size, values.shape[1])).T for values in block]
        return self._compiled[size].run(columns, lambda outputs: unpack(outputs, rows))


def copy_rows(outputs: list[Array], rows: int) -> tuple[Array, ...]:
    """Copies of the first rows."""
    return tuple(values[:, :rows].T.copy() for values in outputs)


def widen(matrix: ca.MX, columns: int) -> list[ca.MX]:
    """The columns of a matrix of symbols, each repeated so many times."""
    return [ca.repmat(column, 1, columns) for column in ca.horzsplit(matrix, 1)]


def join(columns: Sequence[Any], rows: int) -> ca.MX:
    """A dense matrix of so many rows from its columns."""
    return ca.densify(ca.horzcat(ca.MX(rows, 0), *columns))
