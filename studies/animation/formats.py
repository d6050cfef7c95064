"""Files of frames: a GIF by Pillow, an MP4 by the program ffmpeg."""

from __future__ import annotations

import io
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain, repeat
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from quietarm.ocp import QuietarmError

Picture = NDArray[np.uint8]
"""Red, green and blue of every pixel, shape (height, width, 3)."""
Frames = Iterator[Picture]

PAUSE = 0.5
"""The first frame stays for so long more [s]: where everything rests, the eye finds the start."""
_COLOURS = 128
_FFMPEG = "ffmpeg"


@dataclass(frozen=True)
class Format:
    """A kind of file."""

    media_type: str
    write: Callable[[Frames, float], bytes]


def _gif(frames: Frames, rate: float) -> bytes:
    """A GIF that repeats for ever; all frames share the colours of the first and the last."""
    pictures = [Image.fromarray(frame) for frame in frames]
    both = np.vstack([np.asarray(pictures[0]), np.asarray(pictures[-1])])
    palette = Image.fromarray(both).quantize(_COLOURS, dither=Image.Dither.NONE)
    drawn = [one.quantize(palette=palette, dither=Image.Dither.NONE) for one in pictures]
    ends = np.round(np.arange(len(drawn) + 1) * 100 / rate) * 10  # a GIF counts hundredths
    holds = np.diff(ends).astype(int)
    holds[0] += round(1000 * PAUSE)
    file = io.BytesIO()
    drawn[0].save(
        file, format="GIF", save_all=True, append_images=drawn[1:], duration=holds.tolist(), loop=0
    )
    return file.getvalue()


def _mp4(frames: Frames, rate: float) -> bytes:
    """An MP4 in the colours that every player knows."""
    first = next(frames)
    height, width = (2 * (side // 2) for side in first.shape[:2])  # the format's own rule
    still = repeat(first, round(PAUSE * rate))
    with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
        target = Path(folder) / "film.mp4"
        command = [
            _ffmpeg(), "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
            "-s", f"{width}x{height}", "-r", f"{rate:.6g}", "-i", "-",
            "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(target),
        ]  # fmt: skip
        # In a group of its own, so that Ctrl-C reaches this program alone, which ends both.
        with subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
            start_new_session=True,
        ) as process:  # fmt: skip
            try:
                said = _feed(process, (f[:height, :width] for f in chain([first], still, frames)))
            except BaseException:
                process.kill()
                raise
        if process.returncode != 0 or not target.is_file():
            raise QuietarmError(
                f"ffmpeg could not make the MP4: {said or 'it gave no reason'}; end the name in "
                ".gif instead"
            )
        return target.read_bytes()


def _feed(process: subprocess.Popen[bytes], frames: Iterator[Picture]) -> str:
    """Give a process all frames; the last line that it says."""
    assert process.stdin is not None
    try:
        for frame in frames:
            process.stdin.write(np.ascontiguousarray(frame).tobytes())
    except BrokenPipeError:  # it ended early, and says why
        pass
    _, err = process.communicate()
    lines = err.decode(errors="replace").strip().splitlines()
    return lines[-1] if lines else ""


def _ffmpeg() -> str:
    found = shutil.which(_FFMPEG)
    if found is None:
        raise ValueError(
            "an MP4 needs the program ffmpeg, which is not found here; install it, or make a GIF"
        )
    return found


FORMATS = {"gif": Format("image/gif", _gif), "mp4": Format("video/mp4", _mp4)}
"""What can be made, by the ending of its name."""


def format_of(path: str | Path) -> str:
    """The format that a name ends in; ValueError where none is known."""
    ending = Path(path).suffix.lower()[1:]
    if ending not in FORMATS:
        raise ValueError(f"{path} is no animation; end its name in .gif or .mp4")
    return ending


def check_format(name: str) -> None:
    """Make sure that a format is known and can be made here; ValueError otherwise."""
    if name not in FORMATS:
        raise ValueError(f"format is {name!r}; give {' or '.join(map(repr, FORMATS))}")
    if name == "mp4":
        _ffmpeg()
