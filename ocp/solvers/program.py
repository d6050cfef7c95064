"""One task on a grid of steps: its numbers, measured against the profile's plain motion."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.solvers.batch import Derivatives, batch
from quietarm.ocp.solvers.solution import ENERGY, RESIDUAL
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]


class Program:
    """A task's numbers for a number of steps.

    Attributes
    ----------
    batch : Batch
        Evaluates candidates, on the assumed plant and on those with errors.
    errors : ndarray, shape (plants, ranges)
        Errors of the plants whose residual counts; the first is the assumed one.
    row : tuple of float
        The task's, for the assumed plant.
    wanted : ndarray, shape (2 * modes,)
        The state that is wanted on arrival.
    parts : list of (str, slice)
        Where the values of each limited quantity stand among all.
    """

    def __init__(self, task: PointToPoint, profile: JointProfile, steps: int) -> None:
        self.task, self.profile, self.steps = task, profile, steps
        names = task.error_names
        self.plant, self.row, self.wanted = task.plant, task.row, np.array(task.final_state)
        self.errors = np.array(task.scenarios, dtype=float)
        self.batch = batch(self.plant, profile, steps, tuple(task.limits), names, task.energy)
        self.parts = self.batch.parts

    @cached_property
    def tip_rows(self) -> list[Array]:
        """For each plant, rows that give tip displacements from its state on arrival."""
        return [vibration.rows for vibration in after_arrival(self.task)]

    @cached_property
    def plain(self) -> Derivatives:
        """The plain motion, on all plants."""
        return self.evaluated(self.profile.plain)

    @cached_property
    def scale(self) -> Array:
        """Scale of the state on arrival, shape (2 * modes,)."""
        scale = np.abs(self.plain.by_arrival).max(axis=(0, 2))
        scale[scale == 0] = 1.0
        return scale

    @property
    def plain_residual(self) -> float:
        """Residual of the plain motion [m]."""
        return self.peaks(self.plain)[RESIDUAL]

    @cached_property
    def energy(self) -> float:
        """Scale of the energy [J]: that of the plain motion."""
        return float(self.plain.energy[0]) or 1.0

    def scale_of(self, name: str) -> float:
        """Scale of the energy, of the residual or of a limited quantity."""
        if name == ENERGY:
            return self.energy
        if name == RESIDUAL:
            return max(float(np.abs(rows * self.scale).max()) for rows in self.tip_rows) or 1.0
        return self.peak(self.plain, name) or 1.0

    @keep_interrupts()  # casadi loses a Ctrl-C
    def evaluated(self, coefficients: Array) -> Derivatives:
        """One candidate on all plants."""
        return evaluated([self], coefficients[None])[0]

    def peaks(self, of: Derivatives, offset: Array | None = None) -> dict[str, float]:
        """The largest residual of all plants [m], and the peaks of the limited quantities."""
        missed = of.arrival - self.wanted + (0.0 if offset is None else offset)
        left = [np.abs(r @ z).max() for r, z in zip(self.tip_rows, missed, strict=True)]
        return {RESIDUAL: float(max(left)), **{name: self.peak(of, name) for name, _ in self.parts}}

    def peak(self, of: Derivatives, name: str) -> float:
        """The peak of a limited quantity on the assumed plant."""
        return float(np.abs(of.limited[0, dict(self.parts)[name]]).max())


def evaluated(programs: Sequence[Program], coefficients: Array) -> list[Derivatives]:
    """A candidate of each of several programs of one batch, on all its plants."""
    one = programs[0]
    counts = [len(program.errors) for program in programs]
    rows, first = sum(counts), np.cumsum([0, *counts])
    values = one.parts[-1][1].stop if one.parts else 0
    found = one.batch.derivatives(
        np.repeat(coefficients, counts, axis=0),
        np.repeat([program.row for program in programs], counts, axis=0),
        np.concatenate([program.errors for program in programs]),
        np.zeros(rows),
        (np.zeros(rows), np.zeros((rows, 2 * one.plant.modes)), np.zeros((rows, values))),
    )
    return [
        Derivatives(**{name: part[begin:end] for name, part in vars(found).items()})
        for begin, end in pairwise(first)
    ]


def programs_of(tasks: Sequence[PointToPoint], profile: JointProfile, steps: int) -> list[Program]:
    """Programs of many tasks of one plant, whose plain motions are evaluated in one call."""
    programs = [Program(task, profile, steps) for task in tasks]
    plain = np.repeat(profile.plain[None], len(programs), axis=0)
    for program, found in zip(programs, evaluated(programs, plain), strict=True):
        program.__dict__["plain"] = found
    return programs
