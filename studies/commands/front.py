"""`quietarm front`: the trade-off of residual and energy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from studies.commands.shared import task_of
from studies.options import OUTPUT, PICTURE, task_options


@click.command(short_help="Search the trade-off of residual and energy.")
@task_options
@click.option(
    "--method", type=click.Choice(["nsga2", "vepso"]), required=True, help="The metaheuristic."
)
@click.option("--terms", type=int, default=6, show_default=True, help="Terms of the polynomial.")
@click.option("--bound", type=float, help="Largest coefficient; required.")
@click.option(
    "--population", type=int, help="Individuals, or particles a swarm; the paper's by default."
)
@click.option("--generations", type=int, help="Generations; the paper's by default.")
@click.option("--seed", type=int, default=0, show_default=True, help="(First) seed.")
@click.option("--runs", type=int, default=1, show_default=True, help="Independent seeds.")
@click.option("--workers", type=int, default=1, show_default=True, help="Processes for the runs.")
@click.option("--checkpoint", type=OUTPUT, help="Write the state here every few seconds.")
@click.option("--resume", type=click.Path(path_type=Path), help="Go on from this checkpoint.")
@click.option(
    "--output", type=OUTPUT,
    help="Write the front to this JSON file; with --runs one for every seed: front.json gives "
    "front-seed0.json, front-seed1.json, ...",
)  # fmt: skip
@click.option(
    "--figure", type=PICTURE, help="Draw the fronts, all in one picture (.png, .pdf or .svg)."
)
@click.option("--quiet", is_flag=True, help="Show no progress.")
def front(output: Path | None, figure: Path | None, quiet: bool, **rest: Any) -> None:
    """Search the trade-off of residual and energy with NSGA-II or VEPSO.

    Ctrl-C ends a search early and keeps what was found.

    \b
    Examples, the paper's settings:
      quietarm front arm-on-flexible-link --target pi/2 --duration 0.8 --bound 0.5 --method nsga2 \\
          --output front.json --figure front.png
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --method vepso \\
          --runs 5 --workers 2 --output front.json --figure fronts.png
    """  # noqa: D301  # \b is click's: do not rewrap
    from studies.searching import run_front

    names = [
        "method", "terms", "bound", "population", "generations", "seed", "runs", "workers",
        "checkpoint", "resume",
    ]  # fmt: skip
    options = {name: rest.pop(name) for name in names}
    for path in run_front(task_of(rest), options, output, figure, quiet):
        click.echo(f"wrote {path}")
