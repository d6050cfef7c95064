"""`quietarm animate`: plans as a picture that moves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from quietarm.studies.cli.options import command, quiet_option
from quietarm.studies.cli.task import plant_file_option
from quietarm.studies.cli.types import INPUT, SHARE, STATE, WHOLE


@command()
@click.argument("plans", nargs=-1, type=INPUT, metavar="PLAN ...")
@click.option("--output", type=STATE, required=True,
              help="The file: .gif, or .mp4 where ffmpeg is installed.")  # fmt: skip
@click.option("--speed", type=SHARE, default="100%", show_default=True,
              help="Speed of the clock; 25% is slow motion.")  # fmt: skip
@click.option("--deflection-scale", type=float,
              help="Draw deflections so many times larger than they are. [default: the largest "
              "becomes up to a fifth of the structure]")  # fmt: skip
@click.option("--frames-per-second", type=float, default=25.0, show_default=True,
              help="Frames in a second of the animation.")  # fmt: skip
@click.option("--width", type=WHOLE, default=800, show_default=True, help="In pixels.")
@plant_file_option(expose_value=False)
@quiet_option
def animate(plans: tuple[Path, ...], output: Path, quiet: bool, **look: Any) -> None:
    """Draw structures in motion, side by side and on one clock.

    PLANs are files written by `quietarm plan` or `evaluate`, of any plants and durations; one alone
    is drawn beside the plain cycloid of its move. Every link bends as its mode does; the picture
    says how far that is exaggerated. Below are the joint angle, the tips' displacements and the
    power, with a cursor.

    \b
    Examples:
      quietarm animate plan.json --output move.gif
      quietarm animate plan.json zvd.json --speed 25% --output slowly.gif
      quietarm animate plan.json --deflection-scale 5 --width 1200 --output move.gif
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.studies.animation import animate as draw
    from quietarm.studies.animation.formats import format_of
    from quietarm.studies.cli.ending import finish
    from quietarm.studies.display.progress import count
    from quietarm.studies.document.blocks import Document, Lines
    from quietarm.studies.figures import Line
    from quietarm.studies.reading.saved import load_plans
    from rich.console import Console

    kind = format_of(output)
    lines = [Line(plan, label) for label, plan in load_plans(plans).items()]
    motions = lines if len(lines) > 1 else lines[0].plan
    with count(0, "frames", Console(stderr=True), quiet=quiet) as report:
        film = draw(motions, format=kind, report=report, **look)
    size = f"{film.frames} frames, {film.seconds:.1f} s, {len(film.content) / 1e3:.0f} kB"
    finish([(output, film.save)], Document("", [Lines([size])]))
