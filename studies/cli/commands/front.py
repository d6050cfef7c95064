"""`quietarm front`: the trade-off of residual and energy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from quietarm.metaheuristics.ensemble import LostSeedsError, search_many, seeds_of
from quietarm.ocp import Front, PointToPoint, QuietarmError, SolverFailedError, cross_check
from quietarm.ocp.base.files import check_writable
from quietarm.studies.cli.arguments import (
    FrontFiles,
    refuse_idle,
    refuse_same_file,
    task_of,
    warn_of_workers,
)
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
from quietarm.studies.display.progress import count
from quietarm.studies.display.saving import STDOUT, File, drawing, finish, interruption
from quietarm.studies.display.search_progress import search_display
from quietarm.studies.registry.methods import METHODS, WEIGHTED, Kind, Method, methods_of
from quietarm.studies.registry.profiles import profile_of
from quietarm.studies.reports.search import print_fronts
from quietarm.studies.reports.sweep import failure_lines, print_sweep
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
_CHECKED = 7
"""Points that the other solver finds again."""
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
        if options.get("weights"):
            refuse_idle(context, "--weights", {"points": ("weights that the sweep chooses",)})
    else:
        options["settings"] = settings_of_one(options.pop("setting"))
    run = _by_gradient if method.kind is Kind.GRADIENT else _by_search
    run(task, method, options, FrontFiles(output, csv_file, figure), quiet)


def _by_gradient(
    task: PointToPoint,
    method: Method,
    options: dict[str, Any],
    files: FrontFiles,
    quiet: bool,
) -> None:
    """Sweep the front by the gradient, write what was found, and show it."""
    files.refuse_same()
    check = options.pop("check", False)
    weights = options.get("weights", ())
    asked_for = 2 + len(weights) if weights else options["points"]  # the ends come with weights
    front = _swept(task, method, dict(options), quiet)
    asked_for = max(asked_for, len(front.points) + len(front.failures))  # epsilon's own residuals
    if not front.points:
        reasons = (line.strip() for line in failure_lines(front, asked_for)[1:])
        raise SolverFailedError(f"no point was found: {'; '.join(reasons)}")

    found, complete = None, front.complete
    if check and complete:
        try:
            with count(_CHECKED, "checked points", Console(stderr=True), quiet=quiet) as report:
                found = cross_check(front, _CHECKED, report)
        except KeyboardInterrupt:  # the front is there
            complete = False

    def picture() -> Figure:
        from quietarm.studies.figures import sweep_figure

        return sweep_figure(front)

    finish(
        files.written(front, picture),
        lambda console: print_sweep(console, front, asked_for, found),
        trouble=None if complete else interruption(),
    )


def _swept(task: PointToPoint, method: Method, options: dict[str, Any], quiet: bool) -> Front:
    errors = Console(stderr=True)
    weights = options.pop("weights", ())
    if weights:
        options["weights"] = weights
    total = len(weights) or options["points"]
    with count(total, "weights" if weights else "points", errors, quiet=quiet) as report:
        return method.sweep(task, report=report, **options)


def _by_search(
    task: PointToPoint,
    method: Method,
    options: dict[str, Any],
    files: FrontFiles,
    quiet: bool,
) -> None:
    """Search from every seed, write what was found, and show it."""
    runs = options["runs"]
    if runs > 1 and (options.get("checkpoint") or options.get("resume")):
        raise ValueError(
            "--checkpoint and --resume are for one run, not with --runs; leave one of them out"
        )
    seeds = seeds_of(options["seed"], runs)
    targets = _targets("--output", files.output, seeds)
    tables = _targets("--csv", files.csv, seeds)
    _refuse_same_files([*targets.values()], [*tables.values()], options, files.figure)
    errors = Console(stderr=True)
    found, lost, troubles = _fronts(errors, task, method, options, quiet)
    fronts = [front for front in found if front.complete or front.points]
    stopped = "" if lost else _interruption(fronts, runs)
    if not any(front.points for front in fronts):
        if stopped:
            raise KeyboardInterrupt
        raise lost or SolverFailedError(f"{method.name}: {fronts[0].why_empty()}")

    def picture() -> Figure:
        from quietarm.studies.figures import front_figure

        return front_figure(fronts)

    trouble = lost
    if stopped or troubles:
        trouble = lost or QuietarmError("; ".join([*filter(None, [stopped]), *troubles]))
    written: list[File] = [(targets.get(front.seed or 0), front.save) for front in fronts]
    written += [(tables.get(front.seed or 0), front.save_csv) for front in fronts]
    finish(
        [*written, (files.figure, drawing(picture))],
        lambda console: print_fronts(console, fronts),
        trouble=trouble,
    )


def _fronts(
    errors: Console, task: PointToPoint, method: Method, options: Mapping[str, Any], quiet: bool
) -> tuple[list[Front], LostSeedsError | None, list[str]]:
    """What every seed found, the error of those whose process died, and warnings."""
    runs, troubles = options["runs"], list[str]()
    warn_of_workers(errors, options["workers"], runs)
    with search_display(errors, quiet=quiet) as display:
        several = {"report": display, "done": display.finish}
        one = {"report": lambda progress, seed: display(progress), "warn": troubles.append}
        try:
            how = several if runs > 1 else one
            return search_many(task, method.name, **how, **options), None, troubles
        except LostSeedsError as error:
            return error.fronts, error, troubles


def _interruption(fronts: Sequence[Front], runs: int) -> str:
    """The message for searches that were interrupted; empty where none was."""
    done = sum(front.complete for front in fronts)
    if done == runs:
        return ""
    if runs == 1:
        return "interrupted; what was found until then is kept"
    part = f", {len(fronts) - done} in part" * (done < len(fronts))
    return f"interrupted: {done} of {runs} seeds are done{part}; these are kept"


def _with_seed(path: Path, seed: int) -> Path:
    """The file for one of several seeds: front.json is front-seed3.json for seed 3."""
    return path.with_stem(f"{path.stem}-seed{seed}")


def _refuse_same_files(
    outputs: Sequence[Path],
    tables: Sequence[Path],
    options: Mapping[str, Any],
    figure: Path | None,
) -> None:
    written: list[tuple[str, Path | None]] = [("--output", path) for path in outputs]
    written += [*(("--csv", path) for path in tables), ("--figure", figure)]
    refuse_same_file([*written, ("--checkpoint", options.get("checkpoint"))])
    # a checkpoint may be continued in the same file, but not overwritten by a front
    refuse_same_file([*written, ("--resume", options.get("resume"))])


def _targets(option: str, output: Path | None, seeds: range) -> dict[int, Path]:
    if output is None:
        return {}
    if len(seeds) == 1:
        return {seeds[0]: output}
    if output is STDOUT:
        raise ValueError(f"{option} {output} is for one run; with --runs give the name of a file")
    return {seed: check_writable(_with_seed(output, seed)) for seed in seeds}
