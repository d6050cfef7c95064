"""`quietarm front`: the trade-off of residual and energy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from quietarm.studies.cli.arguments import refuse_idle, task_of
from quietarm.studies.cli.options import (
    INPUT,
    NUMBER,
    OUTPUT,
    PICTURE,
    STATE,
    WEIGHTS,
    WHOLE,
    Named,
    family_option,
    method_settings_option,
    quiet_option,
    robust_option,
    settings_of_one,
    solver_option,
    task_options,
    terms_option,
    workers_options,
)
from quietarm.studies.registry.methods import METHODS, WEIGHTED, Kind, methods_of
from quietarm.studies.registry.profiles import profile_of
from quietarm.studies.runs.files import FrontFiles

GRADIENT = [method.name for method in methods_of(Kind.GRADIENT)]
METAHEURISTICS = [method.name for method in methods_of(Kind.METAHEURISTIC)]
_OF_SEARCHES: dict[str, list[str]] = dict.fromkeys(
    (
        "population",
        "generations",
        "setting",
        "runs",
        "workers",
        "scheduler",
        "checkpoint",
        "resume",
    ),
    METAHEURISTICS,
)
_ONLY_FOR = {
    "points": GRADIENT,
    "starts": GRADIENT,
    "solver": GRADIENT,
    "check": GRADIENT,
    "weights": [WEIGHTED.name],
}
"""For every option that not all methods have: the methods that have it."""


@click.command()
@task_options
@click.option(
    "--method", type=Named("method", METHODS), required=True,
    help="epsilon: the gradient, at one residual limit after another; weighted: the gradient, for "
    "one weighted sum after another; all others: a metaheuristic.",
)  # fmt: skip
@family_option
@terms_option
@click.option(
    "--bound", type=NUMBER, help="Largest coefficient; for polynomials a metaheuristic requires it."
)
@click.option(
    "--points", type=WHOLE, default=50, show_default=True,
    help="Gradient: points of the front; epsilon has three more, at 0.1, 1 and 5 mm.",
)  # fmt: skip
@click.option(
    "--starts", type=WHOLE, default=4, show_default=True, help="Gradient: starts of its ends."
)
@solver_option
@click.option(
    "--check", is_flag=True,
    help="Gradient: solve seven points, both ends among them, by the other solver as well, from "
    "the plain cycloid, and say by how much the two differ at most.",
)  # fmt: skip
@click.option(
    "--weights", type=WEIGHTS, multiple=True, metavar="R:E",
    help="weighted: weights of residual and energy, both scaled to the ends of the front, in "
    "place of --points; may be repeated, as in --weights 1:1 --weights 1:3.",
)  # fmt: skip
@click.option(
    "--population", type=WHOLE,
    help="Metaheuristic: individuals, or particles in a swarm; docs/methods.md has the defaults.",
)  # fmt: skip
@click.option("--generations", type=WHOLE, help="Metaheuristic: generations.")
@method_settings_option("as in --setting crossover=0.7")
@click.option(
    "--seed", type=WHOLE, default=0, show_default=True, help="Seed; of several, the first."
)
@click.option(
    "--runs", type=WHOLE, default=1, show_default=True, help="Metaheuristic: number of seeds."
)
@workers_options
@click.option(
    "--checkpoint", type=STATE, help="Metaheuristic: keep the search here, every few seconds."
)
@click.option(
    "--resume",
    type=INPUT,
    help="Metaheuristic: continue from this checkpoint. To save what follows as well, give "
    "--checkpoint, which may name the same file.",
)
@click.option(
    "--output", type=OUTPUT,
    help="Write the front to this JSON file; with --runs one for every seed: front.json gives "
    "front-seed0.json, front-seed1.json, ...",
)  # fmt: skip
@click.option(
    "--csv", "csv_file", type=OUTPUT,
    help="Write the points to this CSV file: residual, energy, coefficients; with --runs as "
    "--output.",
)  # fmt: skip
@click.option(
    "--figure", type=PICTURE, help="Draw the fronts, all in one picture (.png, .pdf or .svg)."
)
@robust_option
@quiet_option
@click.pass_context
def front(
    context: click.Context,
    output: Path | None,
    csv_file: Path | None,
    figure: Path | None,
    quiet: bool,
    **rest: Any,
) -> None:
    """Find the trade-off of residual and energy by the gradient, or with a metaheuristic.

    Ctrl-C ends the work early and keeps what was found.

    \b
    Examples; NSGA-II and VEPSO with the paper's settings:
      quietarm front arm-on-flexible-link --target pi/2 --duration 0.8 --method epsilon \\
          --output epsilon.json --csv epsilon.csv --figure epsilon.png
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --method weighted
      quietarm front arm-on-flexible-link --target pi/2 --duration 0.8 --bound 0.5 --method nsga2 \\
          --output front.json --figure front.png
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --method vepso \\
          --runs 5 --workers 2 --output front.json --figure fronts.png
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --method smsemoa \\
          --population 100 --generations 200 --setting crossover=0.7
    """  # noqa: D301  # \b is click's: do not rewrap
    method = METHODS[rest.pop("method")]
    refuse_idle(context, method.name, _ONLY_FOR)
    refuse_idle(context, method.name, _OF_SEARCHES, "a metaheuristic")
    profile, terms = rest.pop("profile"), rest.pop("terms")
    only_for = {**_ONLY_FOR, **_OF_SEARCHES}
    names = ["bound", "seed"]
    names += [name for name, methods in only_for.items() if method.name in methods]
    options = {name: rest[name] for name in names}
    for name in (*only_for, "bound", "seed"):
        del rest[name]
    task = task_of(rest)
    options["profile"] = profile_of(profile, task, terms)
    if method.kind is Kind.GRADIENT:
        from quietarm.studies.runs.sweeping import run_sweep as run

        if options.get("weights"):
            refuse_idle(context, "--weights", {"points": ("weights that the sweep chooses",)})
    else:
        from quietarm.studies.runs.searching import run_front as run

        options["settings"] = settings_of_one(options.pop("setting"))
    run(task, method, options, FrontFiles(output, csv_file, figure), quiet)
