"""The equations of a robot on its path: functions of the place s alone, by a few modes.

The sprung joints are at p = p0(s) + shapes W: p0 is the equilibrium under gravity, which moves with
the path, and the shapes are those of the modes in the middle of it. To first order in W

    W'' = -(a s'' + b s'^2 + e s') - (K + A s'' + B s'^2) W - (D + C s') W'
    torques = a s'' + b s'^2 + e s' + g + (K + A s'' + B s'^2) W + C s' W' + N W''

with coefficients of the modes and of the torques. They are derivatives of the inverse dynamics.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from quietarm.models.compiled import Compiled
from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.equations_of_motion import Dynamics
from quietarm.models.robot.dynamics.modes import modes_at, sag_at
from quietarm.models.robot.frames import Frame
from quietarm.models.robot.path.geometric_path import GeometricPath

OF_MODES = ("a", "b", "e", "K", "A", "B", "D", "C")
"""Coefficients of the modes' equations."""
OF_TORQUES = ("a", "b", "e", "g", "K", "A", "B", "C", "N")
"""Of the torques."""
FORCING = ("a", "b", "e", "g")
"""Those that do not multiply the modes."""
MIDDLE = 0.5
"""The place on the path whose modes' shapes are used."""
_AXIAL = 0.05
"""Share of the largest displacement below which a direction of the tip is left out."""


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Every coefficient at several places, the places along the first axis."""

    modes: dict[str, Array]
    torques: dict[str, Array]
    tips: Array


class Reduction:
    """The coefficients of a robot on a path, exact at any place."""

    def __init__(
        self, dynamics: Dynamics, tip: tuple[int, Frame], path: GeometricPath, modes: Sequence[int]
    ) -> None:
        self.dynamics = dynamics
        self._path = path
        self._tip = tip
        q = path(MIDDLE)
        self._sag_in_the_middle = sag_at(dynamics, q)
        self.all_frequencies, shapes = modes_at(dynamics, q, self._sag_in_the_middle)
        """Of all modes in the middle of the path [rad/s]."""
        self.shapes = shapes[:, list(modes)]
        self._of_added: _Forces | None = None
        self.directions = np.arange(3)
        rows = self._tip_rows(q, self._sag_in_the_middle)
        self.shapes = self.shapes * self._scales(rows)
        rows = np.abs(self._tip_rows(q, self._sag_in_the_middle)).sum(axis=1)
        self.directions = np.flatnonzero(rows > _AXIAL * rows.max())
        self._forces = _Forces(dynamics, self.shapes)

    def of(self, dynamics: Dynamics) -> Reduction:
        """The reduction for other springs or another load, with the mode shapes of this one."""
        if dynamics.added is not None and self._of_added is None:
            self._of_added = _Forces(dynamics.added[1], self.shapes)
        reduction = copy.copy(self)
        reduction.dynamics = dynamics
        reduction._sag_in_the_middle = sag_at(dynamics, self._path(MIDDLE))
        return reduction

    def at(self, places: Array) -> Coefficients:
        """All coefficients at these places of the path."""
        q, slope, bend = (self._path(places, order) for order in range(3))
        sag = sag_at(self.dynamics, q, self._sag_in_the_middle)
        along = self._rates(q, sag, slope, bend)
        positions = np.hstack([q, sag])
        first, second, rows = along
        outputs = self._coefficients(
            positions.T, np.hstack([slope, first]).T, np.hstack([bend, second]).T
        )
        raw = {
            name: self._by_place(name, output, len(places))
            for name, output in zip(OF_TORQUES, outputs)
        }
        return self._by_modes(raw, first, rows)

    def _by_modes(self, raw: dict[str, Array], sag_rate: Array, tips: Array) -> Coefficients:
        """Coefficients of the modes by their masses, and of the torques."""
        driven = self.dynamics.driven
        mechanism = self.dynamics.mechanism
        shapes = self.shapes
        masses = shapes.T @ raw["N"][:, driven:]
        stiffness = shapes.T @ (mechanism.stiffness[:, None] * shapes)
        damping = shapes.T @ (mechanism.damping[:, None] * shapes)
        forces = {name: shapes.T @ raw[name][:, driven:] for name in ("K", "A", "B", "C")}
        forces |= {name: (raw[name][:, driven:] @ shapes)[..., None] for name in ("a", "b")}
        forces["K"] = forces["K"] + stiffness
        forces["D"] = np.broadcast_to(damping, masses.shape)
        forces["e"] = ((sag_rate * mechanism.damping) @ shapes)[..., None]
        of_modes = dict[str, Array]()
        for name in OF_MODES:
            of_modes[name] = np.asarray(np.linalg.solve(masses, forces[name]), float)
        for name in ("a", "b", "e"):
            of_modes[name] = of_modes[name][..., 0]
        of_torques = {name: raw[name][:, :driven] for name in OF_TORQUES}
        return Coefficients(of_modes, of_torques, tips)

    def _by_place(self, name: str, table: Array, count: int) -> Array:
        """Outputs that stand side by side, with the places along the first axis."""
        by_place = np.moveaxis(table.reshape(self.dynamics.size, count, -1), 1, 0)
        return by_place[..., 0] if name in FORCING else by_place

    def _coefficients(self, *motion: Array) -> list[Array]:
        """`OF_TORQUES` of all joints by (positions, first and second slopes), a column a place."""
        return self._with_added(lambda forces: forces.coefficients_at(*motion))

    def _second(self, *motion: Array) -> tuple[Array, Array]:
        """First and second slopes of the springs' torques at rest by the same, a row a place."""
        columns = [values.T for values in motion]
        first, second = self._with_added(lambda forces: forces.second.at_places(*columns))
        return first.T, second.T

    def _with_added(self, values: Callable[[_Forces], list[Array]]) -> list[Array]:
        """Values that are linear in the masses, with those of the added load."""
        own = values(self._forces)
        added = self.dynamics.added
        if added is None or self._of_added is None:
            return own
        return [here + added[0] * of_one for here, of_one in zip(own, values(self._of_added))]

    def _rates(self, q: Array, sag: Array, slope: Array, bend: Array) -> tuple[Array, Array, Array]:
        """First and second slopes of the sag by s, and displacements of the tip by the modes."""
        at = np.hstack([q, sag])
        still = np.zeros_like(sag)
        stiffness = self.dynamics.stiffness_at(q, sag)[1]
        by_q, _ = self._second(at, np.hstack([slope, still]), np.hstack([bend, still]))
        first = np.asarray(-np.linalg.solve(stiffness, by_q[..., None])[..., 0], float)
        _, curved = self._second(at, np.hstack([slope, first]), np.hstack([bend, still]))
        second = np.asarray(-np.linalg.solve(stiffness, curved[..., None])[..., 0], float)
        return first, second, self._tip_rows(q, sag)

    @cached_property
    def _tip_slopes(self) -> Compiled:
        """(x) -> slopes of the tip's place by the springs' angles, in the straight tip's frame."""
        dynamics = self.dynamics
        x = ca.SX.sym("x", dynamics.size)
        _, origin = dynamics.place(self._tip, x)
        straight = ca.vertcat(x[: dynamics.driven], ca.SX(dynamics.sprung, 1))
        rotation, _ = dynamics.place(self._tip, straight)
        slopes = ca.densify(rotation.T @ ca.jacobian(origin, x)[:, dynamics.driven :])
        return Compiled(lambda: ca.Function("tip_slopes", [x], [slopes], {"cse": True}))

    def _tip_rows(self, q: Array, p: Array) -> Array:
        """Displacements of the tip by the modes, (directions, modes) at each of the places."""
        at = np.concatenate([q, p], axis=-1)
        (slopes,) = self._tip_slopes.at_places(np.atleast_2d(at).T)
        by_place = slopes.reshape(3, -1, self.dynamics.sprung).swapaxes(0, 1)
        rows = by_place[:, self.directions] @ self.shapes
        return rows if at.ndim > 1 else rows[0]

    def _scales(self, rows: Array) -> Array:
        """Scale modes so that W is the tip's largest displacement, or 1 rad if the tip stays."""
        largest = np.abs(rows).max(axis=0)
        signs = np.sign(rows[np.abs(rows).argmax(axis=0), np.arange(rows.shape[1])])
        angles = np.abs(self.shapes).max(axis=0)
        moves = largest > _LEAST_OF_TIP * angles
        return np.where(moves, signs / np.where(moves, largest, 1.0), 1 / angles)


_LEAST_OF_TIP = 1e-6
"""Displacement of the tip [m] by a mode of 1 rad, below which the mode does not move it."""


class _Forces:
    """Forces along a path, as functions that are linear in the masses."""

    def __init__(self, dynamics: Dynamics, shapes: Array) -> None:
        self._dynamics = dynamics
        self._shapes = shapes

    def coefficients_at(self, *motion: Array) -> list[Array]:
        """`OF_TORQUES` of all joints; a column a place."""
        return self._coefficients.at_places(*motion)

    @cached_property
    def _coefficients(self) -> Compiled:
        """(positions, their first and second slopes) -> `OF_TORQUES`, of all joints."""
        parts = ("coefficients", self._dynamics.mechanism, self._shapes)
        return Compiled(self._build_coefficients, kept_as=parts)

    @cached_property
    def second(self) -> Compiled:
        """(x, its first slope, its second) -> the same of the springs' torques at rest."""
        return Compiled(self._build_second, kept_as=("second", self._dynamics.mechanism))

    def _build_coefficients(self) -> ca.Function:
        dynamics = self._dynamics
        size = dynamics.size
        x, slope, bend = (ca.SX.sym(name, size) for name in ("x", "slope", "bend"))
        v = ca.SX.sym("v", size)
        still = ca.SX(size, 1)
        at_rest = dynamics.torques(x, still, still)
        pushed = dynamics.torques(x, still, slope) - at_rest
        moving = dynamics.torques(x, v, bend)
        unknown = ca.SX.sym("a", size)
        masses = dynamics.torques(x, still, unknown)
        shapes = [
            ca.DM(np.concatenate([np.zeros(dynamics.driven), shape])) for shape in self._shapes.T
        ]

        def along(expression: ca.SX, by: ca.SX) -> ca.SX:
            return ca.horzcat(*(ca.jtimes(expression, by, shape) for shape in shapes))

        friction = ca.vertcat(
            ca.DM(dynamics.mechanism.friction) * slope[: dynamics.driven], ca.SX(dynamics.sprung, 1)
        )
        at_speed = moving - at_rest
        by_square = ca.substitute(at_speed, v, slope) - friction
        outputs = [
            pushed,
            by_square,
            friction,
            at_rest,
            along(at_rest, x),
            along(pushed, x),
            ca.substitute(along(at_speed, x), v, slope),
            ca.substitute(along(moving, v), v, slope),
            along(masses, unknown),
        ]
        dense = [ca.densify(output) for output in outputs]
        # to look for common terms takes five times as long as all else, and saves a third of calls
        return ca.Function("coefficients", [x, slope, bend], dense)

    def _build_second(self) -> ca.Function:
        dynamics = self._dynamics
        x, slope, bend = (ca.SX.sym(name, dynamics.size) for name in ("x", "slope", "bend"))
        still = ca.SX(dynamics.size, 1)
        torque = dynamics.torques(x, still, still)[dynamics.driven :]
        first = ca.jtimes(torque, x, slope)
        second = ca.jtimes(first, x, slope) + ca.jtimes(torque, x, bend)
        dense = [ca.densify(first), ca.densify(second)]
        inputs = [x, slope, bend]
        return ca.Function("second", inputs, dense, {"cse": True})
