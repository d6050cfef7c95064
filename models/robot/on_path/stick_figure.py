"""A robot on its path as a stick figure in space, for pictures: lines through its joints."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import casadi as ca
import numpy as np

from quietarm.models.compiled import Compiled
from quietarm.models.drawing import Body
from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.mechanism import BEAM_END, GROUND
from quietarm.models.robot.dynamics.modes import sag_at
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.frames import Frame
from quietarm.models.robot.on_path.path_tables import modes_on, tables_of
from quietarm.models.robot.on_path.reduction import Reduction
from quietarm.models.robot.path.geometric_path import GeometricPath

_ELEVATION = np.radians(25.0)
"""From which the robot is seen."""
_BEYOND = 0.08
"""How far the floor goes on beyond the robot and its shadow, as a share of the robot's size."""
_PLACES = 11
"""Of the path, by which the view is chosen."""


@lru_cache(maxsize=8)
def stick_figure_of(robot: MovingRobot, path: GeometricPath) -> StickFigure:
    """Return the stick figure of a robot on a path, which is computed once."""
    return StickFigure(robot, path)


class StickFigure:
    """Places at which a robot's joints and tip are drawn, seen from the side on which its tip goes.

    What bends does so as its modes do.
    """

    def __init__(self, robot: MovingRobot, path: GeometricPath) -> None:
        self._path = path
        self._dynamics = robot.dynamics
        self._bodies = robot.mechanism.bodies
        self._driven = robot.mechanism.driven
        self._tip = robot.tip_place
        self._has_beam = robot.beam is not None and robot.tip == BEAM_END
        modes = modes_on(robot, path)
        reduction = Reduction(robot.dynamics, robot.tip_place, path, modes)
        self._shapes = reduction.shapes
        self._tables = tables_of(robot, path)
        self._origins_of = self._function()
        self._view, self._floor = self._seen()

    def bodies(self, place: float, tips: Sequence[float]) -> list[Body]:
        """Lines of the picture at a place of the path, the tip displaced [m]."""
        origins = self._origins(place, np.asarray(tips, dtype=float))
        shadow = np.column_stack([origins[:, :2], np.full(len(origins), self._floor[0, 2])])
        lines = [Body(self._floor @ self._view, ground=True)]
        chain = self._chain()
        lines += [
            Body(shadow[[0, *chain, -1]] @ self._view, ground=True),
            Body(np.array([shadow[0], origins[0]]) @ self._view, ground=True),
            *(
                Body(origins[[self._before(number), 1 + number]] @ self._view, rigid=True)
                for number in range(len(self._bodies))
                if 1 + number not in chain
            ),
        ]
        bent = self._first_of_beam(chain)
        lines.append(Body(origins[[0, *chain[:bent]]] @ self._view, rigid=True))
        lines.append(Body(origins[[*chain[bent - 1 :], -1]] @ self._view, tip=True))
        return lines

    def _chain(self) -> list[int]:
        """Rows of the bodies from the ground to the tip."""
        number, _ = self._tip
        chain = list[int]()
        while number != GROUND:
            chain.append(1 + number)
            number = self._bodies[number].parent
        return chain[::-1]

    def _before(self, number: int) -> int:
        """Row of the body before one; that of the ground is the first."""
        return 1 + self._bodies[number].parent

    def _first_of_beam(self, chain: list[int]) -> int:
        """Return how many rows of the chain stand before the beam, or all if there is no beam."""
        if not self._has_beam:
            return len(chain)
        return sum(not self._bodies[row - 1].of_beam for row in chain)

    def _origins(self, place: float, tips: Array) -> Array:
        """Return the origins of the ground, every body and the tip [m], shape (bodies + 2, 3)."""
        q = self._path(place)
        p = sag_at(self._dynamics, q)
        rows = self._tables.at(float(place)).values(self._tables.tips)
        amplitudes, *_ = np.linalg.lstsq(rows.astype(float), tips, rcond=None)
        x = np.concatenate([q, p + self._shapes @ amplitudes])
        (origins,) = self._origins_of(x)
        return origins.T

    def _function(self) -> Compiled:
        x = ca.SX.sym("x", self._dynamics.size)
        places = [(number, Frame()) for number in range(len(self._bodies))]
        origins = [self._dynamics.place(place, x)[1] for place in [*places, self._tip]]
        columns = ca.densify(ca.horzcat(ca.SX(3, 1), *origins))
        return Compiled(lambda: ca.Function("origins", [x], [columns], {"cse": True}))

    def _seen(self) -> tuple[Array, Array]:
        """Columns by which a point in space is drawn, and the corners of the floor."""
        still = np.zeros(len(self._tables.directions))
        figures = np.array([
            self._origins(place, still) for place in np.linspace(0.0, 1.0, _PLACES)
        ])  # fmt: skip
        tips = figures[:, -1, :2]
        way = tips[-1] - tips[0]
        size = float(np.linalg.norm(figures, axis=2).max())
        length = float(np.linalg.norm(way))
        right = way / length if length > 1e-3 * size else np.array([1.0, 0.0])
        away = np.array([-right[1], right[0]])
        if tips.mean(axis=0) @ away > 0:
            right = -right
            away = -away
        up = np.array([*(np.sin(_ELEVATION) * away), np.cos(_ELEVATION)])
        view = np.column_stack([[*right, 0.0], up])
        below = figures[:, :, :2].reshape(-1, 2) @ np.column_stack([right, away])
        near = below.min(axis=0) - _BEYOND * size
        far = below.max(axis=0) + _BEYOND * size
        low = min(0.0, float(figures[:, :, 2].min()))
        corners = [near, (far[0], near[1]), far, (near[0], far[1]), near]
        floor = np.array([[*(a * right + b * away), low] for a, b in corners])
        return view, floor
