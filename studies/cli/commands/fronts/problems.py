"""`quietarm problems`: the named problems and their exact fronts."""

from __future__ import annotations

from pathlib import Path

import click
from quietarm.studies.cli.options import FOLDER, Parsed, quiet_option


def _named(text: str) -> str:
    from quietarm.metaheuristics.problems.catalogue import problem_of

    return problem_of(text).name


@click.command()
@click.argument("names", nargs=-1, type=Parsed("problem", _named), metavar="[PROBLEM]...")
@click.option("--again", is_flag=True, help="Find the exact fronts anew; some seconds each.")
@click.option("--output", type=FOLDER, help="Write the exact fronts to this folder.")
@quiet_option
def problems(names: tuple[str, ...], again: bool, output: Path | None, quiet: bool) -> None:
    """List named problems, and write their exact fronts.

    Without PROBLEM all of them. Their fronts come with quietarm; other libraries take the problems
    from Python, as docs/problems.md shows.

    \b
    Examples:
      quietarm problems
      quietarm problems single-link-30deg-0.8s --output fronts
      quietarm problems --again --output fronts
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.studies.runs.problems import run_problems

    run_problems(names, again, output, quiet)
