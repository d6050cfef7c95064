"""`quietarm plan`: the still move of least energy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import click
from quietarm.metaheuristics import search
from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL
from quietarm.ocp import (
    JointProfile,
    Plan,
    PointToPoint,
    QuietarmError,
    SolverFailedError,
    SolveSettings,
    evaluate_coefficients,
    fastest_move,
    plan_after,
    plan_move,
)
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.plan.robust import limit_of
from quietarm.ocp.program.solving import Solver
from quietarm.studies.cli.ending import finish, interruption
from quietarm.studies.cli.files import plan_file_options
from quietarm.studies.cli.options import (
    method_settings_option,
    profile_option,
    quiet_option,
    refuse_idle,
    sensitivities_option,
    settings_of_one,
    solver_option,
    terms_option,
)
from quietarm.studies.cli.task import robust_option, task_or_fastest_options
from quietarm.studies.cli.types import RESIDUAL, WHOLE, Named
from quietarm.studies.display.progress import working
from quietarm.studies.display.saving import File
from quietarm.studies.display.search_progress import search_display
from quietarm.studies.registry.methods import METHODS, Kind, Method, methods_of
from quietarm.studies.registry.profiles import FAMILIES, profile_of
from quietarm.studies.reports.plan import plan_document
from rich.console import Console

GRADIENT = "gradient"
OF_FAMILIES = ("terms", "bound", "starts", "seed", "method", "setting", "polish")
"""Options that need a profile with coefficients."""
SEARCHES = [method.name for method in methods_of(Kind.METAHEURISTIC)]


@click.command()
@task_or_fastest_options
@profile_option
@terms_option
@click.option("--bound", type=float, help="Largest coefficient; no bound by default.")
@click.option(
    "--residual-limit", type=RESIDUAL,
    help="Largest tip displacement after arrival; 0, the default, is at rest. With --robust the "
    "default is 5 % of how far the plain cycloid bends the tip on its way.",
)  # fmt: skip
@click.option("--starts", type=WHOLE, default=4, show_default=True, help="Starts of the solver.")
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="Seed of the random starts.")
@solver_option
@click.option(
    "--method", type=Named("method", [GRADIENT, *SEARCHES]), default=GRADIENT, show_default=True,
    help="The gradient, or the cheapest point of a metaheuristic's front within the residual "
    "limit (1mm where that is 0).",
)  # fmt: skip
@method_settings_option("as in --setting crossover=0.7")
@click.option("--polish", is_flag=True, help="Improve a metaheuristic's point by the gradient.")
@robust_option
@sensitivities_option
@quiet_option
@plan_file_options
def plan(
    task: PointToPoint,
    fastest: bool,
    best_after: Path | None,
    profile: str,
    terms: int | None,
    bound: float | None,
    residual_limit: float | None,
    starts: int,
    seed: int,
    solver: Solver,
    method: str,
    setting: tuple[tuple[str, str], ...],
    polish: bool,
    sensitive: bool,
    quiet: bool,
    files_of: Callable[[Plan], list[File]],
) -> None:
    """Find the move of least energy whose residual vibration is within a limit.

    With an input shaper as the profile there is nothing to choose: its motion is evaluated.

    \b
    Examples:
      quietarm plan single-link --target 30deg --duration 0.8
      quietarm plan single-link --target pi/2 --duration 1.0 --bound 0.2 --residual-limit 1mm
      quietarm plan arm-on-flexible-link --target 90deg --duration 800ms --torque-limit 0.3 \\
          --output plan.json --csv move.csv --figure move.png
      quietarm plan single-link --target 30deg --duration 0.8 --profile network --terms 3
      quietarm plan dual-link --target pi/2 --duration 0.9 --profile zv
      quietarm plan single-link --target 30deg --duration fastest --torque-limit 0.15
      quietarm plan single-link --target 0 --duration 0.8 --after earlier.json --wait best
    """  # noqa: D301  # \b is click's: do not rewrap
    refuse_idle(profile, {name: list(FAMILIES) for name in OF_FAMILIES})
    refuse_idle(method, {"starts": [GRADIENT], "solver": [GRADIENT]})
    refuse_idle(method, {"setting": SEARCHES}, "a metaheuristic")
    if method == GRADIENT and polish:
        raise ValueError("--polish is for a metaheuristic's point; give --method nsga2 or another")
    if fastest and (method != GRADIENT or profile not in FAMILIES):
        raise ValueError(
            "--duration fastest is for the gradient and profiles with coefficients; give a time"
        )
    if best_after and (method != GRADIENT or profile not in FAMILIES or fastest):
        raise ValueError(
            "--wait best is for the gradient, profiles with coefficients and a given duration; "
            "give a time"
        )
    motions, notes, complete = profile_of(profile, task, terms), list[str](), True
    if fastest:
        with working("looking for the shortest duration", Console(stderr=True), quiet=quiet):
            shortest = fastest_move(
                task, motions, residual_limit=residual_limit, bound=bound, seed=seed, solver=solver
            )
        found, complete = shortest.plan, shortest.complete
        notes = [f"fastest: in {duration:.5g} s {why}" for duration, why in shortest.failed[:1]]
    elif best_after:
        with working("looking for the best wait", Console(stderr=True), quiet=quiet):
            wait, found = plan_after(
                Plan.load(best_after), task, None, motions, residual_limit=residual_limit,
                bound=bound, starts=starts, seed=seed, solver=solver,
            )  # fmt: skip
        notes = [f"wait: {wait:.4g} s after the arrival of {best_after}"]
    elif method == GRADIENT:
        with working("solving", Console(stderr=True), quiet=quiet):
            found = plan_move(
                task, motions, residual_limit=residual_limit, bound=bound, starts=starts, seed=seed,
                solver=solver,
            )  # fmt: skip
    else:
        found = _by_search(
            task, METHODS[method], motions, bound, residual_limit, seed, polish, quiet,
            settings_of_one(setting),
        )  # fmt: skip

    if method != GRADIENT and not (polish or residual_limit or found.worst):
        notes = [
            "residual limit 0 stands for 1 mm here: no search arrives exactly at rest; --polish "
            "does"
        ]
    complete = complete and found.complete
    stopped = None if complete else interruption(found.provenance.stopped)
    finish(files_of(found), plan_document(found, notes, sensitive), trouble=stopped)


def _by_search(
    task: PointToPoint,
    method: Method,
    profile: JointProfile,
    bound: float | None,
    residual_limit: float | None,
    seed: int,
    polish: bool,
    quiet: bool = False,
    settings: Mapping[str, object] | None = None,
) -> Plan:
    """The cheapest point of a metaheuristic's front within the residual limit, as a plan."""
    limit = limit_of(task, residual_limit) or SEARCH_RESIDUAL
    SolveSettings(residual_limit=limit, seed=seed)  # refused before the search, not after
    with search_display(Console(stderr=True), quiet=quiet) as report:
        front = search(
            task, method.name, profile=profile, bound=bound, settings=settings, seed=seed,
            report=report,
        )  # fmt: skip
    if not front.complete:
        raise QuietarmError(
            "interrupted; a plan needs a whole search, and nothing was written; `quietarm front` "
            "keeps what a search has found until Ctrl-C"
        )
    try:
        point = front.cheapest(limit)
    except ValueError as error:
        raise SolverFailedError(f"{method.label} found no such plan: {error}") from None
    used = {**front.settings, "seed": seed, "residual_limit": limit}
    stopped = None
    if polish:
        try:
            polished = plan_move(
                task, profile, residual_limit=residual_limit, bound=bound, starts=1, seed=seed,
                guess=point.coefficients,
            )  # fmt: skip
        except KeyboardInterrupt:
            stopped = "the search, before its point was polished"
        else:
            provenance = replace(
                polished.provenance,
                method=f"{method.name}, polished by ipopt",
                search=used,
                seconds=front.seconds + polished.provenance.seconds,
            )
            return replace(polished, provenance=provenance)
    with note_interrupts() if stopped else nullcontext():
        found = evaluate_coefficients(
            task, point.coefficients, profile=profile, method=method.name, settings=used
        )
    provenance = replace(found.provenance, seconds=front.seconds, stopped=stopped)
    return replace(found, provenance=provenance)
