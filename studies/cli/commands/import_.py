"""`quietarm import`: coefficients that another program found."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from quietarm.ocp import PointToPoint
from quietarm.studies import figures
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.options import family_option, quiet_option
from quietarm.studies.cli.task import task_options
from quietarm.studies.cli.types import CSV_FILE, INPUT, JSON_FILE, PICTURE, WHOLE
from quietarm.studies.display.progress import working
from quietarm.studies.display.saving import drawing
from quietarm.studies.reading.foreign import read_found
from quietarm.studies.reading.importing import import_front
from quietarm.studies.registry.profiles import FAMILIES
from quietarm.studies.reports.front import searches_document
from rich.console import Console


@click.command("import")
@click.argument("file", type=INPUT)
@task_options
@family_option
@click.option(
    "--terms", type=WHOLE, help="Refuse the file if it has another number of coefficients."
)
@click.option("--bound", type=float, help="Refuse coefficients beyond this box.")
@click.option("--evaluations", type=WHOLE, help="Candidates that it took to find them.")
@click.option("--method", help="What found them; by default the name of the file.")
@click.option("--output", type=JSON_FILE, help="Write the front to this JSON file.")
@click.option("--csv", "csv_file", type=CSV_FILE, help="Write its points to this CSV file.")
@click.option("--figure", type=PICTURE, help="Draw the front (.png, .pdf or .svg).")
@quiet_option
def import_(
    file: Path,
    task: PointToPoint,
    profile: str,
    terms: int | None,
    bound: float | None,
    evaluations: int | None,
    method: str | None,
    output: Path | None,
    csv_file: Path | None,
    figure: Path | None,
    quiet: bool,
) -> None:
    """Evaluate coefficients that any program found, and make a front of them.

    FILE is text with a row for each motion, .npy, .npz or .mat. Its columns are coefficients, a_1,
    a_2, ...; what it claims, in columns residual_m and energy_J, is held against what its
    coefficients give. The front goes to compare, polish and others like any other.

    \b
    Examples:
      quietarm import results.csv single-link --target pi/6 --duration 0.8 --output front.json
      quietarm import found.mat arm-on-flexible-link --target pi/2 --duration 0.8 --bound 0.5 \\
          --method "my swarm" --output front.json --figure front.png
    """  # noqa: D301  # \b is click's: do not rewrap
    found = read_found(file)
    columns = found.coefficients.shape[1]
    if terms is not None:
        size = FAMILIES[profile](terms).size
        if size != columns:
            turned = ", or transpose it" if len(found.coefficients) == size else ""
            raise ValueError(
                f"{file} has {columns} coefficients a motion, and {profile} of {terms} terms takes "
                f"{size}; leave --terms out{turned}"
            )
    settings: dict[str, Any] = {"imported": file.name}
    settings |= {} if bound is None else {"bound": bound}
    name = method or file.stem
    with working("evaluating", Console(stderr=True), quiet=quiet):
        try:
            motions = FAMILIES[profile].of_size(columns)
            front, claims = import_front(task, motions, found, name, settings, evaluations)
        except ValueError as error:
            raise ValueError(f"{file}: {error}") from None

    lines = [claim.words for claim in claims] or [
        "the file states neither residual nor energy in numbers: nothing to hold against"
    ]
    if found.ignored:
        lines.append(f"ignored: {', '.join(found.ignored)[:200]}")
    picture = drawing(lambda: figures.front_figure([front]))
    finish(
        [(output, front.save), (csv_file, front.save_csv), (figure, picture)],
        searches_document([front], lines),
    )
