"""`quietarm front`: the trade-off of residual and energy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click
from quietarm.metaheuristics.ensemble import LostSeedsError, search_many, seeds_of
from quietarm.ocp import Front, PointToPoint, QuietarmError, SolverFailedError, cross_check
from quietarm.studies import figures
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.options import (
    family_option,
    method_settings_option,
    options,
    quiet_option,
    refuse_idle,
    settings_of_one,
    solver_option,
    terms_option,
    typed,
    warn_of_workers,
    workers_options,
)
from quietarm.studies.cli.task import robust_option, task_options
from quietarm.studies.cli.types import (
    CSV_FILE,
    INPUT,
    JSON_FILE,
    PICTURE,
    STATE,
    WEIGHTS,
    WHOLE,
    Named,
)
from quietarm.studies.display.progress import count
from quietarm.studies.display.saving import STDOUT, drawing
from quietarm.studies.display.search_progress import search_display
from quietarm.studies.document.blocks import Document
from quietarm.studies.registry.methods import METHODS, WEIGHTED, Kind, methods_of
from quietarm.studies.registry.profiles import profile_of
from quietarm.studies.reports.front import failure_lines, searches_document, sweep_document
from rich.console import Console

GRADIENT = [method.name for method in methods_of(Kind.GRADIENT)]
METAHEURISTICS = [method.name for method in methods_of(Kind.METAHEURISTIC)]
OF_GRADIENT = ("points", "starts", "solver", "check")
OF_SEARCHES = (
    "population", "generations", "setting", "runs", "workers", "scheduler", "checkpoint", "resume",
)  # fmt: skip
_CHECKED = 7
"""Points that the other solver finds again."""

_gradient_options = options(
    click.option(
        "--points", type=WHOLE, default=50, show_default=True,
        help="Gradient: points of the front; epsilon has three more, at 0.1, 1 and 5 mm.",
    ),
    click.option(
        "--starts", type=WHOLE, default=4, show_default=True, help="Gradient: starts of its ends."
    ),
    solver_option,
    click.option(
        "--check", is_flag=True,
        help="Gradient: solve seven points, both ends among them, by the other solver as well, "
        "from the plain cycloid, and say by how much the two differ at most.",
    ),
    click.option(
        "--weights", type=WEIGHTS, multiple=True, metavar="R:E",
        help="weighted: weights of residual and energy, both scaled to the ends of the front, in "
        "place of --points; may be repeated, as in --weights 1:1 --weights 1:3.",
    ),
)  # fmt: skip
_search_options = options(
    click.option(
        "--population", type=WHOLE,
        help="Metaheuristic: individuals, or particles in a swarm; docs/methods.md has the "
        "defaults.",
    ),
    click.option("--generations", type=WHOLE, help="Metaheuristic: generations."),
    method_settings_option("as in --setting crossover=0.7"),
    click.option(
        "--seed", type=WHOLE, default=0, show_default=True, help="Seed; of several, the first."
    ),
    click.option(
        "--runs", type=WHOLE, default=1, show_default=True, help="Metaheuristic: number of seeds."
    ),
    workers_options,
    click.option(
        "--checkpoint", type=STATE, help="Metaheuristic: keep the search here, every few seconds."
    ),
    click.option(
        "--resume", type=INPUT,
        help="Metaheuristic: continue from this checkpoint. To save what follows as well, give "
        "--checkpoint, which may name the same file.",
    ),
)  # fmt: skip


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
    "--bound", type=float, help="Largest coefficient; for polynomials a metaheuristic requires it."
)
@_gradient_options
@_search_options
@click.option(
    "--output", type=JSON_FILE,
    help="Write the front to this JSON file; with --runs one for every seed: front.json gives "
    "front-seed0.json, front-seed1.json, ...",
)  # fmt: skip
@click.option(
    "--csv", "csv_file", type=CSV_FILE,
    help="Write the points to this CSV file: residual, energy, coefficients; with --runs as "
    "--output.",
)  # fmt: skip
@click.option(
    "--figure", type=PICTURE, help="Draw the fronts, all in one picture (.png, .pdf or .svg)."
)
@robust_option
@quiet_option
def front(
    task: PointToPoint,
    method: str,
    profile: str,
    terms: int | None,
    output: Path | None,
    csv_file: Path | None,
    figure: Path | None,
    quiet: bool,
    **settings: Any,
) -> None:
    """Find the trade-off of residual and energy by the gradient, or with a metaheuristic.

    Ctrl-C ends the work early; a search keeps what it has found until then.

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
    refuse_idle(method, {"weights": [WEIGHTED.name], **dict.fromkeys(OF_GRADIENT, GRADIENT)})
    refuse_idle(method, dict.fromkeys(OF_SEARCHES, METAHEURISTICS), "a metaheuristic")
    several = len(seeds_of(settings["seed"], settings["runs"])) > 1
    for option, path in {"--output": output, "--csv": csv_file}.items():
        if several and path is STDOUT:
            raise ValueError(f"{option} - is for one run; with --runs give the name of a file")
    idle = OF_SEARCHES if method in GRADIENT else (*OF_GRADIENT, "weights")
    settings = {name: value for name, value in settings.items() if name not in idle}
    settings["profile"] = profile_of(profile, task, terms)
    find = _by_gradient if method in GRADIENT else _by_search
    fronts, draw, document, trouble = find(task, method, quiet, **settings)

    def path_of(path: Path | None, front: Front) -> Path | None:
        """With several seeds front.json is front-seed3.json for seed 3."""
        return path.with_stem(f"{path.stem}-seed{front.seed}") if path and several else path

    finish(
        [
            *((path_of(output, front), front.save) for front in fronts),
            *((path_of(csv_file, front), front.save_csv) for front in fronts),
            (figure, drawing(draw)),
        ],
        document,
        trouble=trouble,
    )


Found = tuple[list[Front], Callable[[], Any], Document, Exception | None]
"""Fronts, what draws and what shows them, and what went wrong."""


def _by_gradient(
    task: PointToPoint,
    method: str,
    quiet: bool,
    *,
    check: bool,
    weights: Sequence[tuple[float, float]],
    points: int,
    **settings: Any,
) -> Found:
    """Sweep the front by the gradient."""
    if weights and typed("points"):
        raise ValueError("--points is for weights that the sweep chooses; leave it out")
    errors, asked = Console(stderr=True), {"weights": weights} if weights else {"points": points}
    total, what = (len(weights), "weights") if weights else (points, "points")
    with count(total, what, errors, quiet=quiet) as report:
        front = METHODS[method].sweep(task, report=report, **asked, **settings)
    # the ends come with weights, and epsilon has residuals of its own
    asked_for = max(total + 2 * bool(weights), len(front.points) + len(front.failures))
    if not front.points:
        reasons = (line.strip() for line in failure_lines(front, asked_for)[1:])
        raise SolverFailedError(f"no point was found: {'; '.join(reasons)}")
    checked = None
    if check:
        with count(_CHECKED, "checked points", errors, quiet=quiet) as report:
            checked = cross_check(front, _CHECKED, report)
    document = sweep_document(front, asked_for, checked)
    return [front], lambda: figures.sweep_figure(front), document, None


def _by_search(
    task: PointToPoint,
    method: str,
    quiet: bool,
    *,
    runs: int,
    setting: Sequence[tuple[str, str]],
    **settings: Any,
) -> Found:
    """Search from every seed."""
    if runs > 1 and (settings["checkpoint"] or settings["resume"]):
        raise ValueError(
            "--checkpoint and --resume are for one run, not with --runs; leave one of them out"
        )
    errors, lost, warnings = Console(stderr=True), None, list[str]()
    warn_of_workers(errors, settings["workers"], runs)
    settings["settings"] = settings_of_one(setting)
    with search_display(errors, quiet=quiet) as display:
        report: dict[str, Callable[..., object]] = {
            "report": lambda progress, seed: display(progress), "warn": warnings.append,
        }  # fmt: skip
        if runs > 1:
            report = {"report": display, "done": display.finish}
        try:
            fronts = search_many(task, method, runs, **report, **settings)
        except LostSeedsError as error:
            fronts, lost = error.fronts, error
    fronts = [front for front in fronts if front.complete or front.points]
    stopped = "" if lost else _interruption(fronts, runs)
    if not any(front.points for front in fronts):
        if stopped:
            raise KeyboardInterrupt
        raise lost or SolverFailedError(f"{method}: {fronts[0].why_empty()}")
    words = "; ".join(filter(None, [stopped, *warnings]))
    trouble = lost or (QuietarmError(words) if words else None)
    return fronts, lambda: figures.front_figure(fronts), searches_document(fronts), trouble


def _interruption(fronts: Sequence[Front], runs: int) -> str:
    """The message for searches that were interrupted; empty where none was."""
    done = sum(front.complete for front in fronts)
    if done == runs:
        return ""
    if runs == 1:
        return "interrupted; what was found until then is kept"
    part = f", {len(fronts) - done} in part" * (done < len(fronts))
    return f"interrupted: {done} of {runs} seeds are done{part}; these are kept"
