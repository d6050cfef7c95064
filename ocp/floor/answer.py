"""Floor: the least energy that was found over all joint motions, and how it was found."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import ClassVar

from ocp.answers.documents import Document, motion_of, task_from_document, task_to_document
from ocp.answers.provenance import Provenance, Verification, provenance_of, verification_of
from ocp.answers.saved import Saved
from ocp.base.checks import finite, positive, whole
from ocp.base.status import SolveStatus
from ocp.floor.motion import FreeMotion, simulate
from ocp.simulation.cvodes import Trajectory
from ocp.simulation.objective import Motion
from ocp.task.point_to_point import PointToPoint

_FIRST_ORDER, _MOST_RATIO = 0.5, 0.8
"""Ratios of successive falls of the energy: where the error is proportional to the intervals, as
at a jump of the speed or the torque within one, and the largest that is taken for a series."""


@dataclass(frozen=True)
class Level:
    """One grid of the refinement.

    Attributes
    ----------
    steps : int
        Intervals.
    energy : float
        Least energy on it, by the solver's own quadrature [J].
    """

    steps: int
    energy: float


@dataclass(frozen=True)
class Floor(Saved):
    """The least energy of a move over all joint motions, at rest on arrival.

    The energy is that of one motion that does the move, so that the true floor is no higher; how
    much lower it may be, `left` estimates. Neither counts a better motion far from all starts.

    Attributes
    ----------
    task : PointToPoint
        The move.
    free : FreeMotion
        How the joint moves.
    motion : Motion
        Residual, energy and diagnostics, by the independent integrator.
    levels : tuple of Level
        The grids, coarse to fine, with their energies. The motion is that of the last, or where
        the energy rose on the way, of a coarser one that needs less.
    starts : tuple of float
        Energy [J] at which each solved start ended, all on the second grid.
    status : SolveStatus
        How the last solve ended.
    verification : Verification
        Distance between the two integrators.
    provenance : Provenance
        Method, settings, versions, time.
    """

    kind: ClassVar[str] = "floor"

    task: PointToPoint
    free: FreeMotion
    motion: Motion
    levels: tuple[Level, ...]
    starts: tuple[float, ...]
    status: SolveStatus
    verification: Verification
    provenance: Provenance

    @property
    def energy(self) -> float:
        """F2: driving energy [J], by the independent integrator."""
        return self.motion.energy

    @property
    def residual(self) -> float:
        """F1: largest absolute tip displacement after arrival [m], that of rest."""
        return self.motion.residual

    @property
    def smooth(self) -> bool:
        """Whether the acceleration is continuous."""
        return bool(self.provenance.settings["smooth"])

    @property
    def change(self) -> float:
        """Fall of the energy from the last grid but one to the last [J]; the other way, below 0."""
        return self.levels[-2].energy - self.levels[-1].energy

    @property
    def settled(self) -> bool:
        """Whether that is within the tolerance; else the refinement ended before."""
        tolerance = float(self.provenance.settings["tolerance"] or 0.0)
        return abs(self.change) <= tolerance * self.levels[-1].energy

    @property
    def ratio(self) -> float | None:
        """The last fall of the energy over the one before; None where two falls are not known.

        A half is an error in proportion to the intervals, a quarter to their square.
        """
        if len(self.levels) < 3:
            return None
        before = self.levels[-3].energy - self.levels[-2].energy
        return self.change / before if before > 0 < self.change else None

    @property
    def left(self) -> float:
        """Estimate of how far the energy would still fall with ever finer grids [J].

        The last fall continued as a geometric series, and what the solver's own quadrature misses.
        The ratio of the series is that of the last two falls, but at least 1/2: grids that begin
        coarse gain faster at first than they go on to. An estimate, no bound; it leaves out that
        a jolt takes up to 4e-5 of the move on every grid, about 1e-4 of the energy.

        Where a coarser grid needs less than the last, the falls are no series: the energy went to
        another minimum, and a better one may be missed. Then the estimate is the fall down to the
        lowest grid, or the rise since, whichever is more: the order of what is unknown, no more.
        """
        energies = [level.energy for level in self.levels]
        lowest = energies.index(min(energies))
        missed = max(-self.verification.energy_difference, 0.0)
        if energies[lowest] < energies[-1]:
            fall = energies[lowest - 1] - energies[lowest] if lowest else 0.0
            return max(fall, max(energies[lowest:]) - energies[lowest]) + missed
        ratio = min(max(self.ratio or 0.0, _FIRST_ORDER), _MOST_RATIO)
        return self.change * ratio / (1 - ratio) + missed

    def agreeing(self, share: float = 0.005) -> int:
        """How many starts ended within a share of the best of them."""
        return sum(energy <= min(self.starts) * (1 + share) for energy in self.starts)

    @cached_property
    def trajectory(self) -> Trajectory:
        """The move and the residual window by CVODES; times stand twice where the torque jumps."""
        return simulate(self.task, self.free).trajectory

    def to_document(self) -> Document:
        """The floor in JSON's types, SI units and radians."""
        return {
            **task_to_document(self.task),
            "motion": {name: values.tolist() for name, values in vars(self.free).items()},
            "figures": asdict(self.motion),
            "levels": [asdict(level) for level in self.levels],
            "starts": list(self.starts),
            "status": self.status.value,
            "verification": asdict(self.verification),
            "provenance": {**vars(self.provenance), "settings": dict(self.provenance.settings)},
        }

    @classmethod
    def from_document(cls, document: Document) -> Floor:
        """The floor of a document; KeyError, TypeError or ValueError where it is not one."""
        task, free = task_from_document(document), FreeMotion(**document["motion"])
        if not math.isclose(free.times[-1], task.duration, rel_tol=1e-12):
            raise ValueError(
                f"its times end at {free.times[-1]:g} s, not at the duration {task.duration:g} s"
            )
        levels = tuple(
            Level(whole("steps", level["steps"], 1), finite("energy", level["energy"], "J"))
            for level in document["levels"]
        )
        starts = tuple(finite("energy of a start", value, "J") for value in document["starts"])
        if len(levels) < 2 or not starts:
            raise ValueError("it has fewer than two levels, or no start")
        provenance = provenance_of(document["provenance"])
        if not isinstance(provenance.settings.get("smooth"), bool):
            raise ValueError("its settings do not say whether it is smooth")
        positive("tolerance", provenance.settings.get("tolerance"))
        return cls(
            task=task,
            free=free,
            motion=motion_of(document["figures"]),
            levels=levels,
            starts=starts,
            status=SolveStatus(document["status"]),
            verification=verification_of(document["verification"]),
            provenance=provenance,
        )
