"""Files of frames: a GIF by Pillow, an MP4 by the program ffmpeg."""

from __future__ import annotations

import io
import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from quietarm.ocp import QuietarmError

Picture = NDArray[np.uint8]
"""Red, green and blue of every pixel, shape (height, width, 3)."""

PAUSE = 0.5
"""The first frame stays for so long more [s]: where everything rests, the eye finds the start."""
_COLOURS = 128
_FILTERS = f"crop=trunc(iw/2)*2:trunc(ih/2)*2,tpad=start_mode=clone:start_duration={PAUSE}"
"""An MP4 has even sides, by its own rule."""


def gif(frames: Iterable[Picture], rate: float) -> bytes:
    """A GIF that repeats for ever; all frames share the colours of the first and the last."""
    pictures = [Image.fromarray(frame) for frame in frames]
    both = np.vstack([np.asarray(pictures[0]), np.asarray(pictures[-1])])
    palette = Image.fromarray(both).quantize(_COLOURS, dither=Image.Dither.NONE)
    first, *others = (one.quantize(palette=palette, dither=Image.Dither.NONE) for one in pictures)
    ends = np.round(np.arange(len(pictures) + 1) * 100 / rate) * 10  # a GIF counts hundredths
    holds = np.diff(ends).astype(int)
    holds[0] += round(1000 * PAUSE)
    file = io.BytesIO()
    first.save(
        file, format="GIF", save_all=True, append_images=others, duration=holds.tolist(), loop=0
    )
    return file.getvalue()


def mp4(frames: Iterable[Picture], rate: float) -> bytes:
    """An MP4 in the colours that every player knows."""
    if shutil.which("ffmpeg") is None:
        raise ValueError(
            "an MP4 needs the program ffmpeg, which is not found here; install it, or make a GIF"
        )
    with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
        target = Path(folder) / "film.mp4"
        height = width = 0
        with (Path(folder) / "frames").open("w+b") as raw:
            for frame in frames:
                raw.write(frame.tobytes())
                height, width, _ = frame.shape
            raw.seek(0)
            ended = subprocess.run(
                [
                    "ffmpeg", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
                    "-s", f"{width}x{height}", "-r", f"{rate:.6g}", "-i", "-", "-vf", _FILTERS,
                    "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(target),
                ],
                stdin=raw, capture_output=True, check=False,
            )  # fmt: skip
        if ended.returncode != 0 or not target.is_file():
            said = ended.stderr.decode(errors="replace").strip() or "it gave no reason"
            raise QuietarmError(
                f"ffmpeg could not make the MP4: {said.splitlines()[-1]}; end the name in .gif "
                "instead"
            )
        return target.read_bytes()


WRITERS = {"gif": gif, "mp4": mp4}
"""What makes a film, by the ending of its name."""


def format_of(path: str | Path) -> str:
    """The format that a name ends in; ValueError where none is known."""
    ending = Path(path).suffix.lower()[1:]
    if ending not in WRITERS:
        raise ValueError(f"{path} is no animation; end its name in .gif or .mp4")
    return ending
