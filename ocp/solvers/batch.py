"""Candidates in rows: what each costs, leaves and asks of the joint, with exact derivatives.

A row is a candidate with a move and errors of the plant of its own. The modes are linear in the
state before a step and in what forces them at its nodes, so the first derivatives follow by the
same steps: they are a rollout of their own, forced by the derivatives of the forcing, with a row
for each coefficient of each candidate. The same steps backwards carry multipliers to the forcing.
All that is nonlinear belongs to a single node, where second derivatives are small blocks.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.ocp.energy import ABSOLUTE_POWER, Energy
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.buffered import BufferedFunction
from quietarm.ocp.simulation.collocation import NODES
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.solvers.expressions import Kind, function_of_derivatives, function_of_values
from quietarm.ocp.solvers.node import PathFunctions
from quietarm.ocp.task import QUANTITIES

Array = NDArray[np.float64]
_BLOCKS, _MANY = (1, 2, 4, 8), 100
"""Rows of a compiled call with derivatives, of which more rows take several; and of one without."""
_LEAST_STRETCH = 1e-3
"""Share of the largest speed below which a direction in a box counts as this share."""
_PADDED = 200
"""So many times a larger function serves, its other rows idle, before one is built that fits."""


@dataclass(frozen=True)
class Values:
    """What candidates cost; rows are candidates.

    Attributes
    ----------
    energy : ndarray, shape (rows,)
        F2 [J], with its sign changes resolved.
    arrival : ndarray, shape (rows, 2 * modes)
        W [m], then W' [m/s].
    limited : ndarray, shape (rows, values)
        Each limited quantity at the nodes, one after another.
    """

    energy: Array
    arrival: Array
    limited: Array


@dataclass(frozen=True)
class Derivatives(Values):
    """The same with derivatives by the coefficients.

    Attributes
    ----------
    gradient : ndarray, shape (rows, coefficients)
        Of the energy, with the zeros of the power held fixed, which is exact.
    by_arrival : ndarray, shape (rows, 2 * modes, coefficients)
        Of the arrival.
    by_limited : ndarray, shape (rows, values, coefficients)
        Of the limited quantities.
    curvature : ndarray, shape (rows, coefficients, coefficients)
        Second derivatives of the Lagrangian.
    """

    gradient: Array
    by_arrival: Array
    by_limited: Array
    curvature: Array


class Batch:
    """A plant's motion along a profile in a number of steps, for many candidates at once."""

    def __init__(self, kind: Kind) -> None:
        self.kind = kind
        self._built: dict[int, BufferedFunction] = {}
        self._lent = dict.fromkeys(_BLOCKS, 0)
        self._valued, self._singles = dict[int, ca.Function](), 0
        self._idle: dict[int, list[BufferedFunction]] = {1: [], _MANY: []}

    def even_axes(self, boxed: bool = False) -> Array:
        """Axes along which the path's speed changes alike and independently.

        The powers of T of a polynomial are nearly the same function from about ten terms on.
        Coefficients are these axes times the unknowns of a program; the identity where the
        coefficients enter nonlinearly. Speeds, since with positions a step along an axis that
        wriggles often would bend the constraints far more than along one that does not: plants of
        8 modes took ten times the iterations. With a box on the coefficients directions that
        hardly matter are stretched less: else the box is so thin along them that rounding loses it.
        """
        columns = self._speeds
        if columns is None:
            return np.eye(self.kind.profile.size)
        if boxed:
            least = _LEAST_STRETCH * np.linalg.norm(columns, 2)
            columns = np.concatenate([columns, least * np.eye(self.kind.profile.size)])
        triangle: Any = np.linalg.qr(columns, mode="r")
        return np.linalg.inv(triangle) * triangle[0, 0]

    @cached_property
    def _speeds(self) -> Array | None:
        """By each coefficient the path's speed at the nodes; None if not linear."""
        path = PathFunctions(self.kind.profile, self.kind.steps, jerk=False)
        if not path.linear:
            return None
        times, length = Grid(self.kind.steps).columns()
        at_nodes = [[np.array(slope[1]).ravel() for slope in path.slopes(at)] for at in times]
        speeds = np.array(at_nodes) * np.sqrt(np.array(length).ravel())
        return speeds.transpose(0, 2, 1).reshape(-1, self.kind.profile.size)

    def _function(self, rows: int) -> tuple[int, BufferedFunction]:
        """One for so many rows or more: to build one takes as long as hundreds of its calls."""
        fitting = next(size for size in _BLOCKS if size >= rows)
        larger = [size for size in self._built if size >= rows]
        if fitting not in self._built and larger and self._lent[fitting] < _PADDED:
            self._lent[fitting] += 1
            fitting = min(larger)
        if fitting not in self._built:
            self._built[fitting] = BufferedFunction(function_of_derivatives(self.kind, fitting))
        return fitting, self._built[fitting]

    @property
    def parts(self) -> list[tuple[str, slice]]:
        """Where the values of each limited quantity stand among all."""
        found = list[tuple[str, slice]]()
        for name in self.kind.quantities:
            first = found[-1][1].stop if found else 0
            count = QUANTITIES[name].rows(self.kind.plant) * NODES * self.kind.steps
            found.append((name, slice(first, first + count)))
        return found

    def _for_values(self, rows: int) -> int:
        """Rows of the function that values are asked of: one for who asks for single ones often."""
        self._singles += rows == 1
        size = 1 if rows == 1 and self._singles > _PADDED else _MANY
        if size not in self._valued:
            self._valued[size] = function_of_values(self.kind, size)
        return size

    @keep_interrupts()  # casadi loses a Ctrl-C
    def values(self, coefficients: Array, move: Array, errors: Array, threads: int = 1) -> Values:
        """Evaluate candidates without derivatives, a block of them for each thread at a time.

        Arguments as for `derivatives`; the energy takes in what neighbouring steps say, and is a
        little more exact.
        """
        size = self._for_values(len(coefficients))
        blocks = _blocks((coefficients, move, errors), size)
        evaluate = partial(self._values, size)
        if threads > 1 and len(blocks) > 1:
            with ThreadPoolExecutor(threads) as pool:
                parts = list(pool.map(evaluate, blocks))
        else:
            parts = [evaluate(block) for block in blocks]
        energy, arrival, limited = (np.concatenate(part) for part in zip(*parts, strict=True))
        return Values(energy[:, 0], arrival, limited)

    def _values(self, size: int, block: list[Array]) -> list[Array]:
        try:
            function = self._idle[size].pop()
        except IndexError:  # all are in use by other threads, or none is made yet
            function = BufferedFunction(self._valued[size])
        rows = len(block[0])
        found = function(*(_filled(one, size).T for one in block))
        copies = [one[:, :rows].T.copy() for one in found]
        self._idle[size].append(function)
        return copies

    def derivatives(
        self,
        coefficients: Array,
        move: Array,
        errors: Array,
        width: Array,
        weights: tuple[Array, Array, Array],
    ) -> Derivatives:
        """Evaluate candidates with first derivatives, and second ones of a weighted sum.

        A row is a candidate: coefficients, move (the `row` of its task), relative errors of the
        plant, the power [W] over which |power| is rounded off, and the weights of
        energy, arrival (2 * modes) and limited values in `curvature`.
        """
        inputs = [coefficients, move, errors, width[:, None], weights[0][:, None], *weights[1:]]
        parts = [self._block(block) for block in _blocks(inputs, _BLOCKS[-1])]
        return Derivatives(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def _block(self, inputs: list[Array]) -> tuple[Array, ...]:
        rows, size = len(inputs[0]), self.kind.profile.size
        fitting, function = self._function(rows)
        raw = function(*(_filled(one, fitting).T for one in inputs))

        def by_coefficient(one: Array) -> Array:
            """From (values, coefficients, steps; rows) to (rows; coefficients; values, steps)."""
            apart = one.reshape(-1, size, self.kind.steps, fitting)[..., :rows]
            return apart.transpose(3, 1, 0, 2).reshape(rows, size, -1)

        # copies: the next call overwrites the function's own
        energy, arrival, limited, gradient, by_arrival = (one[:, :rows].T.copy() for one in raw[:5])
        by_limited, left, right = (by_coefficient(one) for one in raw[5:8])
        curvature = left @ right.transpose(0, 2, 1)
        if raw[8].size:
            curvature += raw[8][:, :rows].T.reshape(rows, size, size)
        return (
            energy[:, 0], arrival, limited, gradient, by_arrival.reshape(rows, -1, size),
            by_limited.transpose(0, 2, 1), curvature,
        )  # fmt: skip


def _filled(rows: Array, count: int) -> Array:
    """So many rows: these, again and again."""
    return np.resize(rows, (count, rows.shape[1]))


def _blocks(arrays: Sequence[Array], most: int) -> list[list[Array]]:
    """The arrays' rows, so many at a time; one block where there are none."""
    firsts = range(0, max(len(arrays[0]), 1), most)
    return [[one[first : first + most] for one in arrays] for first in firsts]


@lru_cache(maxsize=32)
def batch(
    plant: Plant,
    profile: JointProfile,
    steps: int,
    quantities: tuple[str, ...] = (),
    errors: tuple[str, ...] = (),
    energy: Energy = ABSOLUTE_POWER,
    breaks: tuple[float, ...] = (),
) -> Batch:
    """The compiled functions of a plant, a profile and a number of steps."""
    return Batch(Kind(plant, profile, steps, quantities, errors, energy, breaks))
