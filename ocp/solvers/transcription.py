"""One task on a grid of steps: its figures, measured against the profile's plain motion."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.validation import check_profile
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.simulation.grid import default_steps
from quietarm.ocp.solvers.batch import Derivatives, Values, batch
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
ENERGY = "energy"
_LEAST_STEPS, _LIMITED_STEPS, _STEPS_A_TERM = 48, 80, 8
"""Steps that resolve a profile: more with more terms, since the power changes sign more often, but
within the first two; with limits the second, since limits hold only at the nodes."""
MOST_SOLVER_STEPS = 3200
"""The solver's steps are doubled up to this many."""
STILL, STILL_SHARE = 1e-8, 1e-7
"""A motion counts as at rest on arrival up to this verified residual: in metres, or as a share of
the plain cycloid's residual, whichever is larger."""


class Transcription:
    """A task along a profile in a number of steps.

    Attributes
    ----------
    batch : Batch
        Evaluates candidates in any scenario.
    errors : ndarray, shape (scenarios, ranges)
        The plant's errors in every scenario, the nominal one first.
    limits : dict of str to Limit
        The task's by name; and one of the residual, which may have any size.
    wanted : ndarray, shape (2 * modes,)
        The state that is wanted on arrival.
    """

    def __init__(self, task: PointToPoint, profile: JointProfile, steps: int) -> None:
        check_profile(profile)
        self.task, self.profile, self.steps = task, profile, steps
        self.wanted = np.array(task.final_state)
        self.errors = np.array(task.scenarios, dtype=float)
        self.batch = batch(
            task.plant, profile, steps, tuple(one.quantity for one in task.limits),
            task.error_names, task.energy,
        )  # fmt: skip
        self.limits = {one.name: one for one in (*task.limits, Limit.of_residual(np.inf))}

    @classmethod
    def of(
        cls, task: PointToPoint, profile: JointProfile, steps: int | None = None
    ) -> Transcription:
        """On so many steps, or on as many as the task and the profile take to begin with."""
        return cls(task, profile, steps or first_steps(task, profile))

    @cached_property
    def tip_rows(self) -> list[Array]:
        """For each scenario, rows that give tip displacements from the state on arrival."""
        return [vibration.rows for vibration in after_arrival(self.task)]

    @cached_property
    def plain(self) -> Derivatives:
        """The plain motion, in all scenarios."""
        return self.evaluate(self.profile.plain)

    @cached_property
    def arrival_scale(self) -> Array:
        """Scale of the state on arrival, shape (2 * modes,)."""
        scale = np.abs(self.plain.arrival_jacobian).max(axis=(0, 2))
        scale[scale == 0] = 1.0
        return scale

    @cached_property
    def energy_scale(self) -> float:
        """Energy of the plain motion [J]."""
        return float(self.plain.energy[0]) or 1.0

    def scale_of(self, name: str) -> float:
        """Scale of the residual or of a limited quantity."""
        if name == RESIDUAL:
            return max(float(np.abs(r * self.arrival_scale).max()) for r in self.tip_rows) or 1.0
        return self.peak(self.plain, name) or 1.0

    @property
    def plain_residual(self) -> float:
        """Residual of the plain motion [m]."""
        return self.peaks(self.plain)[RESIDUAL]

    def evaluate(self, coefficients: Array) -> Derivatives:
        """One candidate in all scenarios."""
        return evaluate([self], coefficients[None])[0]

    def peaks(self, of: Values, offset: Array | float = 0.0) -> dict[str, float]:
        """The largest residual of all scenarios [m], and the peaks of the limited quantities."""
        missed = of.arrival - self.wanted + offset
        tips = [np.abs(r @ z).max() for r, z in zip(self.tip_rows, missed, strict=True)]
        limited = {name: self.peak(of, name) for name in self.batch.places}
        return {RESIDUAL: float(max(tips)), **limited}

    def peak(self, of: Values, name: str) -> float:
        """The peak of a limited quantity [SI unit], in the scenarios where its limit counts."""
        counted = slice(None if self.limits[name].quantity.in_scenarios else 1)
        values = of.limited[counted, self.batch.places[name]]
        return float(self.limits[name].peak(values.min(), values.max()))


def first_steps(task: PointToPoint, profile: JointProfile) -> int:
    """Steps of the solver to begin with; ValueError where the move is too long for it."""
    fewest = _LIMITED_STEPS if task.limits else _LEAST_STEPS
    least = min(max(fewest, _STEPS_A_TERM * (profile.size - 2)), _LIMITED_STEPS)
    steps = default_steps(task, least=least)
    if steps > MOST_SOLVER_STEPS:
        raise ValueError(
            f"duration is {task.duration:g} s, {steps / 2:.0f} radians of the plant's fastest "
            f"mode; the solver resolves up to {MOST_SOLVER_STEPS // 2}: give a shorter duration"
        )
    return steps


@keep_interrupts()  # casadi loses a Ctrl-C
def evaluate(transcriptions: Sequence[Transcription], coefficients: Array) -> list[Derivatives]:
    """A candidate of each of several transcriptions of one batch, in all its scenarios.

    Coefficients have shape (transcriptions, profile.size).
    """
    counts = [len(one.errors) for one in transcriptions]
    found = transcriptions[0].batch.derivatives(
        np.repeat(coefficients, counts, axis=0),
        np.repeat([one.task.row for one in transcriptions], counts, axis=0),
        np.concatenate([one.errors for one in transcriptions]),
    )
    return [found.take(slice(*ends)) for ends in pairwise(np.cumsum([0, *counts]))]


def transcribe(
    tasks: Sequence[PointToPoint], profile: JointProfile, steps: int
) -> list[Transcription]:
    """Many tasks of one plant, whose plain motions are evaluated in one call."""
    made = [Transcription(task, profile, steps) for task in tasks]
    plain = np.repeat(profile.plain[None], len(made), axis=0)
    for one, motion in zip(made, evaluate(made, plain), strict=True):
        one.__dict__["plain"] = motion
    return made
