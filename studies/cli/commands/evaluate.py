"""`quietarm evaluate`: the figures of given coefficients."""

from __future__ import annotations

from collections.abc import Callable

import click
from quietarm.ocp import Plan, PointToPoint, evaluate_coefficients
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.files import plan_file_options
from quietarm.studies.cli.options import (
    profile_option,
    quiet_option,
    refuse_idle,
    refuse_typed,
    sensitivities_option,
)
from quietarm.studies.cli.task import robust_option, task_or_path_options
from quietarm.studies.cli.types import COEFFICIENTS
from quietarm.studies.display.progress import working
from quietarm.studies.display.saving import File
from quietarm.studies.reading.path import RecordedPath
from quietarm.studies.registry.profiles import FAMILIES, profile_of
from quietarm.studies.reports.path import evaluated_path
from quietarm.studies.reports.plan import plan_document
from rich.console import Console

_NOT_OF_A_PATH = ("coefficients", "profile", "sensitive", "output", "csv_file", "figure")


@click.command()
@task_or_path_options
@profile_option
@click.option(
    "--coefficients", type=COEFFICIENTS,
    help="a_1 to a_N of the polynomial, or those of another profile in the order of its "
    "documentation, separated by commas, as --coefficients=-0.0019,-0.14.",
)  # fmt: skip
@robust_option
@sensitivities_option
@quiet_option
@plan_file_options
def evaluate(
    task: PointToPoint,
    recorded: RecordedPath | None,
    profile: str,
    coefficients: list[float] | None,
    sensitive: bool,
    quiet: bool,
    files_of: Callable[[Plan], list[File]],
) -> None:
    """Compute residual, energy and peaks of coefficients, of an input shaper, or of a path.

    A --path is followed as a cubic spline through its points, at rest at both ends.

    \b
    Examples; the first has the paper's two terms for the single link:
      quietarm evaluate single-link --target pi/6 --duration 0.8 --coefficients=0.003347,-0.1697
      quietarm evaluate single-link --target pi/6 --duration 0.8 --profile zvd
      quietarm evaluate flexible-beam --set omega=3.2Hz --path recorded.csv
    """  # noqa: D301  # \b is click's: do not rewrap
    if recorded is not None:
        refuse_typed(_NOT_OF_A_PATH, "is not for a --path")
        with working("integrating", Console(stderr=True), quiet=quiet):
            path = evaluated_path(task, recorded)
        finish([], path)
        return
    refuse_idle(profile, {"coefficients": list(FAMILIES)})
    if profile in FAMILIES and coefficients is None:
        raise click.UsageError("Missing option '--coefficients'.")
    numbers = coefficients or []
    family = FAMILIES.get(profile)
    motions = family.of_size(len(numbers)) if family else profile_of(profile, task)
    with working("integrating", Console(stderr=True), quiet=quiet):
        found = evaluate_coefficients(task, numbers, profile=motions)
    finish(files_of(found), plan_document(found, sensitive=sensitive))
