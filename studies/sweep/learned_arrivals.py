"""The arrival states that the moves of a learned dataset have, so that the machine is still."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quietarm.machine.learn.learn_moves import SmoothDeviation
from quietarm.machine.learn.tip_modes import TipModes
from quietarm.models import Plant
from quietarm.ocp.planning.executed import MoveHistory
from quietarm.ocp.task import ModalState


@dataclass(frozen=True)
class LearnedArrivals:
    """Deviations learned from recordings of some moves of a grid, for all of its moves.

    Attributes
    ----------
    history : MoveHistory
        The moves that were recorded, and what was measured of each.
    modes : tuple of SmoothDeviation
        How each mode swings at arrival.
    """

    history: MoveHistory
    modes: tuple[SmoothDeviation, ...]

    def final(self, plant: Plant, move: tuple[float, float, float]) -> ModalState:
        """The state in which a plant has to arrive, so that the machine is left at rest."""
        told = [smooth.told_for(move, 0.0) for smooth in self.modes]
        return TipModes(plant, move[1]).state(np.array(told))
