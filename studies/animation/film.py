"""Animations of motions: what makes one, shows it in a notebook and saves it."""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.checks import positive, whole
from quietarm.ocp.files import write_whole
from quietarm.studies.animation.cast import cast_of
from quietarm.studies.animation.formats import PAUSE, WRITERS, format_of
from quietarm.studies.animation.stage import frames_of
from quietarm.studies.figures.motion import Motions, lines_of

_MOST_MOTIONS = 6
_MOST_FRAMES = 500
"""More would take minutes, and make a file that is too large to be shown."""
_LEAST_A_SECOND, _MOST_A_SECOND = 1, 50
"""Fewer frames are no motion; browsers show no more of a GIF."""
_LEAST_WIDTH, _MOST_WIDTH = 200, 2000
_ROUNDING = 1e-6
"""Of a frame: one that is this close to the end belongs to it."""


@dataclass(frozen=True, eq=False)
class Animation:
    """A picture that moves; a notebook shows it where it is a cell's last line.

    Attributes
    ----------
    content : bytes
        The file.
    format : str
        ``"gif"`` or ``"mp4"``.
    frames : int
        How many pictures it has.
    seconds : float
        How long it takes [s].
    """

    content: bytes = field(repr=False)
    format: str
    frames: int
    seconds: float

    def save(self, path: str | Path) -> None:
        """Write the file, whole or not at all; ValueError where its ending is another format's."""
        if format_of(path) != self.format:
            raise ValueError(
                f"{path} is not named .{self.format}, as this animation is; name it so, or make "
                f"it with format={format_of(path)!r}"
            )
        write_whole(path, self.content)

    def _repr_html_(self) -> str:
        """What a notebook shows: the file itself, so that it needs no server."""
        content = base64.b64encode(self.content).decode()
        if self.format == "mp4":
            return f'<video controls loop src="data:video/mp4;base64,{content}"></video>'
        words = "Structures in motion; below, joint angle, tip displacement and power over time"
        return f'<img alt="{words}" src="data:image/gif;base64,{content}">'


def animate(
    motions: Motions,
    *,
    deflection_scale: float | None = None,
    speed: float = 1.0,
    frames_per_second: float = 25.0,
    width: int = 800,
    format: str = "gif",  # noqa: A002  # as Pillow and matplotlib call it
    report: Callable[[int, int], object] | None = None,
) -> Animation:
    """Draw structures in motion, side by side and on one clock.

    Every link is bent as its mode bends it, and its plant says how (`Plant.structure`); dashed is
    where it would be without bending. After arrival the path of the tips is drawn. Below are the
    joint angle, the tips' displacements and the power, with a cursor. The clock goes on until the
    last residual window ends.

    Parameters
    ----------
    motions : sequence of Line, Plan or Floor
        The motions, of any plants and durations, 6 at most; a plan alone is drawn beside the plain
        cycloid of its task.
    deflection_scale : float, optional
        How many times larger than they are deflections are drawn, which the picture says; by
        default so that the largest is up to a fifth of the structure, but never less than 1.
    speed : float
        Seconds of the motion in a second of the animation: 0.25 is slow motion.
    frames_per_second : float
        50 at most. A GIF counts hundredths of a second: 50, 25 and 20 are exact, 30 is rounded.
    width : int
        Width of the picture [pixels], 200 to 2000.
    format : str
        ``"gif"``, or ``"mp4"`` where the program ffmpeg is installed.
    report : callable, optional
        Is told how many frames of how many are drawn.

    Returns
    -------
    Animation
        To be shown in a notebook, or saved.

    Raises
    ------
    ValueError
        When there is no motion or too many, a number is out of range, or there is no ffmpeg.
    """
    if format not in WRITERS:
        raise ValueError(f"format is {format!r}; give {' or '.join(map(repr, WRITERS))}")
    lines = lines_of(motions)
    if len(lines) > _MOST_MOTIONS:
        raise ValueError(
            f"{len(lines)} motions are given, where {_MOST_MOTIONS} are the most that can be seen "
            "side by side; give fewer"
        )
    width = whole("width", width, _LEAST_WIDTH, _MOST_WIDTH, "more pixels make a huge file")
    if deflection_scale is not None:
        positive("deflection scale", deflection_scale)
    end = max(line.plan.task.duration + line.plan.task.residual_window for line in lines)
    times = _frame_times(end, speed, frames_per_second)

    cast = cast_of(lines, times, end, deflection_scale)
    content = WRITERS[format](frames_of(cast, end, speed, width, report), frames_per_second)
    return Animation(content, format, len(times), PAUSE + len(times) / frames_per_second)


def _frame_times(end: float, speed: float, rate: float) -> NDArray[np.float64]:
    """When the frames are; ValueError where they are too many, or too few in a second."""
    positive("speed", speed)
    if not _LEAST_A_SECOND <= rate <= _MOST_A_SECOND:
        raise ValueError(
            f"frames per second is {rate:g}; give {_LEAST_A_SECOND} to {_MOST_A_SECOND}: browsers "
            "show no more of a GIF, and slow motion is a lower speed"
        )
    frames = end * rate / speed
    if frames > _MOST_FRAMES:
        raise ValueError(
            f"{end:g} s at {rate:g} frames per second and speed {speed:g} make {frames:.0f} "
            f"frames, where {_MOST_FRAMES} are the most that can be drawn and shown in reasonable "
            "time; give fewer frames per second or a higher speed"
        )
    return np.arange(float(int(frames + _ROUNDING) + 1)) * speed / rate
