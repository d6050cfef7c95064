"""Candidates in rows: the values of the evaluator with exact derivatives.

A row is a candidate with a move and errors of the plant of its own. `derivatives` builds the
expressions; here they are compiled for blocks of rows and called.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import Any, Self

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models.compiled import RECENT, Compiled
from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.cost import COST
from quietarm.ocp.limits import ask_for_jerk
from quietarm.ocp.simulation.collocation import NODES
from quietarm.ocp.simulation.evaluator import RowValues
from quietarm.ocp.simulation.rollout import Simulation, places_of
from quietarm.ocp.simulation.rows import RowFunction, copy_rows
from quietarm.ocp.solvers.derivatives import compile_arrivals, compile_derivatives
from quietarm.ocp.solvers.node import path_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MotionMultipliers:
    """Weights of the sum of energy, arrival and limited values whose Hessian is asked for.

    Shapes are those of `RowValues`; or with an axis of scenarios after the first.
    """

    energy: Array
    arrival: Array
    limited: Array

    def by_row(self) -> Self:
        """The rows of candidates, one after another, from arrays by candidate and scenario."""
        return type(self)(**{name: np.concatenate(part) for name, part in vars(self).items()})

    def of_first(self) -> Self:
        """Return the arrays of the first scenario, of those by candidate and scenario."""
        return type(self)(**{name: part[:, 0] for name, part in vars(self).items()})


@dataclass(frozen=True)
class Derivatives(RowValues):
    """Values of motions with derivatives by the coefficients, along a last axis of each array.

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


@dataclass(frozen=True)
class _Arrivals:
    """States on arrival, their derivatives by the coefficients, and the Hessian of a weighted sum.

    Shapes (rows, 2 * modes), (rows, 2 * modes, coefficients) and (rows, coefficients,
    coefficients).
    """

    arrival: Array
    arrival_jacobian: Array
    hessian: Array


class Batch:
    """A plant's motion along a profile in a number of steps, for many candidates at once."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        build = partial(compile_derivatives, simulation)
        # equations of many terms take nearly as long a row in larger blocks, and longer to build
        has_few_terms = simulation.plant.steps_at_once == 1
        self._derivatives = RowFunction(
            build,
            (1, 4, 8) if has_few_terms else (1, 4),
            simulation.kept_as("derivatives"),
            patience=0 if has_few_terms else 300,
        )
        # of one size, since scenarios that join a problem would have another one built
        self._arrivals = RowFunction(
            partial(compile_arrivals, simulation),
            (4,) if has_few_terms else (2,),
            simulation.kept_as("arrivals"),
        )

    @cached_property
    def _steps(self) -> int:
        """Number of steps, which is larger than asked for if the motion breaks."""
        return len(self.simulation.mesh.lengths)

    @cached_property
    def places(self) -> Mapping[str, slice]:
        """Places of the values of each limited quantity among all."""
        return places_of(self.simulation)

    @cached_property
    def limited(self) -> int:
        """Number of values of limited quantities."""
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
        # the path of derivatives that are built: another takes as long as a part of them
        built = self._derivatives.built
        if self.simulation.errors and not built:
            return self._of_assumed_plant._speeds
        size = self.simulation.profile.size
        mesh = self.simulation.mesh
        rows = built[0] if built else 1
        path = path_of(
            self.simulation.profile, mesh, ask_for_jerk(self.simulation.quantities), rows
        )
        if not path.linear:
            return None
        table = path.jacobian([0.0] * size, [])
        weights = np.sqrt(np.tile(mesh.lengths, NODES))
        zero = ca.DM.zeros(1, len(weights))
        speeds = [table.get((1, n), zero).full()[0] for n in range(size)]
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

    @on_one_thread
    def _arrivals_of(
        self, coefficients: Array, move: Array, errors: Array, multipliers: Array | None = None
    ) -> _Arrivals:
        """The states on arrival alone, of rows as of `derivatives`: a fraction of the work.

        Multipliers are those of the states, (rows, 2 * modes).
        """
        rows = len(coefficients)
        size = self.simulation.profile.size
        COST.gradients += rows
        COST.hessians += rows if multipliers is not None else 0
        if multipliers is None:
            multipliers = np.zeros((rows, 2 * self.simulation.plant.modes))

        def unpack(outputs: list[Array], rows: int) -> tuple[Array, ...]:
            arrival, jacobian = copy_rows(outputs[:2], rows)
            hessian = self._hessian(outputs[2:], rows)
            return arrival, jacobian.reshape(rows, -1, size), hessian

        inputs = [coefficients, move, errors, multipliers]
        return _Arrivals(*self._arrivals(inputs, unpack))

    def in_scenarios(
        self,
        coefficients: Array,
        move: Array,
        errors: Array,
        width: Array | None = None,
        multipliers: MotionMultipliers | None = None,
    ) -> Derivatives:
        """Candidates in scenarios, the first without errors; arrays by candidate and scenario.

        Errors are (candidates, scenarios, errors), and multipliers by scenario. Energy and limited
        values are those of the first scenario alone, unless others count.
        """
        scenarios = errors.shape[1]
        if not self._splits(scenarios):
            return self.derivatives(
                np.repeat(coefficients, scenarios, axis=0),
                np.repeat(move, scenarios, axis=0),
                np.concatenate(errors),
                None if width is None else np.repeat(width, scenarios),
                None if multipliers is None else multipliers.by_row(),
            ).by_scenario(scenarios)
        others = scenarios - 1
        assumed = self._of_assumed_plant.derivatives(
            coefficients,
            move,
            np.zeros((len(move), 0)),
            width,
            None if multipliers is None else multipliers.of_first(),
        ).by_scenario(1)
        perturbed = self._arrivals_of(
            np.repeat(coefficients, others, axis=0),
            np.repeat(move, others, axis=0),
            np.concatenate(errors[:, 1:]),
            None if multipliers is None else np.concatenate(multipliers.arrival[:, 1:]),
        )
        both = {
            name: np.concatenate(
                [getattr(assumed, name), part.reshape(len(move), others, *part.shape[1:])], axis=1
            )
            for name, part in vars(perturbed).items()
        }
        return replace(assumed, **both)

    def prepare(self, candidates: int, scenarios: int = 1) -> None:
        """Build the derivatives for so many first, for single ones are evaluated before."""
        if self._splits(scenarios):
            self._of_assumed_plant.prepare(candidates)
            self._arrivals.prepare(candidates * (scenarios - 1))
        else:
            self._derivatives.prepare(candidates * scenarios)

    def _splits(self, scenarios: int) -> bool:
        """Return whether only the arrivals of the scenarios beyond the first count."""
        return scenarios > 1 and not any(
            quantity.in_scenarios for quantity in self.simulation.quantities
        )

    @cached_property
    def _of_assumed_plant(self) -> Batch:
        """The batch of rows without errors."""
        return batch_of(self.simulation._replace(errors=()))

    def _hessian(self, outputs: Sequence[Array], rows: int) -> Array:
        """The Hessian from its two factors, and what a path adds that is not linear."""
        size = self.simulation.profile.size
        hessian = np.zeros((rows, size, size))
        if outputs[0].size:
            sensitivities = self._by_coefficient(outputs[0], rows)
            hessian = sensitivities @ self._by_coefficient(outputs[1], rows).swapaxes(1, 2)
        if outputs[2].size:
            hessian += outputs[2][:, :rows].T.reshape(rows, size, size)
        return hessian

    def _unpack(self, outputs: list[Array], rows: int) -> tuple[Array, ...]:
        """Split outputs into the entries of `Derivatives`; a column is a candidate."""
        return (*self._unpack_first(outputs, rows)[:-1], self._hessian(outputs[6:], rows))

    def _unpack_first(self, outputs: list[Array], rows: int) -> tuple[Array, ...]:
        """Split outputs as `_unpack` does, without second derivatives, which belong to a sum."""
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
        """Turn (value, coefficient, step; candidate) into (candidate; coefficient; value, step)."""
        size = self.simulation.profile.size
        by_axis = output.reshape(-1, size, self._steps, output.shape[1])[..., :rows]
        return by_axis.transpose(3, 1, 0, 2).reshape(rows, size, -1)


batch_of = lru_cache(maxsize=RECENT)(Batch)
"""A batch that is kept for the next who asks for it."""
