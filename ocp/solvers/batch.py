"""Candidates in rows: the values of the evaluator with exact derivatives.

A row is a candidate with a move and errors of the plant of its own. `derivatives` builds the
expressions; here they are compiled for blocks of rows and called.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any, Self

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models.compiled import RECENT, Compiled
from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.cost import COST
from quietarm.ocp.simulation.collocation import NODES
from quietarm.ocp.simulation.evaluator import Values
from quietarm.ocp.simulation.rollout import Simulation, places_of
from quietarm.ocp.simulation.rows import RowFunction, copy_rows
from quietarm.ocp.solvers.derivatives import compile_derivatives
from quietarm.ocp.solvers.node import path_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MotionMultipliers:
    """Weights of the sum of energy, arrival and limited values whose Hessian is asked for.

    Shapes are those of `Values`; or with an axis of scenarios after the first.
    """

    energy: Array
    arrival: Array
    limited: Array

    def by_row(self) -> Self:
        """The rows of candidates, one after another, from arrays by candidate and scenario."""
        return type(self)(**{name: np.concatenate(part) for name, part in vars(self).items()})


@dataclass(frozen=True)
class Derivatives(Values):
    """The same with derivatives by the coefficients, along a last axis of each.

    The Hessian, (rows, coefficients, coefficients), is of the sum that the multipliers weigh. The
    energy's gradient has the zeros of the power fixed, which is exact.
    """

    gradient: Array
    arrival_jacobian: Array
    limited_jacobian: Array
    hessian: Array

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

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        build = partial(compile_derivatives, simulation)
        self._derivatives = RowFunction(build, sizes=(1, 4, 8))

    @cached_property
    def _steps(self) -> int:
        """How many there are: some more than asked for where the motion breaks."""
        return len(self.simulation.mesh.lengths)

    @cached_property
    def places(self) -> Mapping[str, slice]:
        """Where the values of each limited quantity stand among all."""
        return places_of(self.simulation)

    @cached_property
    def limited(self) -> int:
        """How many values of limited quantities there are."""
        return max((place.stop for place in self.places.values()), default=0)

    @on_one_thread
    def even_axes(self, boxed: bool = False) -> Array:
        """Axes along which the path's speed changes alike and independently.

        The powers of T of a polynomial are nearly the same function from about ten terms on.
        Coefficients are these axes times the unknowns of a program; the identity where the
        coefficients enter nonlinearly. With positions in place of speeds plants of 8 modes took ten
        times the iterations. With a box on the coefficients directions that hardly matter are
        stretched less: else the box is so thin along them that rounding loses it.
        """
        columns = Compiled.guard(lambda: self._speeds)
        if columns is None:
            return np.eye(self.simulation.profile.size)
        if boxed:
            # No direction counts for less than this share of the fastest.
            least = 1e-3 * np.linalg.norm(columns, 2)
            columns = np.concatenate([columns, least * np.eye(self.simulation.profile.size)])
        triangle: Any = np.linalg.qr(columns, mode="r")
        return np.linalg.inv(triangle) * triangle[0, 0]

    @cached_property
    def _speeds(self) -> Array | None:
        """The path's speed at the nodes by each coefficient; None if it is not linear in them."""
        size = self.simulation.profile.size
        mesh = self.simulation.mesh
        path = path_of(self.simulation.profile, mesh, False, 1)
        if not path.linear:
            return None
        table = path.jacobian([0.0] * size, [])
        weights = np.sqrt(np.tile(mesh.lengths, NODES))
        speeds = [table.get((1, n), ca.DM.zeros(1, len(weights))).full()[0] for n in range(size)]
        return (weights * np.array(speeds)).T

    @on_one_thread
    def derivatives(
        self,
        coefficients: Array,
        move: Array,
        errors: Array,
        width: Array | None = None,
        multipliers: MotionMultipliers | None = None,
    ) -> Derivatives:
        """Evaluate candidates with first derivatives, and second ones of a weighted sum.

        A row has coefficients (profile.size,), the `row` of its task (3 + 2 * modes,), relative
        errors of its plant, and the power [W] over which |power| is rounded off; the multipliers
        are those of the sum whose Hessian is asked for.
        """
        rows = len(coefficients)
        states = 2 * self.simulation.plant.modes
        COST.gradients += rows
        COST.hessians += rows if multipliers is not None else 0
        width = np.zeros(rows) if width is None else width
        weights = multipliers or MotionMultipliers(
            energy=np.zeros(rows),
            arrival=np.zeros((rows, states)),
            limited=np.zeros((rows, self.limited)),
        )
        inputs = [
            coefficients,
            move,
            errors,
            width[:, None],
            weights.energy[:, None],
            weights.arrival,
            weights.limited,
        ]
        unpack = self._unpack_first if multipliers is None else self._unpack
        return Derivatives(*self._derivatives(inputs, unpack))

    def prepare(self, rows: int) -> None:
        """Build the derivatives for so many rows first, for single ones are evaluated before."""
        self._derivatives.prepare(rows)

    def _unpack(self, outputs: list[Array], rows: int) -> tuple[Array, ...]:
        """What `Derivatives` holds; a column of the outputs is a candidate."""
        size = self.simulation.profile.size
        sensitivities = self._by_coefficient(outputs[6], rows)
        curved = self._by_coefficient(outputs[7], rows)
        hessian = sensitivities @ curved.swapaxes(1, 2)
        if outputs[8].size:
            hessian += outputs[8][:, :rows].T.reshape(rows, size, size)
        return (*self._unpack_first(outputs, rows)[:-1], hessian)

    def _unpack_first(self, outputs: list[Array], rows: int) -> tuple[Array, ...]:
        """The same without second derivatives: they are those of no sum."""
        size = self.simulation.profile.size
        energy, arrival, limited, gradient, arrival_jacobian = copy_rows(outputs[:5], rows)
        limited_jacobian = self._by_coefficient(outputs[5], rows)
        return (
            energy[:, 0],
            arrival,
            limited,
            gradient,
            arrival_jacobian.reshape(rows, -1, size),
            limited_jacobian.swapaxes(1, 2),
            np.zeros((rows, size, size)),
        )

    def _by_coefficient(self, output: Array, rows: int) -> Array:
        """From (value, coefficient, step; candidate) to (candidate; coefficient; value, step)."""
        size = self.simulation.profile.size
        by_axis = output.reshape(-1, size, self._steps, output.shape[1])[..., :rows]
        return by_axis.transpose(3, 1, 0, 2).reshape(rows, size, -1)


batch_of = lru_cache(maxsize=RECENT)(Batch)
"""A batch that is kept for the next who asks for it."""
