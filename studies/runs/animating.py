"""What `quietarm animate` does: plans from files as a picture that moves."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from quietarm.studies.animation import animate
from quietarm.studies.animation.clock import Clock, end_of
from quietarm.studies.animation.formats import check_format, format_of
from quietarm.studies.display.progress import count
from quietarm.studies.display.saving import finish
from quietarm.studies.display.words import print_lines
from quietarm.studies.figures import Line
from quietarm.studies.runs.loading import load_plans
from rich.console import Console


def run_animate(
    paths: Sequence[Path],
    output: Path,
    *,
    speed: float,
    deflection_scale: float | None,
    frames_per_second: float,
    width: int,
    quiet: bool,
) -> None:
    """Draw saved plans in motion and write the file."""
    kind = format_of(output)
    check_format(kind)
    plans = load_plans(paths)
    lines = [Line(plan, label) for label, plan in plans.items()]
    motions = lines if len(lines) > 1 else lines[0].plan
    frames = len(Clock(end_of(lines), speed, frames_per_second).times)
    with count(frames, "frames", Console(stderr=True), quiet=quiet) as report:
        film = animate(
            motions, speed=speed, deflection_scale=deflection_scale, width=width,
            frames_per_second=frames_per_second, format=kind, report=report,
        )  # fmt: skip

    def show(console: Console) -> None:
        size = f"{len(film.content) / 1e3:.0f} kB"
        print_lines(console, f"{film.frames} frames, {film.seconds:.1f} s, {size}")

    finish([(output, film.save)], show)
