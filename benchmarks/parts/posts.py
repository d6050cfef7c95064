"""Moves of a flexible arm between posts: a drawn family of problems with several basins.

A horizontal arm of two links, with a spring in each joint, carries a tool that hangs down between
posts. The motors follow smooth paths; the links vibrate about them. The tool may pass each post on
either side, so that a move past three posts has up to eight ways, each of which is a basin.

The equations stand once, in CasADi. They give a black box (residual, energy, and how deep the tool
is in each post) to methods that see values alone, and their derivatives to the gradient.
"""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SEED = 64
"""The family is drawn from it."""
TERMS, DRAWS = (2, 4), {1: 1, 2: 2, 3: 2}
"""Coefficients of each joint; and problems by the number of posts on the way."""
STEPS = 100
BOUND = 1.0
"""Of the coefficients [rad]: how far a bump may take a joint from its way."""
ROTOR = 0.05
"""Inertia of a motor, as the joint sees it [kg m^2]."""
DAMPING = 0.01
"""Damping ratio of the lowest mode."""
ROUND = 0.1
"""Power at which the corner of its absolute value is round [W]: derivatives exist everywhere."""
SLACK = 1e-5
"""So deep [m] the tool may be in a post: solvers keep limits to some digits."""
APART = 0.06
"""Least free way between two posts, and between a post and start or target [m]."""


@dataclass(frozen=True)
class PostsMove:
    """A move between posts: coefficients to residual [m], energy [J] and depths in posts [m].

    Attributes
    ----------
    name : str
        What a table calls it.
    lengths, masses : tuple of float
        Of the two links [m, kg]; each is a uniform rod.
    load : float
        Mass of the tool [kg].
    stiffness : tuple of float
        Of the joints' springs [N m/rad].
    start, target : tuple of float
        Angles of the joints [rad].
    duration : float
        In seconds.
    posts : tuple of (x, y, radius)
        In metres.
    terms : int
        Coefficients of each joint.
    """

    name: str
    lengths: tuple[float, float]
    masses: tuple[float, float]
    load: float
    stiffness: tuple[float, float]
    start: tuple[float, float]
    target: tuple[float, float]
    duration: float
    posts: tuple[tuple[float, float, float], ...]
    terms: int

    vectorized = True
    objectives = ("residual", "energy")

    @property
    def constraints(self) -> list[str]:
        """Names of the depths."""
        return [f"post_{number}" for number in range(1, len(self.posts) + 1)]

    @property
    def size(self) -> int:
        """Coefficients in all."""
        return 2 * self.terms

    @property
    def lower(self) -> Array:
        """The least coefficients."""
        return np.full(self.size, -BOUND)

    @property
    def upper(self) -> Array:
        """The largest coefficients."""
        return np.full(self.size, BOUND)

    def __call__(self, candidates: Array) -> tuple[Array, Array]:
        """Objectives and violations of many candidates."""
        rows = np.atleast_2d(candidates)
        values = np.empty((len(rows), 2 + len(self.posts)))
        candidate, found, evaluate, *_ = self._evaluation
        for row, value in zip(rows, values, strict=True):
            candidate[:] = row
            evaluate()
            value[:] = found
        return values[:, :2], values[:, 2:] - SLACK

    @cached_property
    def _evaluation(self) -> tuple[Any, ...]:
        """Arrays of a candidate and its values, the evaluation between them, and its memory."""
        candidate, found = np.empty(self.size), np.empty(2 + len(self.posts))
        function = compiled("values", [self._symbols], [self._values])
        buffer, evaluate = function.buffer()
        buffer.set_arg(0, memoryview(candidate))
        buffer.set_res(0, memoryview(found))
        return candidate, found, evaluate, buffer, function

    @cached_property
    def with_derivatives(self) -> ca.Function:
        """Squared residual, energy and squared room beside the posts; then their derivatives."""
        squared = ca.vertcat(self._residual**2, self._energy, self._room)
        return compiled(
            "derivatives", [self._symbols], [squared, ca.jacobian(squared, self._symbols)]
        )

    @cached_property
    def _symbols(self) -> ca.MX:
        return ca.MX.sym("a", self.size)

    @cached_property
    def _rollout(self) -> tuple[ca.MX, ca.MX]:
        """State at the end, and power and the tool's place at every step, shape (3, steps)."""
        plain, basis = self._paths()
        paths = ca.reshape(plain + ca.mtimes(basis, self._symbols), -1, STEPS)
        states, nodes = self._step().mapaccum(STEPS)(ca.DM([*self.start, 0, 0]), paths)
        return states[:, -1], nodes

    @property
    def _energy(self) -> ca.MX:
        return self.duration / STEPS * ca.sum2(self._rollout[1][0, :])

    @property
    def _room(self) -> ca.MX:
        """Squared distance from each post less its squared radius, at every step."""
        tool = self._rollout[1][1:, :]
        return ca.vertcat(*(
            (tool[0, :] - x).T ** 2 + (tool[1, :] - y).T ** 2 - radius**2
            for x, y, radius in self.posts
        ))  # fmt: skip

    @property
    def _residual(self) -> ca.MX:
        """Amplitude of the tool after arrival: root of the sum of squares over both modes."""
        rows = ca.DM(self._modes()[0])
        return ca.norm_2(ca.mtimes(rows, self._rollout[0] - ca.DM([*self.target, 0, 0])))

    @property
    def _values(self) -> ca.MX:
        room = ca.reshape(self._room, STEPS, -1)
        depths = [
            radius - ca.sqrt(ca.mmin(room[:, post]) + radius**2)
            for post, (_, _, radius) in enumerate(self.posts)
        ]
        return ca.vertcat(self._residual, self._energy, *depths)

    @cached_property
    def depths(self) -> ca.Function:
        """Return how deep the tool is in each post [m], at the worst; not compiled."""
        return ca.Function("depths", [self._symbols], [self._values[2:]])

    def _paths(self) -> tuple[Array, Array]:
        """Angles and rates of the motors at begin, middle and end of every step, and accelerations.

        Their plain values, and what each coefficient adds, in columns.
        """
        x = np.linspace(0, 1, 2 * STEPS + 1)
        way = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6])
        hump = np.polynomial.Polynomial([0, 4, -4]) ** 3
        middle = np.polynomial.Polynomial([-1, 2])
        terms = [hump * middle**power for power in range(self.terms)]

        def columns(polynomial: Any, joint: int) -> Array:
            values = [
                polynomial.deriv(order)(x) / self.duration**order if order else polynomial(x)
                for order in range(3)
            ]
            table = np.zeros((STEPS, 7, 2))
            for place in range(3):
                stop = 2 * STEPS + 1 - (2 - place)
                table[:, place, joint] = values[0][place:stop:2]
                table[:, 3 + place, joint] = values[1][place:stop:2]
            table[:, 6, joint] = values[2][:-1:2]
            return table.ravel()

        plain = sum(
            columns(begin + (end - begin) * way, joint)
            for joint, (begin, end) in enumerate(zip(self.start, self.target, strict=True))
        )
        basis = [columns(term, joint) for joint in range(2) for term in terms]
        return np.asarray(plain), np.column_stack(basis)

    def _step(self) -> ca.Function:
        """One step by Runge and Kutta: the next state; power and the tool's place at its begin."""
        state = ca.SX.sym("state", 4)
        path = ca.SX.sym("path", 14)
        angles, rates = ca.horzsplit(ca.reshape(path, 2, 7), [0, 3, 6, 7])[:2]
        acceleration = path[12:]
        length = self.duration / STEPS

        def slope(x: ca.SX, place: int) -> ca.SX:
            torque = self._springs(x, angles[:, place], rates[:, place])
            inertia, inner = self._dynamics(x)
            return ca.vertcat(x[2:], ca.solve(inertia, torque - inner))

        one = slope(state, 0)
        two = slope(state + length / 2 * one, 1)
        three = slope(state + length / 2 * two, 1)
        four = slope(state + length * three, 2)
        end = state + length / 6 * (one + 2 * two + 2 * three + four)
        motors = self._springs(state, angles[:, 0], rates[:, 0]) + ROTOR * acceleration
        power = motors * rates[:, 0]
        absolute = ca.sum1(ca.sqrt(power**2 + ROUND**2) - ROUND)
        return ca.Function("step", [state, path], [end, ca.vertcat(absolute, self.tool(state))])

    def _springs(self, x: Any, angles: Any, rates: Any) -> Any:
        stiffness = ca.DM(self.stiffness)
        damping = stiffness * (2 * DAMPING / self._modes()[1][0])
        return stiffness * (angles - x[:2]) + damping * (rates - x[2:])

    def _dynamics(self, x: Any) -> tuple[Any, Any]:
        """Inertia matrix of the links, and the torques of centrifugal and Coriolis forces."""
        (l1, l2), (m1, m2) = self.lengths, self.masses
        outer = (m2 / 3 + self.load) * l2**2
        coupled = (m2 / 2 + self.load) * l1 * l2
        inner = (m1 / 3 + m2 + self.load) * l1**2
        cosine, sine = ca.cos(x[1]), ca.sin(x[1])
        first = inner + outer + 2 * coupled * cosine
        mixed = outer + coupled * cosine
        inertia = ca.vertcat(ca.horzcat(first, mixed), ca.horzcat(mixed, outer))
        turned = coupled * sine
        return inertia, ca.vertcat(-turned * (2 * x[2] * x[3] + x[3] ** 2), turned * x[2] ** 2)

    def tool(self, x: Any) -> Any:
        """Place of the tool [m] by the links' angles."""
        l1, l2 = self.lengths
        return ca.vertcat(
            l1 * ca.cos(x[0]) + l2 * ca.cos(x[0] + x[1]),
            l1 * ca.sin(x[0]) + l2 * ca.sin(x[0] + x[1]),
        )

    def _modes(self) -> tuple[Array, Array]:
        """Rows that give amplitudes of the tool by the state's difference, and frequencies [rad/s].

        They are of the undamped links at rest at the target.
        """
        inertia = np.array(ca.DM(self._dynamics(ca.DM([*self.target, 0, 0]))[0]))
        factor = np.linalg.cholesky(inertia)
        inverse = np.linalg.inv(factor)
        squares, vectors = np.linalg.eigh(inverse @ np.diag(self.stiffness) @ inverse.T)
        frequencies = np.sqrt(squares)
        shapes = inverse.T @ vectors
        angles = ca.SX.sym("angles", 2)
        slopes = ca.Function("slopes", [angles], [ca.jacobian(self.tool(angles), angles)])
        sizes = np.linalg.norm(np.array(slopes(ca.DM(self.target))) @ shapes, axis=0)
        amplitudes = sizes[:, None] * (shapes.T @ inertia)
        rows = np.zeros((4, 4))
        rows[:2, :2] = amplitudes
        rows[2:, 2:] = amplitudes / frequencies[:, None]
        return rows, frequencies

    def way(self, candidate: Array) -> tuple[int, ...]:
        """Say on which side of each post the tool passes: 1 for left, -1 for right.

        By the angle that its direction from the post turns through.
        """
        track = np.array(self._track(candidate))
        sides = list[int]()
        for x, y, _ in self.posts:
            angles = np.unwrap(np.arctan2(track[1] - y, track[0] - x))
            sides.append(
                -int(np.sign(angles[-1] - angles[0]))
                * max(1, round(abs(angles[-1] - angles[0]) / (2 * np.pi) + 0.5))
            )
        return tuple(sides)

    @cached_property
    def _track(self) -> ca.Function:
        return ca.Function("track", [self._symbols], [self._rollout[1][1:, :]])


def compiled(name: str, inputs: list[Any], outputs: list[Any]) -> ca.Function:
    """A function of CasADi, compiled where the machine has gcc."""
    if shutil.which("gcc") is None:
        return ca.Function(name, inputs, outputs)
    folder = f"{tempfile.gettempdir()}/"
    flags = {"flags": ["-O2"], "temp_suffix": True, "cleanup": True, "directory": folder}
    return ca.Function(
        name, inputs, outputs, {"jit": True, "compiler": "shell", "jit_options": flags}
    )


def drawn() -> tuple[PostsMove, ...]:
    """Draw the family: problems of each number of posts and of coefficients."""
    random = np.random.default_rng(SEED)
    return tuple(
        draw(random, posts, terms, number)
        for terms in TERMS
        for posts, count in DRAWS.items()
        for number in range(1, count + 1)
    )


def draw(random: np.random.Generator, count: int, terms: int, number: int) -> PostsMove:
    """Draw a move; again until there is room for its posts, and a way among 2,000 random ones."""
    while True:
        sign = random.choice([-1, 1], 3)
        start = random.uniform(-1.5, 1.5), sign[0] * random.uniform(0.7, 2.1)
        target = start[0] + sign[1] * random.uniform(0.7, 1.8), sign[2] * random.uniform(0.7, 2.1)
        move = PostsMove(
            name=f"posts-{count}-{2 * terms}-{'abcd'[number - 1]}",
            lengths=(random.uniform(0.3, 0.5), random.uniform(0.25, 0.45)),
            masses=(random.uniform(1, 2), random.uniform(0.5, 1.5)),
            load=random.uniform(0.2, 1),
            stiffness=(1.0, random.uniform(0.3, 1.0)),
            start=start,
            target=target,
            duration=1.0,
            posts=(),
            terms=terms,
        )
        frequency = 2 * np.pi * random.uniform(2.5, 5.0)
        scale = (frequency / move._modes()[1][0]) ** 2
        changed = vars(move) | {
            "stiffness": tuple(scale * stiffness for stiffness in move.stiffness),
            "duration": 2 * np.pi / frequency * random.uniform(2.0, 3.0),
        }
        move = PostsMove(**changed)
        posts = drawn_posts(random, move, count)
        if posts is None:
            continue
        move = PostsMove(**vars(move) | {"posts": posts})
        if has_way(move, random):
            return move


def drawn_posts(
    random: np.random.Generator, move: PostsMove, count: int
) -> tuple[tuple[float, float, float], ...] | None:
    """Draw posts near the plain move's way; None where there is no room for so many."""
    x = np.linspace(0, 1, STEPS + 1)
    share = x**3 * (10 - 15 * x + 6 * x**2)
    angles = np.outer(np.subtract(move.target, move.start), share) + np.array(move.start)[:, None]
    track = np.array([np.array(ca.DM(move.tool(column)))[:, 0] for column in angles.T])
    posts = list[tuple[float, float, float]]()
    for _ in range(100):
        if len(posts) == count:
            return tuple(posts)
        radius = random.uniform(0.03, 0.06)
        place = track[random.integers(STEPS // 4, 3 * STEPS // 4)] + random.normal(0, 0.02, 2)
        near = [np.hypot(*(place - (x, y))) - other for x, y, other in posts]
        near += [np.hypot(*(place - end)) for end in track[[0, -1]]]
        if min(near) > radius + APART:
            posts.append((float(place[0]), float(place[1]), radius))
    return None


def has_way(move: PostsMove, random: np.random.Generator) -> bool:
    """Return whether the plain move hits a post and one of 2,000 random candidates hits none."""
    candidates = random.uniform(move.lower, move.upper, (2_000, move.size))

    def is_free(candidate: Array) -> bool:
        return bool((np.array(move.depths(candidate)) <= SLACK).all())

    return not is_free(np.zeros(move.size)) and any(map(is_free, candidates))
