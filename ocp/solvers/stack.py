"""Programs and what is asked of them, a row each, as `sqp.minimise` and IPOPT take them.

Unknowns are the coefficients along even axes, and the peak that is made least where one is.
Bounded are, in this order: the residual on every plant, at the times that can hold its largest
value; each limited quantity at the nodes; the deflection on plants with errors; where a peak is
made least, once more what it is the peak of; the coefficients that have a box. All are scaled.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.solvers.batch import Derivatives
from quietarm.ocp.solvers.program import Program
from quietarm.ocp.solvers.quadratic import Model
from quietarm.ocp.solvers.solution import ENERGY, RESIDUAL, Scalarization

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class Stack:
    """Rows of one form: the same profile, steps, limited quantities, kind of residual and of peak.

    Attributes
    ----------
    lower, upper : ndarray, shape (rows, bounded)
        Bounds of what is bounded.
    linear : int
        How many of these, the last, are linear in the unknowns.
    unknowns, equalities : int
        How many of each a row has.
    bounded : dict of str to slice
        Where the residual and each limited quantity stand.
    weights : ndarray, shape (rows, 2)
        Of the scaled energy and of the scaled peak, the larger of them 1.
    """

    def __init__(self, programs: Sequence[Program], asks: Sequence[Scalarization]) -> None:
        one, ask = programs[0], asks[0]
        self.batch, self.size = one.batch, one.profile.size
        self.least, self.at_rest, self.quantities = ask.least, ask.at_rest, one.parts
        self.unknowns = self.size + (ask.least is not None)
        self.equalities = one.scale.size if ask.at_rest else 0
        self.plants = len(one.errors)
        self._values = one.parts[-1][1].stop if one.parts else 0
        tips = [np.arange(self._values)[part] for name, part in one.parts if name == "deflection"]
        # which plant's which limited value is bounded: all of the first, of others the deflection
        chosen = [np.arange(self._values), *tips * (self.plants - 1)]
        self._value = np.concatenate(chosen)
        self._plant = np.repeat(np.arange(len(chosen)), [len(of) for of in chosen])
        self.weights = np.array([_weights(*pair) for pair in zip(programs, asks, strict=True)])
        self._move = np.array([program.row for program in programs])
        self._errors = np.array([program.errors for program in programs])
        self._scale = np.array([program.scale for program in programs])
        self._energy = np.array([program.energy for program in programs])
        self._offset = np.zeros((len(asks), self.plants, one.scale.size))
        for row, (program, each) in enumerate(zip(programs, asks, strict=True)):
            self._offset[row] = (0.0 if each.offset is None else each.offset) - program.wanted
        self._rests = self._residual_rows(programs, asks)
        self._set_bounds(programs, asks)

    def _residual_rows(self, programs: Sequence[Program], asks: Sequence[Scalarization]) -> Array:
        """What makes the scaled residual of the states on arrival; rows are filled up."""
        limited = any(np.isfinite(ask.limits.get(RESIDUAL, np.inf)) for ask in asks)
        if self.least != RESIDUAL and (self.at_rest or not limited):
            return np.zeros((len(asks), self.plants, 0, self._scale.shape[1]))
        most = max(len(rows) for program in programs for rows in program.tip_rows)
        return np.array([
            [
                np.pad(rows, ((0, most - len(rows)), (0, 0)))
                / program.scale_of(RESIDUAL)
                for rows in program.tip_rows
            ]
            for program in programs
        ])  # fmt: skip

    def _set_bounds(self, programs: Sequence[Program], asks: Sequence[Scalarization]) -> None:
        both, parts = list(zip(programs, asks, strict=True)), self.quantities
        scales, limits = np.ones((2, len(both), self._values))
        for row, (program, ask) in enumerate(both):
            for name, part in parts:
                scales[row, part] = scale = program.scale_of(name)
                limits[row, part] = ask.limits.get(name, np.inf) / scale
        self._scales = scales[:, self._value]
        first, left = self.plants * self._rests.shape[2], np.zeros(len(both))
        if first:
            left = [a.limits.get(RESIDUAL, np.inf) / p.scale_of(RESIDUAL) for p, a in both]
        of_rest = np.repeat(np.array(left)[:, None], first, axis=1)
        upper = np.concatenate([of_rest, limits[:, self._value]], axis=1)
        lower = -upper
        self.bounded = {RESIDUAL: slice(0, first)} if first else {}
        for name, part in parts:
            self.bounded[name] = slice(first + part.start, first + part.stop)
        self._peak = np.zeros(upper.shape[1], dtype=bool)
        if self.least is not None:
            self._peak[self.bounded[self.least]] = True
        lower[:, self._peak], upper[:, self._peak] = -np.inf, 0.0
        twice = np.zeros((len(both), self._peak.sum()))
        boxes = np.array([programs[0].profile.box(ask.bound) for ask in asks])
        self._boxed = np.flatnonzero(np.isfinite(boxes).any(axis=(0, 1)))
        self.linear = len(self._boxed)
        self.axes = self.batch.even_axes(boxed=self.linear > 0)
        self.lower = np.concatenate([lower, twice, boxes[:, 0, self._boxed]], axis=1)
        self.upper = np.concatenate([upper, twice + np.inf, boxes[:, 1, self._boxed]], axis=1)

    def start(self, coefficients: Array) -> Array:
        """Unknowns of given coefficients, one row each."""
        along: Any = np.linalg.solve(self.axes, coefficients.T).T
        if self.least is None:
            return along
        x, rows = np.column_stack([along, np.zeros(len(along))]), np.arange(len(along))
        none = np.zeros((len(x), self.equalities)), np.zeros(self.lower.shape)
        values = self.evaluate(rows, x, *none, np.zeros(len(x))).v[:, : self._peak.size]
        x[:, -1] = np.abs(values[:, self._peak]).max(axis=1)
        return x

    def coefficients(self, x: Array) -> Array:
        """The coefficients of unknowns."""
        along: Array = x[..., : self.size] @ self.axes.T
        return along

    def evaluate(self, rows: Index, x: Array, of_c: Array, of_v: Array, width: Array) -> Model:
        """The model of rows, as `sqp.Evaluate`."""
        count, plants = len(rows), self.plants
        a, weights = self.coefficients(x), self.weights[rows]
        of_energy = np.zeros((count, plants))
        of_energy[:, 0] = weights[:, 0] / self._energy[rows]
        of_arrival, of_limited = self._multipliers(rows, of_c, of_v)
        power = width * self._energy[rows] / self._move[rows, 2]
        flat = count * plants
        found = self.batch.derivatives(
            np.repeat(a, plants, axis=0),
            np.repeat(self._move[rows], plants, axis=0),
            self._errors[rows].reshape(flat, -1),
            np.repeat(power, plants),
            (of_energy.ravel(), of_arrival.reshape(flat, -1), of_limited.reshape(flat, -1)),
        )
        by_plant = Derivatives(
            **{
                name: part.reshape(count, plants, *part.shape[1:])
                for name, part in vars(found).items()
            }
        )
        model = self._model(rows, by_plant, of_energy[:, 0])
        box = np.repeat(self.axes[None, self._boxed], count, axis=0)
        return self._with_box(model, x, a[:, self._boxed], box, weights[:, 1])

    def _model(self, rows: Index, found: Derivatives, of_energy: Array) -> Model:
        """The model without least peak and box; the derivatives are by row and plant."""
        count, axes, scale, scales = len(rows), self.axes, self._scale[rows], self._scales[rows]
        arrival, by_arrival = found.arrival + self._offset[rows], found.by_arrival @ axes
        c, by_c = np.zeros((count, 0)), np.zeros((count, 0, self.size))
        if self.at_rest:
            c, by_c = arrival[:, 0] / scale, by_arrival[:, 0] / scale[:, :, None]
        rests = self._rests[rows]
        of_rest = np.einsum("rpms,rps->rpm", rests, arrival).reshape(count, -1)
        by_rest = (rests @ by_arrival).reshape(count, -1, self.size)
        limited = found.limited[:, self._plant, self._value] / scales
        by_limited = found.by_limited[:, self._plant, self._value] / scales[:, :, None] @ axes
        return Model(
            f=of_energy * found.energy[:, 0],
            gradient=of_energy[:, None] * (found.gradient[:, 0] @ axes),
            c=c,
            by_c=by_c,
            v=np.concatenate([of_rest, limited], axis=1),
            by_v=np.concatenate([by_rest, by_limited], axis=1),
            hessian=axes.T @ found.curvature.sum(axis=1) @ axes,
        )

    def _with_box(self, model: Model, x: Array, a: Array, box: Array, of_peak: Array) -> Model:
        """The same with the peak as the last unknown, v - peak <= 0 <= v + peak, and the box."""
        if self.least is None:
            v, by_v = np.hstack([model.v, a]), np.concatenate([model.by_v, box], axis=1)
            return model._replace(v=v, by_v=by_v)
        count, peak, is_peak = len(x), x[:, -1:], self._peak
        above, by_above = model.v[:, is_peak] + peak, model.by_v[:, is_peak]
        below = np.repeat(-is_peak[None, :, None].astype(float), count, axis=0)
        by_v = [
            np.concatenate([model.by_v, below], axis=2),
            np.concatenate([by_above, np.ones((*by_above.shape[:2], 1))], axis=2),
            _widened(box),
        ]
        hessian = np.zeros((count, self.unknowns, self.unknowns))
        hessian[:, :-1, :-1] = model.hessian
        return Model(
            f=model.f + of_peak * peak[:, 0],
            gradient=np.column_stack([model.gradient, of_peak]),
            c=model.c,
            by_c=_widened(model.by_c),
            v=np.hstack([model.v - peak * is_peak, above, a]),
            by_v=np.concatenate(by_v, axis=1),
            hessian=hessian,
        )

    def _multipliers(self, rows: Index, of_c: Array, of_v: Array) -> tuple[Array, Array]:
        """Of every plant's arrival and limited quantities."""
        count, plants = len(rows), self.plants
        of_arrival = np.zeros((count, plants, self._scale.shape[1]))
        if self.at_rest and of_c.shape[1]:
            of_arrival[:, 0] = of_c / self._scale[rows]
        own = self._peak.size
        of_v, above = of_v[:, :own].copy(), of_v[:, own : own + self._peak.sum()]
        of_v[:, self._peak] += above
        first = plants * self._rests.shape[2]
        of_rest = of_v[:, :first].reshape(count, plants, -1)
        of_arrival += np.einsum("rpm,rpms->rps", of_rest, self._rests[rows])
        of_limited = np.zeros((count, plants, self._values))
        of_limited[:, self._plant, self._value] = of_v[:, first:] / self._scales[rows]
        return of_arrival, of_limited


def _widened(rows: Array) -> Array:
    """Derivatives with those by the peak, which are zero."""
    return np.concatenate([rows, np.zeros((*rows.shape[:-1], 1))], axis=-1)


def _weights(program: Program, ask: Scalarization) -> tuple[float, float]:
    """Of the scaled energy and of the scaled peak, the larger of them 1."""
    of_energy = ask.minimise.get(ENERGY, 0.0) * program.energy
    of_peak = ask.minimise[ask.least] * program.scale_of(ask.least) if ask.least else 0.0
    largest = max(of_energy, of_peak)
    return of_energy / largest, of_peak / largest
