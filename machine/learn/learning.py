"""Results of learning: what executed moves told of a machine, and the plan of the next one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from quietarm.machine.identify.identified import Estimate, Identified
from quietarm.ocp.planning.plan import Plan


@dataclass(frozen=True)
class Learning:
    """The result of learning: what a machine left of a plan's move, and the plan that corrects it.

    Lengths are displacements of the tip [m, of a tip that turns rad], of all modes together.

    Attributes
    ----------
    plan : Plan
        The next one. Where there is nothing more to learn it is the same motion.
    left : float
        What swung at arrival: the mean of the recordings.
    by_frequency : float
        How much of it follows from parameters that are changed.
    repeatable : float
        How much beside that every such move leaves.
    scatter : float or None
        Standard deviation of what is left, from recording to recording; None where one recording
        alone was made of each move.
    floor : float
        What no plan takes away: noise, scatter and dry friction.
    next_at_most : float
        What the next move leaves at most, in 95 of 100 cases.
    changed : mapping of str to (float, float)
        Parameters that are changed: the model's value and the new one.
    estimates : tuple of Estimate
        What all recordings together tell of the plant's frequencies and dampings.
    start : mapping of str to float
        When the move began in each recording [s].
    step : float
        Share of the correction that is made: less than 1 where noise would be learned.
    notes : tuple of str
        What is to be known before the plan is executed.
    machine : Identified
        The plant with what was learned, for other moves.
    by_joint : bool
        Whether no tip was recorded, so that all follows from the joint and its torque.
    modes : mapping of str to (float, float)
        Of a robot: the frequency of every mode that moves told [Hz], the plan's and the robot's.
    allowed : float
        What the plan may leave by its residual limit, as this machine shows it, where the move left
        no more; else 0.
    inertias : tuple of Estimate
        Where the joint and its torque were recorded: how many times as heavy as the plan's what
        swings is, its payload, and all that moves. The plan and the machine keep theirs.
    """

    plan: Plan
    left: float
    by_frequency: float
    repeatable: float
    scatter: float | None
    floor: float
    next_at_most: float
    changed: Mapping[str, tuple[float, float]]
    estimates: tuple[Estimate, ...]
    start: Mapping[str, float]
    step: float
    machine: Identified
    by_joint: bool
    notes: tuple[str, ...] = field(default=())
    modes: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    inertias: tuple[Estimate, ...] = field(default=())
    allowed: float = 0.0

    @property
    def is_done(self) -> bool:
        """Return whether there is nothing more to learn: what is left is noise, or allowed."""
        return self.step == 0.0

    def machine_from(self, known: Identified) -> Identified:
        """A machine that is known from other recordings, with what was learned in its place."""
        learned = {estimate.parameter: estimate.value for estimate in self.estimates}
        others = [one for one in known.estimates if one.parameter not in learned]
        untold = {k: why for k, why in known.not_identifiable.items() if k not in learned}
        return replace(
            known,
            plant=replace(known.plant, **learned),
            estimates=(*self.estimates, *others),
            not_identifiable=untold,
            parts=(*known.parts, *self.machine.parts),
            rough={name: value for name, value in known.rough.items() if name not in learned},
            versions=self.machine.versions,
        )
