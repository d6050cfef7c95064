"""`quietarm evaluate`: the figures of given coefficients."""

from __future__ import annotations

from functools import partial
from typing import Any

import click
from rich.console import Console

from ocp import evaluate_coefficients
from studies.cli.arguments import plan_files, split_options
from studies.cli.options import COEFFICIENTS, output_options, quiet_option, task_options
from studies.display.progress import working
from studies.display.saving import finish
from studies.reports.plan import print_plan


@click.command()
@task_options
@click.option(
    "--coefficients", type=COEFFICIENTS, required=True,
    help="a_1 to a_N, separated by commas, as --coefficients=-0.0019,-0.14.",
)  # fmt: skip
@quiet_option
@output_options
def evaluate(coefficients: list[float], quiet: bool, **rest: Any) -> None:
    """Compute residual, energy and peaks of given coefficients.

    \b
    Example, the paper's two terms for the single link:
      quietarm evaluate single-link --target pi/6 --duration 0.8 --coefficients=0.003347,-0.1697
    """  # noqa: D301  # \b is click's: do not rewrap
    task, outputs = split_options(rest)
    with working("integrating", Console(stderr=True), quiet=quiet):
        found = evaluate_coefficients(task, coefficients)
    finish(plan_files(found, **outputs), partial(print_plan, plan=found))
