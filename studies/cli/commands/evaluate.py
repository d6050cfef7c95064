"""`quietarm evaluate`: the figures of given coefficients."""

from __future__ import annotations

from typing import Any

import click
from rich.console import Console

from ocp import evaluate_coefficients
from studies.cli.arguments import split_options, write_plan
from studies.cli.options import COEFFICIENTS, output_options, task_options
from studies.reports.plan import print_plan


@click.command()
@task_options
@click.option(
    "--coefficients", type=COEFFICIENTS, required=True,
    help="a_1 to a_N, separated by commas, as --coefficients=-0.0019,-0.14.",
)  # fmt: skip
@output_options
def evaluate(coefficients: list[float], **rest: Any) -> None:
    """Compute residual, energy and peaks of given coefficients.

    \b
    Example, the paper's two terms for the single link:
      quietarm evaluate single-link --target pi/6 --duration 0.8 --coefficients=0.003347,-0.1697
    """  # noqa: D301  # \b is click's: do not rewrap
    task, outputs = split_options(rest)
    found = evaluate_coefficients(task, coefficients)
    print_plan(Console(), found)
    write_plan(found, **outputs)
