"""A robot on its path as a figure in space, for pictures: capsules between its joints, its beam."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from quietarm.models.compiled import Compiled
from quietarm.models.drawing import Body
from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.mechanism import BEAM_END, GROUND
from quietarm.models.robot.dynamics.modes import sag_at
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.frames import Frame, shortest_turn
from quietarm.models.robot.on_path.path_tables import modes_on, tables_of
from quietarm.models.robot.on_path.reduction import Reduction
from quietarm.models.robot.path.geometric_path import GeometricPath

_PLACES = 11
"""Of the path, by which size, floor and view are chosen."""
_STILL = 1e-3
"""Share of a robot's size below which a link has no length, and a tip goes nowhere."""
_OF_BASE = 0.045
_OF_TIP = 0.027
_OF_FINGER = 0.015
_OF_BEAM = 0.011
_OF_LOAD = 0.028
"""Radii as shares of a robot's size: a URDF says nothing of how thick links are."""
_BETWEEN = 3
"""Parts of the beam for each of its pieces, so that it is round."""


@lru_cache(maxsize=8)
def robot_figure_of(robot: MovingRobot, path: GeometricPath) -> RobotFigure:
    """Return the figure of a robot on a path, which is computed once."""
    return RobotFigure(robot, path)


class RobotFigure:
    """Places of what is drawn of a robot, up being against gravity.

    What bends does so as its modes do.
    """

    def __init__(self, robot: MovingRobot, path: GeometricPath) -> None:
        self._path = path
        self._dynamics = robot.dynamics
        self._bodies = robot.mechanism.bodies
        self._beam = robot.beam
        self._tip = robot.tip_place
        self._tip_is_beam = robot.tip == BEAM_END
        self._links = robot.mechanism.links
        of_base = 0 if robot.base is None else len(robot.base.stiffness)
        rigid = [n for n, body in enumerate(self._bodies) if not body.of_beam]
        self._gives = {n for n in robot.mechanism.sprung if n in rigid}
        self._linked = [n for n in rigid if n >= of_base]
        geared = {
            self._bodies[n].parent for n in self._gives if n in self._linked and self._is_gear(n)
        }
        self._jointed = [n for n in rigid if not self._bodies[n].slides and n not in geared]
        modes = modes_on(robot, path)
        reduction = Reduction(robot.dynamics, robot.tip_place, path, modes)
        self._shapes = reduction.shapes
        self._tables = tables_of(robot, path)
        self._points_of = self._function()
        self._upright = np.eye(3)
        if np.linalg.norm(robot.gravity) > 0:
            self._upright = shortest_turn(-np.array(robot.gravity))
        still = np.zeros(len(self._tables.directions))
        self._seen = [self._points(place, still) for place in np.linspace(0.0, 1.0, _PLACES)]

    def _is_gear(self, number: int) -> bool:
        """Return whether a joint with a spring is where its motor is."""
        return not self._bodies[number].frame.origin.any()

    def bodies(self, place: float, tips: Sequence[float]) -> list[Body]:
        """Return what is drawn at a place of the path, the tip displaced [m]."""
        points = self._points(place, np.asarray(tips, dtype=float))
        drawn = [Body(self._post(points), ground=True, radius=_OF_FINGER * self._size)]
        drawn += [
            Body(points[[self._before(n), 1 + n]], rigid=True, radius=self._radii[n])
            for n in self._linked
            if self._lengths[n] > _STILL * self._size
        ]
        drawn += [
            Body(self._drum(points, n), rigid=n not in self._gives, radius=1.15 * self._radii[n])
            for n in self._jointed
        ]
        drawn += self._of_beam(points)
        if not self._tip_is_beam:
            last = points[[1 + self._tip[0], -1]]
            drawn.append(Body(last, tip=True, radius=_OF_FINGER * self._size))
        return drawn

    @cached_property
    def seen_from(self) -> float:
        """Direction of the ground from which most of the tip's way is seen [rad]."""
        tips = np.array([points[-1, :2] for points in self._seen])
        way = tips[-1] - tips[0]
        length = float(np.linalg.norm(way))
        right = way / length if length > _STILL * self._size else np.array([1.0, 0.0])
        towards = np.array([right[1], -right[0]])
        if tips.mean(axis=0) @ towards < 0:
            towards = -towards
        return float(np.arctan2(towards[1], towards[0]))

    @cached_property
    def _size(self) -> float:
        """Length of the robot along its links, without its beam [m]."""
        reach = max(
            sum(self._length_at(points, n) for n in self._linked if n in self._chain)
            for points in self._seen
        )
        of_beam = 0.0 if self._beam is None else self._beam.length / 2
        of_way = float(np.ptp([points[-1] for points in self._seen], axis=0).max()) / 2
        return max(reach, of_beam, of_way) or 1.0

    @cached_property
    def _lengths(self) -> dict[int, float]:
        """The largest length of the link before each body [m]."""
        return {n: max(self._length_at(points, n) for points in self._seen) for n in self._linked}

    def _length_at(self, points: Array, number: int) -> float:
        return float(np.linalg.norm(points[1 + number] - points[self._before(number)]))

    @cached_property
    def _radii(self) -> dict[int, float]:
        """Radius of the link before each body: the farther from the ground the thinner [m]."""
        thinner = np.linspace(_OF_BASE, _OF_TIP, len(self._chain))
        of_chain = dict(zip(self._chain, self._size * thinner))
        fingers = _OF_FINGER * self._size
        return {n: float(of_chain.get(n, fingers)) for n in range(len(self._bodies))}

    @cached_property
    def _chain(self) -> list[int]:
        """Rigid bodies from the ground to the tip, or to the beam."""
        number, _ = self._tip if self._beam is None else self._links[self._beam.at]
        chain = list[int]()
        while number != GROUND:
            chain.append(number)
            number = self._bodies[number].parent
        return chain[::-1]

    def _before(self, number: int) -> int:
        """Row of the body before one; that of the ground is the first."""
        return 1 + self._bodies[number].parent

    def _post(self, points: Array) -> Array:
        """From the floor to the robot, or of one that hangs a point of the floor alone."""
        lowest = min(float(seen[:, 2].min()) for seen in self._seen)
        foot = points[[0]] * [1.0, 1.0, 0.0] + [0.0, 0.0, min(0.0, lowest)]
        stands = self._upright[2, 2] > 0.5
        return np.vstack([foot, points[0]]) if stands else foot

    def _drum(self, points: Array, number: int) -> Array:
        """Ends of a joint, along its axis."""
        half = 1.1 * self._radii[number]
        middle = points[1 + number]
        along = points[1 + len(self._bodies) + self._jointed.index(number)] - middle
        return np.array([middle - half * along, middle + half * along])

    def _of_beam(self, points: Array) -> list[Body]:
        """The beam with the link before it, and the load at its end."""
        if self._beam is None:
            return []
        clamp = points[-2]
        last = points[1 + self._chain[-1]] if self._chain else points[0]
        rows = [1 + n for n, body in enumerate(self._bodies) if body.of_beam]
        hinges = points[rows[::2]]
        bent = self._rounding @ np.vstack([clamp, hinges, points[-3]])
        beam = Body(bent, tip=self._tip_is_beam, radius=_OF_BEAM * self._size)
        drawn = [beam]
        if np.linalg.norm(clamp - last) > 0:
            drawn.insert(0, Body(np.array([last, clamp]), rigid=True, radius=_OF_TIP * self._size))
        if self._beam.tip_mass > 0:
            drawn.append(Body(points[[-3]], rigid=True, radius=_OF_LOAD * self._size))
        return drawn

    @cached_property
    def _rounding(self) -> Array:
        """Points of a smooth line through clamp, hinges and end, as their multiples."""
        from scipy.interpolate import CubicSpline  # takes a quarter of a second to load

        assert self._beam is not None
        along = np.array([0.0, *self._beam.places, self._beam.length])
        fine = np.linspace(0.0, along[-1], 1 + _BETWEEN * (len(along) - 1))
        return CubicSpline(along, np.eye(len(along)))(fine)

    def _points(self, place: float, tips: Array) -> Array:
        """Return places [m]: the ground, every body, axes of joints, the beam's ends, the tip."""
        q = self._path(place)
        p = sag_at(self._dynamics, q)
        rows = self._tables.at(float(place)).values(self._tables.tips)
        amplitudes, *_ = np.linalg.lstsq(rows.astype(float), tips, rcond=None)
        x = np.concatenate([q, p + self._shapes @ amplitudes])
        (points,) = self._points_of(x)
        return points.T @ self._upright

    def _function(self) -> Compiled:
        x = ca.SX.sym("x", self._dynamics.size)
        places = [(number, Frame()) for number in range(len(self._bodies))]
        places += [(n, Frame(origin=self._bodies[n].axis)) for n in self._jointed]
        if self._beam is not None:
            number, at_link = self._links[self._beam.at]
            places += [self._links[BEAM_END], (number, at_link @ self._beam.frame)]
        points = [self._dynamics.place(place, x)[1] for place in [*places, self._tip]]
        columns = ca.densify(ca.horzcat(ca.SX(3, 1), *points))
        return Compiled(lambda: ca.Function("points", [x], [columns], {"cse": True}))
