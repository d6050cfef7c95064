"""The steps of a move: where each begins and ends, and how many there are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.collocation import GAUSS_NODES
from quietarm.ocp.simulation.free_vibration import fastest_along
from quietarm.ocp.task import PointToPoint

MOST_STEPS = 20_000
"""Of any simulation by fixed steps: finer ones differ by rounding alone."""
ROLLOUT_STEPS = 140
"""Steps that keep the energy of random coefficients of the paper's bounds within 1e-5 relative."""


@dataclass(frozen=True)
class Mesh:
    """Steps of a move, or of a smooth piece of it, as fractions of its duration.

    Steps are finer at the ends, where the powers of T in the profile change fastest: in the paper's
    boxes the error is a tenth to a thirtieth of that of even steps. A step ends at each of the
    `breaks`, where the motion is not smooth: then there are somewhat more than `steps`, and at
    least `of_a_piece` between two breaks.
    """

    steps: int
    breaks: tuple[float, ...] = ()
    of_a_piece: int = JointProfile.steps_of_a_piece

    @cached_property
    def boundaries(self) -> NDArray[np.float64]:
        """Begins and ends of the steps, shape (steps + 1,)."""
        if not self.breaks:
            even = np.arange(self.steps + 1) / self.steps
            return even / 2 + (1 - np.cos(np.pi * even)) / 4
        pieces = [np.zeros(1)]
        for start, end in pairwise((0.0, *self.breaks, 1.0)):
            piece = Mesh(max(self.of_a_piece, math.ceil((end - start) * self.steps)))
            pieces.append(start + (end - start) * piece.boundaries[1:])
        return np.concatenate(pieces)

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Lengths of the steps, shape (steps,)."""
        return np.diff(self.boundaries)

    @property
    def nodes(self) -> NDArray[np.float64]:
        """The Gauss nodes, shape (nodes of a step, steps)."""
        return self.boundaries[:-1] + np.outer(GAUSS_NODES, self.lengths)

    @property
    def samples(self) -> NDArray[np.float64]:
        """All nodes in the order of time, between both ends."""
        return np.concatenate([[0.0], self.nodes.T.ravel(), [1.0]])

    def stretch(self, fraction: Expression) -> Expression:
        """A node's place, stretched from the start of the move to its end where nothing breaks.

        The jerk is sampled there: unlike all else it may be largest at the very ends.
        """
        if self.breaks:
            return fraction
        first = float(self.boundaries[1] * GAUSS_NODES[0])
        return (fraction - first) / (1 - 2 * first)

    def columns(self, candidates: int = 1) -> tuple[list[ca.DM], ca.DM]:
        """The nodes, and the lengths, with a row for each candidate and a column for each step."""
        rows = [ca.repmat(ca.DM(row).T, candidates, 1) for row in (*self.nodes, self.lengths)]
        return rows[:-1], rows[-1]


def mesh_of(profile: JointProfile, steps: int, breaks: tuple[float, ...]) -> Mesh:
    """So many steps of a move along a profile, or somewhat more where it breaks."""
    return Mesh(steps, breaks, profile.steps_between_breaks(steps))


def default_steps(task: PointToPoint, least: int = ROLLOUT_STEPS) -> int:
    """Steps for the profile (`least`), and 2 a radian of the fastest mode of all scenarios."""
    plants = task.perturbed_plants
    radians = task.duration * max(fastest_along(plant, task.start, task.target) for plant in plants)
    if 2 * radians > MOST_STEPS:
        raise ValueError(
            f"duration {task.duration:g} s is {radians:.3g} radians of the plant's fastest mode; "
            f"quietarm resolves up to {MOST_STEPS // 2}: give a shorter duration"
        )
    return max(least, math.ceil(2 * radians))
