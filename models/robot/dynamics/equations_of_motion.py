"""The equations of a mechanism: Newton and Euler's, from the ground to the tips and back.

Luh, Walker and Paul, J. Dyn. Syst. Meas. Control 102 (1980). Vectors are CasADi's, in the frame of
the body that they belong to; entries that are zero whatever the joints do cost nothing.
"""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from quietarm.models.compiled import Compiled
from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.mechanism import GROUND, Mechanism, RigidBody
from quietarm.models.robot.frames import Frame, skew_of

_NOTHING = 1e-10
"""Below this an entry of a fixed rotation is 0: a URDF's rpy has pi/2 to eleven digits."""


def inverse_dynamics(mechanism: Mechanism, q: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
    """Torque of every body's joint [N m, or N], by positions, speeds and accelerations.

    Without springs, dampers, friction and rotors.
    """
    angular, angular_rate, acceleration = list[ca.SX](), list[ca.SX](), list[ca.SX]()
    forces, moments = list[ca.SX](), list[ca.SX]()
    ground = (ca.SX(3, 1), ca.SX(3, 1), ca.SX(-mechanism.gravity))
    placed = [_placed(body, q[i]) for i, body in enumerate(mechanism.bodies)]
    for i, body in enumerate(mechanism.bodies):
        rotation, place = placed[i]
        at = body.parent
        turn, turn_rate, rise = (
            ground if at == GROUND else (angular[at], angular_rate[at], acceleration[at])
        )
        axis = ca.SX(body.axis)
        inherited = rotation.T @ turn
        rate = rotation.T @ turn_rate
        carried = rise + ca.cross(turn_rate, place) + ca.cross(turn, ca.cross(turn, place))
        lifted = rotation.T @ carried
        if body.slides:
            lifted = lifted + axis * a[i] + 2 * ca.cross(inherited, axis * v[i])
        else:
            rate = rate + axis * a[i] + ca.cross(inherited, axis * v[i])
            inherited = inherited + axis * v[i]
        angular.append(inherited)
        angular_rate.append(rate)
        acceleration.append(lifted)
        centre = ca.SX(_clean(body.inertia.centre))
        inertia = ca.SX(_clean(body.inertia.moments))
        of_centre = lifted + ca.cross(rate, centre)
        of_centre = of_centre + ca.cross(inherited, ca.cross(inherited, centre))
        force = body.inertia.mass * of_centre
        forces.append(force)
        moments.append(
            inertia @ rate + ca.cross(inherited, inertia @ inherited) + ca.cross(centre, force)
        )
    torques = list[ca.SX]()
    for i, body in reversed(list(enumerate(mechanism.bodies))):
        rotation, place = placed[i]
        torques.append(ca.dot(ca.SX(body.axis), forces[i] if body.slides else moments[i]))
        if body.parent != GROUND:
            passed_on = rotation @ forces[i]
            forces[body.parent] += passed_on
            moments[body.parent] += rotation @ moments[i] + ca.cross(place, passed_on)
    return ca.vertcat(*reversed(torques))


def place_of(mechanism: Mechanism, link: tuple[int, Frame], q: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Rotation and origin of a link's frame, seen from the ground."""
    number, frame = link
    rotation = ca.SX(_clean(frame.rotation))
    origin = ca.SX(_clean(frame.origin))
    while number != GROUND:
        body = mechanism.bodies[number]
        turned, place = _placed(body, q[number])
        rotation = turned @ rotation
        origin = place + turned @ origin
        number = body.parent
    return rotation, origin


def _placed(body: RigidBody, position: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Rotation and origin of a body's frame in its parent's."""
    fixed = ca.SX(_clean(body.frame.rotation))
    origin = ca.SX(_clean(body.frame.origin))
    if body.slides:
        return fixed, origin + fixed @ (ca.SX(body.axis) * position)
    skew = _clean(skew_of(body.axis))
    about = ca.SX(np.eye(3)) + ca.sin(position) * skew + (1 - ca.cos(position)) * (skew @ skew)
    return fixed @ about, origin


def _clean(entries: Array) -> Array:
    """Entries without the rounding of 0, 1 and -1."""
    whole = np.round(entries)
    return np.where(np.abs(entries - whole) < _NOTHING, whole, entries)


class Dynamics:
    """Functions of a mechanism: of the driven joints' positions q and the springs' angles p.

    Another load at the end of the beam adds its mass [kg] times the torques of `added`, the
    equations of 1 kg there, so that no load has functions of its own.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.added: tuple[float, Dynamics] | None = None
        self.driven = len(mechanism.driven)
        self.sprung = len(mechanism.sprung)
        self._order = [*mechanism.driven, *mechanism.sprung]
        following = mechanism.following
        leaders = [following[n][0] if n in following else n for n in range(len(mechanism.bodies))]
        self._place = [self._order.index(number) for number in leaders]

    def stiffened(self, factor: float) -> Dynamics:
        """Return these equations with a multiple of the stiffness, by the same functions."""
        stiffened = copy.copy(self)
        stiffened.mechanism = self.mechanism.stiffened(factor)
        return stiffened

    def damped(self, factor: float) -> Dynamics:
        """Return these equations with a multiple of all dampers of springs."""
        damped = copy.copy(self)
        mechanism = self.mechanism
        damped.mechanism = replace(mechanism, damping=factor * mechanism.damping)
        return damped

    def loaded(self, mass: float, of_one: Dynamics) -> Dynamics:
        """Return these equations with a mass [kg] more, or less, where another has 1 kg alone."""
        loaded = copy.copy(self)
        before = 0.0 if self.added is None else self.added[0]
        loaded.added = (before + mass, of_one)
        return loaded

    @property
    def size(self) -> int:
        """Number of joints that move."""
        return self.driven + self.sprung

    def torques(self, x: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
        """Torques of the driven joints, then of the springs' joints, without springs and dampers.

        Positions x, speeds v and accelerations a are in the same order. Rotors turn and rub.
        """
        torques = self._torques(x, v, a)
        if self.added is None:
            return torques
        mass, of_one = self.added
        return torques + mass * of_one.torques(x, v, a)

    @cached_property
    def _torques(self) -> ca.Function:
        """The equations, written once: a call of it with symbols puts these in their place."""
        x, v, a = (ca.SX.sym(name, self.size) for name in "xva")
        motions = (self._by_body(x), self._by_body(v, rate=True), self._by_body(a, rate=True))
        by_body = inverse_dynamics(self.mechanism, *motions)
        torque = self._by_joint(by_body)
        rotors = ca.DM(self.mechanism.rotor_inertia)
        friction = ca.DM(self.mechanism.friction)
        of_motors = rotors * a[: self.driven] + friction * v[: self.driven]
        torques = torque + ca.vertcat(of_motors, ca.SX(self.sprung, 1))
        return ca.Function("torques", [x, v, a], [ca.densify(torques)])

    def place(self, link: tuple[int, Frame], x: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Rotation and origin of a link, seen from the ground."""
        return place_of(self.mechanism, link, self._by_body(x))

    def _by_body(self, x: ca.SX, rate: bool = False) -> ca.SX:
        """Positions of the bodies' joints, or their rates, by those of the joints that lead."""
        by_body = x[self._place]
        for number, (_, follower) in self.mechanism.following.items():
            by_body[number] = follower.multiplier * by_body[number]
            if not rate:
                by_body[number] += follower.offset
        return by_body

    def _by_joint(self, torques: ca.SX) -> ca.SX:
        """Torques of the joints that lead, which by virtual work move those that follow."""
        by_joint = torques[self._order]
        for number, (leader, follower) in self.mechanism.following.items():
            by_joint[self._order.index(leader)] += follower.multiplier * torques[number]
        return by_joint

    def at_rest(self, x: Array) -> tuple[Array, Array]:
        """Torques of all joints at rest, and their slopes by the springs' angles.

        At one position of the joints, shape (size,), or at many, (places, size).
        """
        at = np.atleast_2d(x)
        torques, slopes = self._at_rest.at_places(at.T)
        torques = torques.T
        slopes = slopes.reshape(self.size, len(at), self.sprung).swapaxes(0, 1)
        if np.ndim(x) == 1:
            torques, slopes = torques[0], slopes[0]
        if self.added is None:
            return torques, slopes
        mass, of_one = self.added
        more, steeper = of_one.at_rest(x)
        return torques + mass * more, slopes + mass * steeper

    @cached_property
    def _at_rest(self) -> Compiled:
        return Compiled(self._build_at_rest, kept_as=("at_rest", self.mechanism))

    def _build_at_rest(self) -> ca.Function:
        x = ca.SX.sym("x", self.size)
        still = ca.SX(self.size, 1)
        torque = self._torques(x, still, still)
        slopes = ca.densify(ca.jacobian(torque, x)[:, self.driven :])
        outputs = [ca.densify(torque), slopes]
        return ca.Function("at_rest", [x], outputs, {"cse": True})

    def masses(self, x: ArrayLike) -> Array:
        """The mass matrix of all joints."""
        (masses,) = self._masses(x)
        if self.added is None:
            return masses
        mass, of_one = self.added
        return masses + mass * of_one.masses(x)

    @cached_property
    def _masses(self) -> Compiled:
        return Compiled(self._build_masses, kept_as=("masses", self.mechanism))

    def _build_masses(self) -> ca.Function:
        x = ca.SX.sym("x", self.size)
        a = ca.SX.sym("a", self.size)
        torque = self._torques(x, ca.SX(self.size, 1), a)
        masses = ca.densify(ca.jacobian(torque, a))
        return ca.Function("masses", [x], [masses], {"cse": True})

    def sag(self, q: Array, begin: Array | None = None) -> Array:
        """Angles of the springs at rest, by Newton from where they may be.

        At one position of the driven joints, shape (driven,), or at many at once, (places,
        driven). SoftSpringError where there is no equilibrium near.
        """
        shape = (*np.shape(q)[:-1], self.sprung)
        p = np.zeros(shape) if begin is None else np.broadcast_to(begin, shape).copy()
        if not self.sprung:
            return p
        for _ in range(_MOST_NEWTON):
            excess, slopes = self.stiffness_at(q, p)
            step = np.linalg.solve(slopes, excess[..., None])[..., 0]
            p -= step
            if not np.all(np.abs(p) < _FAR):
                break
            if np.abs(step).max() < _SETTLED:
                break
        is_near = np.abs(p) < _MOST_SAG
        if not np.all(is_near):
            farthest = np.unravel_index(np.where(is_near, 0.0, np.abs(p)).argmax(), shape)
            raise SoftSpringError(self.mechanism.spring_names[farthest[-1]], farthest[:-1])
        return p

    def stiffness_at(self, q: Array, p: Array) -> tuple[Array, Array]:
        """Return the imbalance of springs and gravity [N m], and its slopes; of many places too."""
        torque, slopes = self.at_rest(np.concatenate([q, p], axis=-1))
        stiffness = self.mechanism.stiffness
        excess = torque[..., self.driven :] + stiffness * p
        return excess, slopes[..., self.driven :, :] + np.diag(stiffness)


_MOST_NEWTON = 50
_SETTLED = 1e-13
"""Angles of springs [rad] are then exact within rounding."""
_FAR = math.pi
"""Angles of springs [rad] from which Newton does not come back."""
_MOST_SAG = 0.35
"""Angle of a spring at rest [rad], 20 degrees, beyond which no structure is meant to work."""


class SoftSpringError(ArithmeticError):
    """A spring of this name cannot carry its load, at this place among many."""

    def __init__(self, spring: str, place: tuple[np.intp, ...] = ()) -> None:
        super().__init__(spring)
        self.place = place
