"""When the frames of an animation are, and how many there may be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.base.checks import positive
from quietarm.studies.figures import Line

MOST_FRAMES = 500
"""More would take minutes, and make a file that is too large to be shown."""
LEAST_A_SECOND, MOST_A_SECOND = 1, 50
"""Fewer frames are no motion; browsers show no more of a GIF."""
_ROUNDING = 1e-6
"""Of a frame: one that is this close to the end belongs to it."""


@dataclass(frozen=True, eq=False)
class Clock:
    """The one clock of all motions in an animation."""

    end: float
    speed: float = 1.0
    frames_per_second: float = 25.0
    times: NDArray[np.float64] = field(init=False)

    def __post_init__(self) -> None:
        speed = positive("speed", self.speed)
        rate = positive("frames per second", self.frames_per_second)
        if rate > MOST_A_SECOND:
            raise ValueError(
                f"frames per second is {rate:g}; give at most {MOST_A_SECOND}: browsers show no "
                "more of a GIF"
            )
        if rate < LEAST_A_SECOND:
            raise ValueError(
                f"frames per second is {rate:g}; give at least {LEAST_A_SECOND}, and a lower speed "
                "for slow motion"
            )
        frames = self.end * rate / speed
        if frames > MOST_FRAMES:
            raise ValueError(
                f"{self.end:g} s at {rate:g} frames per second and speed {speed:g} make "
                f"{frames:.0f} frames, where {MOST_FRAMES} are the most that can be drawn and "
                "shown in reasonable time; give fewer frames per second or a higher speed"
            )
        object.__setattr__(self, "times", np.arange(int(frames + _ROUNDING) + 1) * speed / rate)


def end_of(lines: Sequence[Line]) -> float:
    """When the last of several motions is over, and the time after it in which it may vibrate."""
    return max(line.plan.task.duration + line.plan.task.residual_window for line in lines)
