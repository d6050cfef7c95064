"""Candidates in rows: what each costs, leaves and asks of the joint, with exact derivatives.

A row is a candidate with a move and errors of the plant of its own. `derivatives` builds the
expressions; here they are compiled for blocks of rows and called.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any, Self

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
from quietarm.ocp.solvers.derivatives import Kind, compile_derivatives, compile_values
from quietarm.ocp.solvers.node import Path
from quietarm.ocp.task import QUANTITIES

Array = NDArray[np.float64]
_FEW, _SOME, _MANY = 1, 4, 100
"""Rows of a compiled call: of derivatives for one candidate or for more, and of values alone."""
_LEAST_STRETCH = 1e-3
"""Share of the largest speed below which a direction in a box counts as this share."""
_PADDED = 200
"""So many times single rows are padded to the next block before a function of one is built."""


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
        Each limited quantity at the nodes; `Batch.places` tells where.
    """

    energy: Array
    arrival: Array
    limited: Array


@dataclass(frozen=True)
class Multipliers:
    """What weighs the Hessian of a sum of energy, arrival and limited quantities.

    Attributes
    ----------
    energy : ndarray, shape (rows,)
    arrival : ndarray, shape (rows, 2 * modes)
    limited : ndarray, shape (rows, values)
    """

    energy: Array
    arrival: Array
    limited: Array

    def by_row(self) -> Self:
        """The rows of candidates, one after another, from arrays by candidate and scenario."""
        return type(self)(**{name: np.concatenate(part) for name, part in vars(self).items()})


@dataclass(frozen=True)
class Derivatives(Values):
    """The same with derivatives by the coefficients.

    Attributes
    ----------
    gradient : ndarray, shape (rows, coefficients)
        Of the energy, with the zeros of the power held fixed, which is exact.
    arrival_jacobian : ndarray, shape (rows, 2 * modes, coefficients)
        Of the arrival.
    limited_jacobian : ndarray, shape (rows, values, coefficients)
        Of the limited quantities.
    hessian : ndarray, shape (rows, coefficients, coefficients)
        Of the sum that the multipliers weigh.
    """

    gradient: Array
    arrival_jacobian: Array
    limited_jacobian: Array
    hessian: Array

    def take(self, rows: slice) -> Self:
        """Some rows."""
        return type(self)(**{name: part[rows] for name, part in vars(self).items()})

    def by_scenario(self, scenarios: int) -> Self:
        """Arrays of shape (candidates, scenarios, ...) from rows that are pairs of these."""
        return type(self)(
            **{
                name: part.reshape(len(part) // scenarios, scenarios, *part.shape[1:])
                for name, part in vars(self).items()
            }
        )


class Batch:
    """A plant's motion along a profile in a number of steps, for many candidates at once."""

    def __init__(self, kind: Kind) -> None:
        self.kind = kind
        self._compiled = dict[int, BufferedFunction]()
        self._padded = 0
        self._valued, self._singles = dict[int, ca.Function](), 0
        self._idle: dict[int, list[BufferedFunction]] = {1: [], _MANY: []}

    @cached_property
    def places(self) -> dict[str, slice]:
        """Where the values of each limited quantity stand among all."""
        places, first = dict[str, slice](), 0
        for name in self.kind.quantities:
            count = QUANTITIES[name].rows(self.kind.plant) * NODES * self.kind.steps
            places[name] = slice(first, first + count)
            first += count
        return places

    @property
    def limited(self) -> int:
        """How many values of limited quantities there are."""
        return max((place.stop for place in self.places.values()), default=0)

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
        """The path's speed at the nodes by each coefficient; None if it is not linear in them."""
        steps, size = self.kind.steps, self.kind.profile.size
        path = Path(self.kind.profile, steps, False, (1, steps))
        if not path.linear:
            return None
        times, length = Grid(steps).columns()
        speeds = np.zeros((size, NODES, steps))
        for j, at in enumerate(times):
            for (value, n), entry in path.jacobian([], at, []).items():
                if value == 1:
                    speeds[n, j] = ca.evalf(entry).full() * np.sqrt(length.full())
        return speeds.reshape(size, -1).T

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

    def _for_values(self, rows: int) -> int:
        """Rows of the function that values are asked of: one for who asks for single ones often."""
        self._singles += rows == 1
        size = 1 if rows == 1 and self._singles > _PADDED else _MANY
        if size not in self._valued:
            self._valued[size] = compile_values(self.kind, size)
        return size

    def _values(self, size: int, block: list[Array]) -> list[Array]:
        try:
            function = self._idle[size].pop()
        except IndexError:  # all are in use by other threads, or none is made yet
            function = BufferedFunction(self._valued[size])
        rows = len(block[0])
        found = function(*(_fill(one, size).T for one in block))
        copies = [one[:, :rows].T.copy() for one in found]
        self._idle[size].append(function)
        return copies

    def derivatives(
        self,
        coefficients: Array,
        move: Array,
        errors: Array,
        width: Array | None = None,
        multipliers: Multipliers | None = None,
    ) -> Derivatives:
        """Evaluate candidates with first derivatives, and second ones of a weighted sum.

        Parameters
        ----------
        coefficients : ndarray, shape (rows, profile.size)
            Candidates.
        move : ndarray, shape (rows, 3 + 2 * modes)
            The `row` of each candidate's task.
        errors : ndarray, shape (rows, ranges)
            Relative errors of each candidate's plant.
        width : ndarray, shape (rows,), optional
            The power [W] over which |power| is rounded off; none by default.
        multipliers : Multipliers, optional
            Of the sum whose Hessian is asked for; zeros by default.
        """
        rows, states = len(coefficients), 2 * self.kind.plant.modes
        width = np.zeros(rows) if width is None else width
        weights = multipliers or Multipliers(
            np.zeros(rows), np.zeros((rows, states)), np.zeros((rows, self.limited))
        )
        inputs = [coefficients, move, errors, width[:, None], weights.energy[:, None],
                  weights.arrival, weights.limited]  # fmt: skip
        parts = [self._block(block) for block in _blocks(inputs, 2 * _SOME)]
        return Derivatives(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def _function(self, rows: int) -> tuple[int, BufferedFunction]:
        """One for so many rows or more: to build one takes as long as hundreds of its calls."""
        size = _SOME if rows <= _SOME else 2 * _SOME
        if rows == 1:
            self._padded += 1
            size = _FEW if self._padded > _PADDED else _SOME
        if size not in self._compiled:
            self._compiled[size] = BufferedFunction(compile_derivatives(self.kind, size))
        return size, self._compiled[size]

    def _block(self, inputs: list[Array]) -> tuple[Array, ...]:
        rows, size = len(inputs[0]), self.kind.profile.size
        filled, function = self._function(rows)
        outputs = function(*(_fill(one, filled).T for one in inputs))

        def by_coefficient(one: Array) -> Array:
            """From (values, coefficients, steps; rows) to (rows; coefficients; values, steps)."""
            apart = one.reshape(-1, size, self.kind.steps, filled)[..., :rows]
            return apart.transpose(3, 1, 0, 2).reshape(rows, size, -1)

        # copies: the next call overwrites the function's own
        copies = [one[:, :rows].T.copy() for one in outputs[:5]]
        energy, arrival, limited, gradient, arrival_jacobian = copies
        limited_jacobian, left, right = (by_coefficient(one) for one in outputs[5:8])
        hessian = left @ right.transpose(0, 2, 1)
        if outputs[8].size:
            hessian += outputs[8][:, :rows].T.reshape(rows, size, size)
        return (
            energy[:, 0], arrival, limited, gradient, arrival_jacobian.reshape(rows, -1, size),
            limited_jacobian.transpose(0, 2, 1), hessian,
        )  # fmt: skip


def _fill(rows: Array, count: int) -> Array:
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
