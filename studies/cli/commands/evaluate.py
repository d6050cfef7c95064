"""`quietarm evaluate`: the figures of coefficients, of a path, or of a table of results."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click
from quietarm.ocp import PointToPoint, evaluate_coefficients
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies import figures
from quietarm.studies.cli.commands.plan import plan_files, shown_plan
from quietarm.studies.cli.files import PICTURE, finish, front_files, output_option
from quietarm.studies.cli.options import (
    bound_option,
    busy,
    command,
    option,
    profile_options,
    refuse_typed,
    sensitivities_option,
)
from quietarm.studies.cli.quantities import parse_coefficients
from quietarm.studies.cli.task import TypedMove, task_options
from quietarm.studies.cli.types import INPUT, Parsed
from quietarm.studies.reading.table import TABLES
from quietarm.studies.registry.profiles import FAMILIES, profile_of
from quietarm.studies.report.fronts import search_lines
from quietarm.studies.report.moves import path_rows

_OF_TABLES = ("bound", "evaluations")
_NOT_OF_PATHS = ("coefficients", "profile", "terms", "sensitivities", "output", *_OF_TABLES)


def _coefficients(text: str) -> list[float] | Path:
    return Path(text) if Path(text).suffix.lower() in TABLES else parse_coefficients(text)


@command()
@task_options
@profile_options(*SHAPERS, words="; or the plain cycloid through an input shaper")
@option(
    "--coefficients", type=Parsed("numbers", _coefficients), metavar="NUMBERS|FILE",
    help="Those of the profile, as --coefficients=-0.0019,-0.14; or a file with a row a motion "
    "(.csv, .txt, .npy, .npz, .mat), which gives a front.",
)  # fmt: skip
@option("--path", type=INPUT, help="A CSV file with columns such as time_s and angle_deg, in place "
        "of start, target and duration.")  # fmt: skip
@bound_option
@option("--evaluations", type=int, help="Candidates that it took to find a file's rows.")
@sensitivities_option
@output_option({
    ".json": "the plan or front", ".csv": "the path at 1 kHz or the front", PICTURE: "a picture",
})  # fmt: skip
def evaluate(
    move: TypedMove,
    profile: str,
    terms: int | None,
    coefficients: Sequence[float] | Path | None,
    path: Path | None,
    sensitivities: bool,
    output: Sequence[Path],
    **of_table: Any,
) -> None:
    """Compute residual, energy and peaks of coefficients, an input shaper, a path or a table.

    A --path is followed as a cubic spline through its points, at rest at both ends. The columns of
    a table are a_1, a_2, ...; what it states in columns residual_m and energy_J is compared with
    what its coefficients give.

    \b
    Examples; the first has the paper's two terms for the single link:
      quietarm evaluate single-link --target pi/6 --duration 0.8 --coefficients=0.003347,-0.1697
      quietarm evaluate single-link --target pi/6 --duration 0.8 --profile zvd
      quietarm evaluate flexible-beam --set omega=3.2Hz --path recorded.csv
      quietarm evaluate single-link --target pi/6 --duration 0.8 --coefficients results.csv \\
          --output front.json --output front.png
    """  # noqa: D301  # \b is click's: do not rewrap
    if path is not None:
        refuse_typed(_NOT_OF_PATHS, "is not for a --path; leave it out")
        return _evaluate_path(move, path)
    task = move.task()
    if isinstance(coefficients, Path):
        refuse_typed(["sensitivities"], "is not for a table; leave it out")
        return _evaluate_table(task, coefficients, profile, terms, output, **of_table)
    refuse_typed(_OF_TABLES, "is for a table of results; leave it out")
    if profile in SHAPERS:
        refuse_typed(["coefficients", "terms"], f"is not for {profile}; leave it out")
        motions = profile_of(profile, task)
    elif coefficients is None:
        raise click.UsageError("Missing option '--coefficients'.")
    else:
        motions = FAMILIES[profile].of_size(len(coefficients))
    with busy("integrating"):
        found = evaluate_coefficients(task, coefficients or [], profile=motions)
    return finish(plan_files(output, found), *shown_plan(found, sensitivities))


def _evaluate_path(move: TypedMove, path: Path) -> None:
    from quietarm.studies.reading.path import read_path

    refuse_typed(["start", "target", "duration"], "is in the file of --path; leave it out")
    recorded = read_path(path, move.plant().joint)
    task = move.task(start=recorded.start, target=recorded.target, duration=recorded.duration)
    with busy("integrating"):
        rows = path_rows(task, recorded)
    finish([], rows)


def _evaluate_table(
    task: PointToPoint,
    file: Path,
    profile: str,
    terms: int | None,
    output: Sequence[Path],
    bound: float | None,
    evaluations: int | None,
) -> None:
    """A front of coefficients that another program found, beside what it states of them."""
    from quietarm.studies.reading.foreign import read_found
    from quietarm.studies.reading.importing import import_front

    if profile in SHAPERS:
        raise ValueError(f"{profile} has no coefficients; give one of {', '.join(FAMILIES)}")
    found = read_found(file)
    columns = found.coefficients.shape[1]
    if terms is not None and FAMILIES[profile](terms).size != columns:
        raise ValueError(
            f"{file} has {columns} coefficients a motion, and {profile} of {terms} terms takes "
            f"{FAMILIES[profile](terms).size}; leave --terms out, or transpose the table"
        )
    with busy("evaluating"):
        try:
            motions = FAMILIES[profile].of_size(columns)
            front, claims = import_front(
                task, motions, found, file.stem, {"imported": file.name}, bound, evaluations
            )
        except ValueError as error:
            raise ValueError(f"{file}: {error}") from None
    notes = [claim.words for claim in claims] or [
        "the file states neither residual nor energy in numbers: nothing to compare with"
    ]
    if found.ignored:
        notes.append(f"ignored: {', '.join(found.ignored)[:200]}")
    draw = partial(figures.front_figure, [front])
    finish(front_files(output, front, draw), search_lines([front], notes))
