"""Floor: the least energy that was found over all joint motions, and how it was found."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import ClassVar

import numpy as np
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.checks import CountFromOne, Positive
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.record import Record, Verification
from quietarm.ocp.saved import MotionAnswer
from quietarm.ocp.simulation.objective import Motion
from quietarm.ocp.simulation.trajectory import Trajectory
from quietarm.ocp.task import PointToPoint

_FIRST_ORDER, _MOST_RATIO = 0.5, 0.8
"""Ratios of successive falls of the energy: where the error is proportional to the intervals'
length (1/4 to its square), and above which they are not taken for a converging series."""


@dataclass(frozen=True)
class Level:
    """One grid of the refinement."""

    steps: CountFromOne
    energy: float


@dataclass(frozen=True)
class Floor(MotionAnswer):
    """The best motion found without a parametrisation, at rest on arrival or as the task asks.

    Its energy is an upper estimate of the least energy of all motions. `discretisation_error`
    estimates how far finer grids would lower it; a better local minimum far from all starts may
    exist.

    Attributes
    ----------
    free : FreeMotion
        How the joint moves.
    motion : Motion
        Residual, energy and diagnostics, by the independent integrator.
    levels : tuple of Level
        The grids, coarse to fine. The motion is that of the last, or of a coarser one if that has a
        lower energy.
    starts : tuple of float
        Energy [J] at which each solved start ended, all on the second grid.
    tolerance : float
        Share of the energy by which the last two grids were to differ at most.
    """

    kind: ClassVar[str] = "floor"
    version: ClassVar[int] = 3

    task: PointToPoint
    free: FreeMotion
    motion: Motion
    levels: tuple[Level, ...]
    starts: tuple[float, ...]
    status: SolveStatus
    verification: Verification
    tolerance: Positive
    record: Record

    def __post_init__(self) -> None:
        end, duration = self.free.times[-1], self.task.duration
        if not math.isclose(end, duration, rel_tol=1e-12):
            raise ValueError(f"its times end at {end:g} s, not at the duration {duration:g} s")
        if len(self.levels) < 2 or not self.starts:
            raise ValueError("it has fewer than two levels, or no start")

    @property
    def smooth(self) -> bool:
        """Whether the acceleration is continuous."""
        return bool(np.any(self.free.jerk))

    @property
    def change(self) -> float:
        """Decrease of the energy from the last but one grid to the last [J]; may be negative."""
        return self.levels[-2].energy - self.levels[-1].energy

    @property
    def settled(self) -> bool:
        """Whether this is within the tolerance; otherwise the refinement ended early."""
        return abs(self.change) <= self.tolerance * self.levels[-1].energy

    @property
    def ratio(self) -> float | None:
        """The last decrease of the energy over the one before; None if there are not two."""
        falls = [one.energy - other.energy for one, other in pairwise(self.levels)][-2:]
        return falls[1] / falls[0] if len(falls) == 2 and min(falls) > 0 else None

    @property
    def discretisation_error(self) -> float:
        """Estimate of how far ever finer grids would lower the energy [J]; it is no bound.

        The last decrease is continued as a geometric series, by the ratio of the last two but at
        least 1/2, and the quadrature error of the solver is added. A pulse of acceleration takes
        up to 4e-5 of the move on every grid, which costs about 1e-4 of the energy and is neglected.
        Where a coarser grid has a lower energy than the last, the solver has changed to another
        local minimum: then the larger of the decrease and the increase is an order of magnitude.
        """
        energies = [level.energy for level in self.levels]
        lowest = energies.index(min(energies))
        missed = max(-self.verification.energy_difference, 0.0)
        if energies[lowest] < energies[-1]:
            return max(energies[max(lowest - 1, 0) :]) - energies[lowest] + missed
        ratio = min(max(self.ratio or 0.0, _FIRST_ORDER), _MOST_RATIO)
        return self.change * ratio / (1 - ratio) + missed

    def agreeing(self, share: float = 0.005) -> int:
        """How many starts ended within a share of the best of them."""
        return sum(energy <= min(self.starts) * (1 + share) for energy in self.starts)

    @cached_property
    def candidate(self) -> Candidate:
        """The motion on the nominal plant, evaluated by CVODES."""
        return Candidate.of_free_motion(self.task.certain, self.free)

    @property
    def trajectory(self) -> Trajectory:
        """The move and the residual window by CVODES; where the torque jumps, two at a time."""
        return self.candidate.trajectory
