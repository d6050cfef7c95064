"""`quietarm evaluate`: the figures of coefficients, of a path, or of a table of results."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
from quietarm.ocp import evaluate_coefficients
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies import figures
from quietarm.studies.cli.commands.plan import plan_files
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.files import PICTURE, files_of, output_option
from quietarm.studies.cli.options import (
    bound_option,
    command,
    profile_options,
    quiet,
    refuse_typed,
    sensitivities_option,
)
from quietarm.studies.cli.task import TypedMove, task_options
from quietarm.studies.cli.types import COEFFICIENTS, INPUT, WHOLE
from quietarm.studies.registry.profiles import FAMILIES, profile_of
from quietarm.studies.report.fronts import search_lines
from quietarm.studies.report.moves import path_rows, plan_rows, sensitivity_rows
from quietarm.studies.report.progress import working
from quietarm.studies.report.saving import drawing
from rich.console import Console

_OF_TABLES = ("bound", "evaluations")
_NOT_OF_PATHS = ("coefficients", "profile", "terms", "sensitivities", "output", *_OF_TABLES)


@command()
@task_options
@profile_options(*SHAPERS, words="; or the plain cycloid through an input shaper")
@click.option(
    "--coefficients", type=COEFFICIENTS, metavar="NUMBERS|FILE",
    help="Those of the profile with commas between, as --coefficients=-0.0019,-0.14; or a file "
    "with a row a motion (.csv, .txt, .npy, .npz, .mat), which gives a front.",
)  # fmt: skip
@click.option(
    "--path", type=INPUT,
    help="A CSV file with the joint's path in columns such as time_s and angle_deg, in place of "
    "start, target and duration.",
)  # fmt: skip
@bound_option
@click.option("--evaluations", type=WHOLE, help="Candidates that it took to find a file's rows.")
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
    bound: float | None,
    evaluations: int | None,
    sensitivities: bool,
    output: Sequence[Path],
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
        _evaluate_path(move, path)
        return
    task = move.task()
    if isinstance(coefficients, Path):
        refuse_typed(["sensitivities"], "is not for a table; leave it out")
        _evaluate_table(move, coefficients, profile, terms, bound, evaluations, output)
        return
    refuse_typed(_OF_TABLES, "is for a table of results; leave it out")
    if profile in SHAPERS:
        refuse_typed(["coefficients", "terms"], f"is not for {profile}; leave it out")
        motions = profile_of(profile, task)
    elif coefficients is None:
        raise click.UsageError("Missing option '--coefficients'.")
    else:
        motions = FAMILIES[profile].of_size(len(coefficients))
    with working("integrating", Console(stderr=True), quiet=quiet()):
        found = evaluate_coefficients(task, coefficients or [], profile=motions)
    sensitive = sensitivity_rows(found) if sensitivities else []
    title = "\nwhat a parameter that is 1 % larger adds to residual and energy:" * bool(sensitive)
    finish(plan_files(output, found), plan_rows(found), title, sensitive)


def _evaluate_path(move: TypedMove, path: Path) -> None:
    from quietarm.studies.reading.path import read_path

    move.refuse("is in the file of --path; leave it out", "start", "target", "duration")
    recorded = read_path(path)
    task = move.task(start=recorded.start, target=recorded.target, duration=recorded.duration)
    with working("integrating", Console(stderr=True), quiet=quiet()):
        rows = path_rows(task, recorded)
    finish([], rows)


def _evaluate_table(
    move: TypedMove,
    file: Path,
    profile: str,
    terms: int | None,
    bound: float | None,
    evaluations: int | None,
    output: Sequence[Path],
) -> None:
    """A front of coefficients that another program found, beside what it states of them."""
    from quietarm.studies.reading.foreign import read_found
    from quietarm.studies.reading.importing import import_front

    if profile in SHAPERS:
        raise ValueError(f"{profile} has no coefficients; give one of {', '.join(FAMILIES)}")
    task, found = move.task(), read_found(file)
    columns = found.coefficients.shape[1]
    if terms is not None and FAMILIES[profile](terms).size != columns:
        raise ValueError(
            f"{file} has {columns} coefficients a motion, and {profile} of {terms} terms takes "
            f"{FAMILIES[profile](terms).size}; leave --terms out, or transpose the table"
        )
    settings: dict[str, Any] = {
        "imported": file.name,
        **({} if bound is None else {"bound": bound}),
    }
    with working("evaluating", Console(stderr=True), quiet=quiet()):
        try:
            motions = FAMILIES[profile].of_size(columns)
            front, claims = import_front(task, motions, found, file.stem, settings, evaluations)
        except ValueError as error:
            raise ValueError(f"{file}: {error}") from None
    notes = [claim.words for claim in claims] or [
        "the file states neither residual nor energy in numbers: nothing to compare with"
    ]
    if found.ignored:
        notes.append(f"ignored: {', '.join(found.ignored)[:200]}")
    picture = drawing(lambda: figures.front_figure([front]))
    writes = {".json": front.save, ".csv": front.save_csv, PICTURE: picture}
    finish(files_of(output, writes), search_lines([front], notes))
