"""Problems of one form as the nonlinear programs that `funnel.minimise` takes, a row each.

Unknowns are the coefficients along even axes, and last the peak that is minimised, where one is.
Objective, equalities and what is bounded are scaled; the coefficients' box comes last. Each kind of
constraint is a class: it gives its values and their Jacobian from the derivatives of the motions,
and adds its multipliers to those of the motions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.solvers.batch import Derivatives, MotionMultipliers
from quietarm.ocp.solvers.problem import Program
from quietarm.ocp.solvers.quadratic import Model, Multipliers

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class _Constraint(ABC):
    """Values within bounds, both of shape (problems, values)."""

    lower: Array
    upper: Array

    @property
    def count(self) -> int:
        """Number of values of the quantity."""
        return self.upper.shape[1]

    @abstractmethod
    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        """Values (rows, count) and Jacobian (rows, count, n) at the unknowns x (rows, n).

        Derivatives of the motions are by scenario and along the unknowns.
        """

    @abstractmethod
    def pull_back(self, rows: Index, multipliers: Array, onto: MotionMultipliers) -> None:
        """Add multipliers of the values (rows, count) to those of the motions, by scenario."""


class _ResidualLimit(_Constraint):
    """The tip displacements after arrival in every scenario, at the times that can be largest."""

    def __init__(self, tips: Array, limit: Array) -> None:
        """Tips have shape (problems, scenarios, times, 2 * modes), scaled; limits (problems,)."""
        self._tips = tips
        self.upper = np.repeat(
            limit[:, None],
            tips.shape[1] * tips.shape[2],
            axis=1,
        )
        self.lower = -self.upper

    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        tips = self._tips[rows]
        count = len(rows)
        n = x.shape[1]
        values = np.einsum("rstk,rsk->rst", tips, motions.arrival).reshape(count, self.count)
        return values, (tips @ motions.arrival_jacobian).reshape(count, self.count, n)

    def pull_back(self, rows: Index, multipliers: Array, onto: MotionMultipliers) -> None:
        tips = self._tips[rows]
        onto.arrival[:] += np.einsum(
            "rst,rstk->rsk",
            multipliers.reshape(tips.shape[:3]),
            tips,
        )


class _QuantityLimit(_Constraint):
    """A quantity at the nodes of the steps, of the nominal plant or in all scenarios."""

    def __init__(self, place: slice, scenarios: int, bounds: Array, scale: Array) -> None:
        """Take the place among the limited values; bounds (problems, 2) and scales (problems,)."""
        self._scenarios = slice(0, scenarios)
        self._place = place
        self._scale = scale[:, None]
        values = scenarios * (place.stop - place.start)
        self.lower, self.upper = (
            np.repeat(side[:, None], values, axis=1) for side in (bounds / self._scale).T
        )

    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        del x
        count = len(rows)
        scale = self._scale[rows]
        values = motions.limited[:, self._scenarios, self._place].reshape(count, self.count) / scale
        jacobian = motions.limited_jacobian[:, self._scenarios, self._place]
        return values, jacobian.reshape(*values.shape, jacobian.shape[-1]) / scale[:, :, None]

    def pull_back(self, rows: Index, multipliers: Array, onto: MotionMultipliers) -> None:
        part = onto.limited[:, self._scenarios, self._place]
        part += (multipliers / self._scale[rows]).reshape(part.shape)


class _Peak(_Constraint):
    """A constraint whose peak p is the last unknown: v - p <= 0 <= v + p, as of `Limit.peak`."""

    def __init__(self, of: _Constraint, limit: Limit) -> None:
        self._of = of
        self._limit = limit
        zero = np.zeros(of.upper.shape)
        free = np.full(of.upper.shape, np.inf)
        self.upper = np.hstack([zero, free])
        self.lower = np.hstack([-free, zero])

    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        values, jacobian = self._of.evaluate(rows, motions, x)
        unit = np.ones((*values.shape, 1))
        peak = x[:, -1:]
        below, above = self._limit.sides
        by_peak = [
            np.concatenate([jacobian[:, :, :-1], -side * unit], axis=2) for side in (above, below)
        ]
        bounded = np.hstack([values - above * peak, values - below * peak])
        return bounded, np.concatenate(by_peak, axis=1)

    def pull_back(self, rows: Index, multipliers: Array, onto: MotionMultipliers) -> None:
        below, above = np.split(multipliers, 2, axis=1)
        self._of.pull_back(rows, below + above, onto)

    def largest(self, rows: Index, motions: Derivatives, x: Array) -> Array:
        """The peaks, shape (rows,)."""
        values = self._of.evaluate(rows, motions, x)[0]
        return self._limit.peak(values.min(axis=1), values.max(axis=1))


class _Box(_Constraint):
    """The coefficients that have bounds of their own, linear in the unknowns."""

    def __init__(self, lower: Array, upper: Array, axes: Array) -> None:
        """Bounds have shape (problems, profile.size); coefficients are axes @ unknowns."""
        bounded = np.isfinite(np.stack([lower, upper])).any(axis=(0, 1))
        self.lower = lower[:, bounded]
        self.upper = upper[:, bounded]
        self._axes = axes[bounded]

    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        jacobian = np.repeat(self._axes[None], len(rows), axis=0)
        return x @ self._axes.T, jacobian

    def pull_back(self, rows: Index, multipliers: Array, onto: MotionMultipliers) -> None:
        """Nothing, as it is linear."""


class Programs:
    """Problems of the same profile, steps, limited quantities, and kinds of residual and peak.

    Bounded values have bounds `lower` and `upper`, (problems, bounded), and are those of the
    `constraints` one after another: of the residual and each limited quantity by name, and of the
    box, the last `linear` ones. The `weights`, (problems, 2), are of the scaled energy and peak.
    """

    def __init__(self, problems: Sequence[Program]) -> None:
        self._problems = problems
        first = problems[0]
        self._batch = first.batch
        self._size = first.profile.size
        self._scenarios = len(first.errors)
        self._peak = first.peak
        self._at_rest = first.at_rest
        self.unknowns = self._size + (self._peak is not None)
        self.equalities = first.wanted.size if self._at_rest else 0
        shape = self._scenarios, first.wanted.size
        moves = list[tuple[float, ...]]()
        errors = list[Array]()
        energies = list[float]()
        arrivals = list[Array]()
        offsets = list[Array]()
        weights = list[tuple[float, float]]()
        for problem in problems:
            energy = problem.energy_scale
            peak = problem.scale_of(self._peak) if self._peak else 0.0
            moves.append(problem.task.row)
            errors.append(problem.errors)
            energies.append(energy)
            arrivals.append(problem.arrival_scale)
            offsets.append(np.broadcast_to(problem.offset - problem.wanted, shape))
            weights.append(problem.weights(energy, peak))
        self._move = np.array(moves)
        self._errors = np.array(errors)
        self._energy = np.array(energies)
        self._arrival = np.array(arrivals)
        self._offset = np.array(offsets)
        self.weights = np.array(weights)
        self._constrain(first.bounds_residual)

    def _constrain(self, bounds_residual: bool) -> None:
        """Everything that is bounded, the bounds last."""
        constraints = dict[str, _Constraint]()
        if bounds_residual:
            limit = np.array([entry.residual_limit for entry in self._problems])
            constraints[RESIDUAL] = _ResidualLimit(self._tips(), limit / self._scales(RESIDUAL))
        limits = self._problems[0].limits_of_task
        for name, place in self._batch.places.items():
            scenarios = self._scenarios if limits[name].quantity.in_scenarios else 1
            bounds = self._bounds(name)
            constraints[name] = _QuantityLimit(place, scenarios, bounds, self._scales(name))
        if self._peak is not None:
            constraints[self._peak] = _Peak(constraints[self._peak], limits[self._peak])
        boxes = [problem.profile.box(problem.bound) for problem in self._problems]
        self._box = np.array(boxes).transpose(1, 0, 2)
        self._axes = self._batch.even_axes(boxed=bool(np.isfinite(self._box).any()))
        # the coefficients by all unknowns
        self._along = np.pad(self._axes, ((0, 0), (0, self.unknowns - self._size)))
        box = _Box(self._box[0], self._box[1], self._along)
        self.linear = box.count
        self.constraints = {**constraints, "box": box}
        stops = np.cumsum([entry.count for entry in self.constraints.values()]).tolist()
        places = (slice(begin, end) for begin, end in pairwise([0, *stops]))
        self._places = dict(zip(self.constraints, places))
        self.lower = np.hstack([entry.lower for entry in self.constraints.values()])
        self.upper = np.hstack([entry.upper for entry in self.constraints.values()])

    def _bounds(self, name: str) -> Array:
        """Least and largest value in each problem, infinite where it is not limited."""
        bounds = np.array([[-np.inf, np.inf]] * len(self._problems))
        for i, problem in enumerate(self._problems):
            for limit in problem.limits:
                if limit.name == name:
                    bounds[i] = limit.lower, limit.upper
        return bounds

    def _scales(self, name: str) -> Array:
        return np.array([problem.scale_of(name) for problem in self._problems])

    def _tips(self) -> Array:
        """Rows that give the scaled tip displacements of every scenario, filled up with zeros."""
        most = max(len(rows) for problem in self._problems for rows in problem.tip_rows)
        tips = list[list[Array]]()
        for problem, scale in zip(self._problems, self._scales(RESIDUAL)):
            padded = (np.pad(rows, ((0, most - len(rows)), (0, 0))) for rows in problem.tip_rows)
            tips.append([rows / scale for rows in padded])
        return np.array(tips)

    def start(self, coefficients: Array) -> Array:
        """Unknowns of given coefficients, one row each."""
        x: Any = np.linalg.solve(self._axes, coefficients.T).T
        if self._peak is not None:
            rows = np.arange(len(x))
            peak = self.constraints[self._peak]
            x = np.column_stack([x, np.zeros(len(x))])
            assert isinstance(peak, _Peak)
            x[:, -1] = peak.largest(
                rows,
                self._simulate(rows, x, None, np.zeros(len(x))),
                x,
            )
        return x

    def coefficients(self, x: Array) -> Array:
        """The coefficients of unknowns, within their bounds, which rounding may pass."""
        return np.clip(x[:, : self._size] @ self._axes.T, *self._box)

    def split(self, bounded: Array) -> dict[str, Array]:
        """Multipliers of what is bounded by name of the constraint."""
        return {name: bounded[:, place] for name, place in self._places.items()}

    def evaluate(self, rows: Index, x: Array, multipliers: Multipliers, width: Array) -> Model:
        """Evaluate the model of rows at their unknowns, for `funnel.RowPrograms`."""
        motions = self._simulate(rows, x, multipliers, width)
        scale = self._arrival[rows]
        weights = self.weights[rows]
        of_energy = weights[:, 0] / self._energy[rows]
        at = slice(0, int(self._at_rest))
        constraints = self.constraints.values()
        bounded, jacobians = zip(*(entry.evaluate(rows, motions, x) for entry in constraints))
        objective = of_energy * motions.energy[:, 0]
        gradient = of_energy[:, None] * motions.gradient[:, 0]
        if self._peak is not None:
            objective += weights[:, 1] * x[:, -1]
            gradient[:, -1] = weights[:, 1]
        arrival = (motions.arrival / scale[:, None, :])[:, at]
        jacobian = (motions.arrival_jacobian / scale[:, None, :, None])[:, at]
        count = len(rows)
        return Model(
            objective=objective,
            gradient=gradient,
            equality=arrival.reshape(count, self.equalities),
            equality_jacobian=jacobian.reshape(count, self.equalities, self.unknowns),
            bounded=np.hstack(bounded),
            bounded_jacobian=np.concatenate(jacobians, axis=1),
            hessian=motions.hessian.sum(axis=1),
        )

    def _simulate(
        self, rows: Index, x: Array, multipliers: Multipliers | None, width: Array
    ) -> Derivatives:
        """Motions in all scenarios with derivatives by the unknowns; of arrivals what is missed."""
        coefficients = x[:, : self._size] @ self._axes.T
        of_motions = None if multipliers is None else self._pull_back(rows, multipliers)
        derivatives = self._batch.in_scenarios(
            coefficients,
            self._move[rows],
            self._errors[rows],
            width * self._energy[rows] / self._move[rows, 2],
            of_motions,
        )
        along = self._along
        return Derivatives(
            energy=derivatives.energy,
            arrival=derivatives.arrival + self._offset[rows],
            limited=derivatives.limited,
            gradient=derivatives.gradient @ along,
            arrival_jacobian=derivatives.arrival_jacobian @ along,
            limited_jacobian=derivatives.limited_jacobian @ along,
            hessian=along.T @ derivatives.hessian @ along,
        )

    def _pull_back(self, rows: Index, multipliers: Multipliers) -> MotionMultipliers:
        """Multipliers of every motion's energy, arrival and limited values, by scenario."""
        count = len(rows)
        scenarios = self._scenarios
        onto = MotionMultipliers(
            energy=np.zeros((count, scenarios)),
            arrival=np.zeros((count, scenarios, self._arrival.shape[1])),
            limited=np.zeros((count, scenarios, self._batch.limited)),
        )
        onto.energy[:, 0] = self.weights[rows, 0] / self._energy[rows]
        if self._at_rest:
            onto.arrival[:, 0] += multipliers.equality / self._arrival[rows]
        for name, of_constraint in self.split(multipliers.bounded).items():
            self.constraints[name].pull_back(rows, of_constraint, onto)
        return onto
