"""The arm of docs/simulators.md in MuJoCo, many candidates a call: dry friction, backlash, a post.

The model is the page's, and MuJoCo's own rollout takes all steps. In place of the page's post,
which stands beside the target, there is none, or one that comes into the way and leaves it again:
an arm passes before it or after it, so that there are two basins.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray

import quietarm as qa

Array = NDArray[np.float64]
PAGE = Path(__file__).parents[2] / "docs" / "simulators.md"
STEP, AFTER = 1e-3, 0.4
"""Seconds of a step, and how long the arm is watched after the move."""
CROSSING = """<body name="post" pos="{x:.9g} {y:.9g} 0">
  <joint name="slide" type="slide" axis="{along_x:.9g} {along_y:.9g} 0"
    stiffness="{stiffness:.9g}"/>
  <geom type="cylinder" size=".008 .1" mass="{mass:g}"/>
  <site name="around" type="cylinder" size=".02 .12"/></body>"""
TOUCH = '<touch site="around"/>'


ANGLE, MIDDLE, SWING, PERIOD, MASS = qa.deg(15), 0.45, 0.05, 0.8, 50.0
"""The post's oscillation along a radius: its angle [rad], the middle's distance [m], amplitude [m],
period [s] and mass [kg], so heavy that an arm hardly turns it away. The arm's tip is at 0.4 m."""


def post_words() -> str:
    """The post in MuJoCo's words."""
    along = np.array([np.cos(ANGLE), np.sin(ANGLE)])
    return CROSSING.format(
        x=MIDDLE * along[0],
        y=MIDDLE * along[1],
        along_x=along[0],
        along_y=along[1],
        stiffness=MASS * (2 * np.pi / PERIOD) ** 2,
        mass=MASS,
    )


def model_of(crosses: bool) -> mujoco.MjModel:
    """The page's model, with a post that crosses the way in place of its post, or with none."""
    found = re.search(r"^```xml\n(.*?)^```$", PAGE.read_text(), re.DOTALL | re.MULTILINE)
    if found is None:
        raise ValueError(f"{PAGE} has no model of MuJoCo")
    model = "".join(line for line in found[1].splitlines(True) if '"post"' not in line)
    if crosses:
        model = model.replace("</worldbody>", f"{post_words()}</worldbody>")
        model = model.replace("</sensor>", f"{TOUCH}</sensor>")
    return mujoco.MjModel.from_xml_string(model)


@dataclass(frozen=True)
class SimulatedArm:
    """A black box: coefficients to residual [m], energy [J] and seconds for which the post is hit.

    Attributes
    ----------
    name : str
        What a table calls it.
    terms : int
        Coefficients of the path.
    crosses : bool
        Whether a post slides across the way.
    """

    name: str
    terms: int = 4
    crosses: bool = False
    bound: float = 0.3
    """Of the coefficients."""

    vectorized = True
    objectives = ("residual", "energy")

    @property
    def constraints(self) -> list[str]:
        """Names of the constraints: the post, where there is one."""
        return ["touch"] if self.crosses else []

    @cached_property
    def task(self) -> qa.PointToPoint:
        """The page's move: its target and duration alone count."""
        return qa.PointToPoint(qa.SingleLinkManipulator(), target=qa.deg(30), duration=0.8)

    @cached_property
    def profile(self) -> qa.CycloidPolynomial:
        """The path's family."""
        return qa.CycloidPolynomial(self.terms)

    @property
    def box(self) -> tuple[Array, Array]:
        """The box of the coefficients."""
        return self.profile.box(self.bound)

    @cached_property
    def _model(self) -> mujoco.MjModel:
        return model_of(self.crosses)

    def __call__(self, candidates: Array) -> Any:
        """Objectives of many candidates, and their violations."""
        rows = np.atleast_2d(candidates)
        paths = [qa.motion_of(self.task, self.profile, row, step=STEP, after=AFTER) for row in rows]
        controls = np.array([np.column_stack([path[1], path[2]]) for path in paths])
        begin = self._begin()
        _, sensors = rollout.rollout(
            self._model, mujoco.MjData(self._model), np.tile(begin, (len(rows), 1)), controls
        )
        moving = np.array(paths[0][0]) < self.task.duration
        angle = self.task.target
        target = 0.4 * np.array([np.cos(angle), np.sin(angle), 0.0])
        off = np.linalg.norm(sensors[:, :, :3] - target, axis=2)[:, ~moving].max(axis=1)
        power = np.abs(sensors[:, :, 3] * sensors[:, :, 4])
        objectives = np.column_stack([off, STEP * power[:, moving].sum(axis=1)])
        if not self.crosses:
            return objectives
        return objectives, STEP * (sensors[:, :, 5:] > 0).sum(axis=1) - 1e-6

    def _begin(self) -> Array:
        """The state at the start, the post on its way."""
        data = mujoco.MjData(self._model)
        if self.crosses:
            data.joint("slide").qpos[0] = SWING  # outside, at rest
        spec = mujoco.mjtState.mjSTATE_FULLPHYSICS
        state = np.empty(mujoco.mj_stateSize(self._model, spec))
        mujoco.mj_getState(self._model, data, state, spec)
        return state


ARMS = (
    SimulatedArm("friction and backlash, 4 coefficients"),
    SimulatedArm("friction and backlash, 8 coefficients", 8),
    SimulatedArm("a post that crosses, 4 coefficients", 4, crosses=True),
)
