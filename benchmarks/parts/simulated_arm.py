"""Arms in MuJoCo, many candidates a call: dry friction, backlash, and a post that crosses or none.

The model is simulated_arm.xml: a motor with a servo drives a link through backlash, and a spring
bends between that link and an outer one, which carries a load. A post may come into the way and
leave it again: an arm passes before it or after it, so that there are two basins. `ARMS` are three
problems of one such machine; `drawn` draws ten machines and moves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import casadi as ca
import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray

import quietarm as qa

Array = NDArray[np.float64]
MODEL = Path(__file__).with_name("simulated_arm.xml")
STEP, AFTER = 1e-3, 0.4
"""Seconds of a step, and how long the arm is watched after the move."""
LENGTH, LINK = 0.2, 0.05
"""Of each link [m, kg], as in the model."""
POST = """<body name="post" pos="{x:.9g} {y:.9g} 0">
  <joint name="slide" type="slide" axis="{along_x:.9g} {along_y:.9g} 0"
    stiffness="{stiffness:.9g}"/>
  <geom type="cylinder" size=".008 .1" mass="{mass:g}"/>
  <site name="around" type="cylinder" size=".02 .12"/></body>"""
TOUCH = '<touch site="around"/>'
LOAD = '<geom size=".01" pos=".2 0 0" mass="{:.9g}" contype="0" conaffinity="0"/>'
MIDDLE, SWING, MASS = 0.45, 0.05, 50.0
"""The post's oscillation along a radius: the middle's distance [m], amplitude [m] and mass [kg], so
heavy that an arm hardly turns it away. The arm's tip is at 0.4 m."""
SEED = 300
"""The ten arms are drawn from it."""
COUNT = 5
"""Drawn problems without a post, and with one; coefficients are 4 and 8 in turn, five each."""
TRIED, WAYS = 200, 10
"""Random candidates that look for ways past a drawn post, and how many pass it on each side."""
LEAST, MOST = 2e-3, 0.2
"""Residual of the plain cycloid of a drawn move [m]."""


@dataclass(frozen=True)
class Machine:
    """Numbers that the model leaves open; the defaults are those of the first three problems.

    Attributes
    ----------
    friction : float
        Dry friction of the motor [N m].
    backlash : float
        Half its width [rad].
    stiffness, damping : float
        Of the spring between the links [N m/rad, N m s/rad].
    load : float
        At the tip [kg].
    servo_stiffness, servo_damping : float
        The servo's gains [N m/rad, N m s/rad].
    """

    friction: float = 0.02
    backlash: float = 0.004
    stiffness: float = 0.3
    damping: float = 5e-4
    load: float = 0.0
    servo_stiffness: float = 40.0
    servo_damping: float = 0.8


@dataclass(frozen=True)
class Post:
    """A post that oscillates along a radius, outside at the begin of a move.

    Attributes
    ----------
    angle : float
        Of the radius [rad].
    period : float
        Of the oscillation [s].
    """

    angle: float
    period: float

    @property
    def words(self) -> str:
        """Return the post in MuJoCo's words."""
        along = np.array([np.cos(self.angle), np.sin(self.angle)])
        return POST.format(
            x=MIDDLE * along[0],
            y=MIDDLE * along[1],
            along_x=along[0],
            along_y=along[1],
            stiffness=MASS * (2 * np.pi / self.period) ** 2,
            mass=MASS,
        )


@dataclass(frozen=True)
class SimulatedArm:
    """A black box: coefficients to residual [m], energy [J] and seconds for which the post is hit.

    Attributes
    ----------
    name : str
        What a table calls it.
    terms : int
        Coefficients of the path.
    post : Post, optional
        One that crosses the way.
    machine : Machine
        The arm and its servo.
    target : float
        Of the move [rad].
    duration : float
        Of the move [s].
    bound : float
        Of the coefficients.
    """

    name: str
    terms: int = 4
    post: Post | None = None
    machine: Machine = Machine()
    target: float = qa.deg(30)
    duration: float = 0.8
    bound: float = 0.3

    vectorized = True
    objectives = ("residual", "energy")

    @property
    def constraints(self) -> list[str]:
        """Names of the constraints: the post, where there is one."""
        return ["touch"] if self.post else []

    @cached_property
    def task(self) -> qa.PointToPoint:
        """The move: its target and duration alone count."""
        return qa.PointToPoint(qa.SingleLinkManipulator(), self.target, self.duration)

    @cached_property
    def profile(self) -> qa.CycloidPolynomial:
        """The path's family."""
        return qa.CycloidPolynomial(self.terms)

    @property
    def lower(self) -> Array:
        """The least coefficients."""
        return self.profile.box(self.bound)[0]

    @property
    def upper(self) -> Array:
        """The largest coefficients."""
        return self.profile.box(self.bound)[1]

    @cached_property
    def model(self) -> mujoco.MjModel:
        """Return the model of MuJoCo."""
        text = MODEL.read_text().format(
            **vars(self.machine) | {"load": LOAD.format(self.machine.load)},
            post=self.post.words if self.post else "",
            touch=TOUCH if self.post else "",
        )
        return mujoco.MjModel.from_xml_string(text)

    def __call__(self, candidates: Array) -> Any:
        """Objectives of many candidates, and their violations."""
        rows = np.atleast_2d(candidates)
        time, fraction, sent = self._path
        controls = np.array([sent(row, fraction).full().T for row in rows])
        controls[:, time > self.duration, 1] = 0.0
        begin = self._begin()
        _, sensors = rollout.rollout(
            self.model, mujoco.MjData(self.model), np.tile(begin, (len(rows), 1)), controls
        )
        moving = time < self.duration
        target = 2 * LENGTH * np.array([np.cos(self.target), np.sin(self.target), 0.0])
        off = np.linalg.norm(sensors[:, :, :3] - target, axis=2)[:, ~moving].max(axis=1)
        power = np.abs(sensors[:, :, 3] * sensors[:, :, 4:6].sum(axis=2))
        objectives = np.column_stack([off, STEP * power[:, moving].sum(axis=1)])
        if not self.post:
            return objectives
        return objectives, STEP * (sensors[:, :, 6:] > 0).sum(axis=1) - 1e-6

    @cached_property
    def _path(self) -> tuple[Array, Array, ca.Function]:
        """Times and fractions of the move, and the path's angle and speed there; built once.

        The samples are those of `quietarm.motion_of`.
        """
        time, *_ = qa.motion_of(
            self.task, self.profile, np.zeros(self.terms), step=STEP, after=AFTER
        )
        coefficients, fraction = ca.SX.sym("a", self.terms), ca.SX.sym("fraction")
        motion = self.profile.motion(
            tuple(ca.vertsplit(coefficients)), fraction, 0.0, self.target, self.duration
        )
        sent = ca.Function(
            "sent", [coefficients, fraction], [ca.vertcat(motion.angle, motion.speed)]
        )
        return time, np.clip(time / self.duration, 0.0, 1.0)[None], sent

    def _begin(self) -> Array:
        """The state at the start, the post on its way."""
        data = mujoco.MjData(self.model)
        if self.post:
            data.joint("slide").qpos[0] = SWING  # outside, at rest
        spec = mujoco.mjtState.mjSTATE_FULLPHYSICS
        state = np.empty(mujoco.mj_stateSize(self.model, spec))
        mujoco.mj_getState(self.model, data, state, spec)
        return state

    def passes_early(self, candidate: Array) -> bool:
        """Return whether the sent path is past the post's radius before the move's middle."""
        time, angle, *_ = qa.motion_of(self.task, self.profile, candidate, step=STEP, after=0.0)
        return bool(time[np.argmax(angle > self.post.angle)] < self.duration / 2)


CROSSING = Post(qa.deg(15), 0.8)
ARMS = (
    SimulatedArm("friction and backlash, 4 coefficients"),
    SimulatedArm("friction and backlash, 8 coefficients", 8),
    SimulatedArm("a post that crosses, 4 coefficients", 4, CROSSING),
)


@cache
def drawn() -> tuple[SimulatedArm, ...]:
    """Draw the family: arms without a post and with one, and four or eight coefficients in turn."""
    random = np.random.default_rng(SEED)
    kinds = (("arm", False), ("arm-post", True))
    return tuple(
        draw(random, f"{kind}-{terms}-{'abcde'[place]}", terms, crosses)
        for first, (kind, crosses) in enumerate(kinds)
        for place in range(COUNT)
        for terms in [(4, 8)[(first + place) % 2]]
    )


def draw(random: np.random.Generator, name: str, terms: int, crosses: bool) -> SimulatedArm:
    """Draw a machine and a move, again until the plain cycloid leaves something to do."""
    while True:
        load = random.uniform(0.0, 0.05)
        frequency = random.uniform(2.5, 5.0)
        # of the outer link on its spring, with the motor held
        stiffness = (2 * np.pi * frequency) ** 2 * (LINK / 3 + load) * LENGTH**2
        machine = Machine(
            friction=random.uniform(0.01, 0.08),
            backlash=random.uniform(0.002, 0.008),
            stiffness=stiffness,
            damping=stiffness * random.uniform(0.005, 0.03) / (np.pi * frequency),
            load=load,
            servo_stiffness=random.uniform(30.0, 60.0),
            servo_damping=random.uniform(0.6, 1.2),
        )
        target = random.uniform(qa.deg(15), qa.deg(60))
        duration = random.uniform(1.5, 2.5) / frequency
        post = Post(random.uniform(0.4, 0.6) * target, duration) if crosses else None
        arm = SimulatedArm(name, terms, post, machine, target, duration)
        if leaves_something(arm, random):
            return arm


def leaves_something(arm: SimulatedArm, random: np.random.Generator) -> bool:
    """Return whether the plain cycloid leaves 2 to 200 mm, and hits a post that has two ways past.

    There are two ways if ten of 200 random candidates pass before the post, and ten after it.
    """
    plain = arm(np.zeros((1, arm.terms)))
    if not arm.post:
        return bool(LEAST <= plain[0, 0] <= MOST)
    objectives, violations = plain
    if violations[0, 0] <= 0 or not LEAST <= objectives[0, 0] <= MOST:
        return False
    rows = random.uniform(arm.lower, arm.upper, (TRIED, arm.terms))
    clear = rows[arm(rows)[1][:, 0] <= 0]
    early = sum(arm.passes_early(row) for row in clear)
    return min(early, len(clear) - early) >= WAYS
