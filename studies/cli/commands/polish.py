"""`quietarm polish`: a front improved by the gradient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
from quietarm.ocp import Front, Gain, polish_front
from quietarm.ocp.checks import whole
from quietarm.studies import figures
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.options import quiet_option
from quietarm.studies.cli.task import plant_file_option
from quietarm.studies.cli.types import CSV_FILE, INPUT, JSON_FILE, PICTURE, WHOLE
from quietarm.studies.display.progress import count, working
from quietarm.studies.display.saving import drawing
from quietarm.studies.display.words import counted, millimetres
from quietarm.studies.document.blocks import Document, Lines
from quietarm.studies.document.table import Column, Table
from quietarm.studies.reading.saved import load_front
from quietarm.studies.reports.front import failure_lines
from rich.console import Console

_ROWS = 10
"""Points that the table on screen shows."""


@click.command()
@click.argument("front", type=INPUT, metavar="FRONT")
@click.option(
    "--points", type=WHOLE,
    help="Only this many points, spread evenly along the front; all of them by default, which "
    "takes about 50 ms each.",
)  # fmt: skip
@click.option("--output", type=JSON_FILE, help="Write the improved front to this JSON file.")
@click.option("--csv", "csv_file", type=CSV_FILE, help="Write every point's gain to this CSV file.")
@click.option(
    "--figure", type=PICTURE, help="Draw the front before and after (.png, .pdf or .svg)."
)
@plant_file_option(expose_value=False)
@quiet_option
def polish(
    front: Path,
    points: int | None,
    output: Path | None,
    csv_file: Path | None,
    figure: Path | None,
    quiet: bool,
) -> None:
    """Improve the points of a front that was written by `quietarm front`.

    From each point the gradient looks for a cheaper motion of no larger residual. What a
    metaheuristic's front gains shows how far it was from the optimum.

    \b
    Examples:
      quietarm polish front.json
      quietarm polish front.json --points 50 --output polished.json --figure polished.png
    """  # noqa: D301  # \b is click's: do not rewrap
    errors = Console(stderr=True)
    with working("checking", errors, quiet=quiet):
        whole_front = load_front(front)
    given = whole_front if points is None else thinned(whole_front, points)
    with count(len(given.points), "points", errors, quiet=quiet) as report:
        polished = polish_front(given, report=report)
    gains = list(polished.gains)
    finish(
        [
            (output, polished.front.save),
            (csv_file, gains_table(gains).save_csv),
            (figure, drawing(lambda: figures.polish_figure(given, polished))),
        ],
        _gains_document(whole_front, given, polished.front, gains),
    )


def thinned(front: Front, points: int) -> Front:
    """A front of fewer points, evenly spaced along it, its ends among them."""
    points = whole("points", points, 2)
    return replace(front, points=_spread(front.points, points))


def _spread(items: Sequence, number: int) -> tuple:
    """At most this many of the items, evenly spaced, with the first and the last."""
    places = np.linspace(0, len(items) - 1, min(number, len(items))).round().astype(int)
    return tuple(items[i] for i in places)


def gains_table(gains: Sequence[Gain]) -> Table:
    """For each point: residual, energy before and after, and the share that was saved."""
    columns = [
        Column("residual [m]", key="residual_m"),
        Column("before [J]", key="before_J"),
        Column("after [J]", key="after_J"),
        Column("saved", "{:.2%}".format, key="saved_share"),
    ]
    rows = [[gain.residual, gain.before, gain.after, gain.share] for gain in gains]
    return Table("what each point gained", columns, rows)


def _gains_document(
    whole_front: Front, front: Front, polished: Front, gains: Sequence[Gain]
) -> Document:
    number, of = len(front.points), len(whole_front.points)
    points = (
        f"{number} of its {of} points, spread along it" if number < of else counted(of, "point")
    )
    state = "" if len(gains) == number else f" (interrupted after {len(gains)} of them)"
    shares = np.array([gain.share for gain in gains])
    lines = [
        f"{polished.method}: {points}, {polished.iterations - front.iterations} iterations of "
        f"the solver in {polished.seconds - front.seconds:.1f} s{state}",
        f"{'residual':>12}{'before':>12}{'after':>12}{'saved':>9}",
        *(_row(gain) for gain in _spread(gains, _ROWS)),
        f"saved: median {np.median(shares):.2%}, least {shares.min():.2%}, most {shares.max():.2%}",
    ]
    beaten = number - len(polished.points)
    if beaten:
        some = "1 point is" if beaten == 1 else f"{beaten} points are"
        lines.append(f"{some} dominated by another now, and left out")
    return Document("", [Lines([*lines, *failure_lines(polished, number)])])


def _row(gain: Gain) -> str:
    return (
        f"{millimetres(gain.residual):>12}{f'{gain.before:.4g} J':>12}{f'{gain.after:.4g} J':>12}"
        f"{f'{gain.share:.2%}':>9}"
    )
