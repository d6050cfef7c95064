"""One executed move in one recording, with the swing after it by a tip or by the joint's motion."""

from __future__ import annotations

from dataclasses import dataclass, replace

from quietarm.machine.identify.identified import Part
from quietarm.machine.learn.reading.read_force import swing_by_joint
from quietarm.machine.learn.reading.read_swing import AfterMove
from quietarm.machine.recordings.recording import Recording
from quietarm.models import Plant


@dataclass(frozen=True)
class ReadMove:
    """A move in a recording: when it began [s], when it ended, and what swung after it.

    Without a tip that follows from the joint's motion.
    """

    recording: Recording
    start: float
    arrival: float
    after: AfterMove
    doubt: str = ""

    @property
    def by_joint(self) -> bool:
        """Return whether no tip was recorded."""
        return is_by_joint(self.recording)

    def on(self, plant: Plant, place: float) -> ReadMove:
        """Return this move as read by another plant's frequencies."""
        if not self.by_joint:
            return self
        part = self.after.part or Part(self.recording.name, self.start, self.arrival)
        after = swing_by_joint(self.recording, part, self.arrival, plant, place)
        return replace(self, after=replace(after, notes=self.after.notes))


def is_by_joint(recording: Recording) -> bool:
    """Return whether a recording has no tip, so that its swing follows from the joint."""
    return recording.tip is None and recording.acceleration is None
