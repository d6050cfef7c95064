"""Films of plans, side by side in the same time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from quietarm.views.film_settings import FRAMES, WIDTHS
from quietarm.views.formats.export_format import (
    PLAN,
    SEVERAL,
    Answers,
    Exported,
    ExportFormat,
    ExportSetting,
    Progress,
    values_of,
)

DEFLECTION_SCALE = ExportSetting(
    "deflection_scale", None, "Draw deflections so many times larger; by default the largest "
    "becomes up to a fifth of the structure.", kind=float,
)  # fmt: skip
"""Of every picture of a structure that moves."""


class GifFilm(ExportFormat):
    """A plan alone is shown beside the plain cycloid of its move."""

    name = "gif"
    endings = (".gif",)
    meaning = "a film"
    takes = (PLAN, SEVERAL)
    pieces = "frames"
    settings = (
        ExportSetting("speed", 1.0, "Playback speed; 25% is slow motion.", unit="-"),
        DEFLECTION_SCALE,
        ExportSetting("width", 800, "Width in pixels.", *WIDTHS),
        ExportSetting("rate", FRAMES, "Frames in a second [Hz].", unit="Hz"),
    )

    def export(self, answers: Answers, path: Path, report: Progress, **settings: Any) -> Exported:
        """The film, and how long and how large it is."""
        from quietarm.views.film import animate  # matplotlib is slow to load
        from quietarm.views.pictures.motion import Line

        plans = values_of(answers)
        numbered = [f"plan {number}" for number in range(1, len(plans) + 1)]
        names = list(answers) if isinstance(answers, Mapping) else numbered
        motions: Any = plans[0] if len(plans) == 1 else [*map(Line, plans, names)]
        film = animate(motions, **settings)
        content = film.content(self.name, report)
        size = f"{len(content) / 1e3:.0f} kB"
        return Exported({path: content}, [f"{film.frames} frames, {film.seconds:.1f} s, {size}"])


class Mp4Film(GifFilm):
    """Film as mp4, by the program ffmpeg."""

    name = "mp4"
    endings = (".mp4",)
