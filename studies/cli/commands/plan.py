"""`quietarm plan`: the still move of least energy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

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
    plan_move,
)
from quietarm.ocp.planning.plan_move import limit_of
from quietarm.studies.cli.ending import finish
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
from quietarm.studies.registry.methods import METHODS, Kind, methods_of
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
    profile: str,
    terms: int | None,
    method: str,
    setting: tuple[tuple[str, str], ...],
    polish: bool,
    sensitive: bool,
    quiet: bool,
    files_of: Callable[[Plan], list[File]],
    **asked: Any,
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
    motions, notes = profile_of(profile, task, terms), list[str]()
    if method != GRADIENT:
        found = _by_search(task, method, motions, settings_of_one(setting), polish, quiet, **asked)
        if not (polish or asked["residual_limit"] or found.worst):
            notes = [
                "residual limit 0 stands for 1 mm here: no search arrives exactly at rest; "
                "--polish does"
            ]
    elif fastest:
        del asked["starts"]
        with working("looking for the shortest duration", Console(stderr=True), quiet=quiet):
            shortest = fastest_move(task, motions, **asked)
        found = shortest.plan
        notes = [f"fastest: in {duration:.5g} s {why}" for duration, why in shortest.failed[:1]]
    else:
        with working("solving", Console(stderr=True), quiet=quiet):
            found = plan_move(task, motions, **asked)
    finish(files_of(found), plan_document(found, notes, sensitive))


def _by_search(
    task: PointToPoint,
    method: str,
    profile: JointProfile,
    settings: Mapping[str, object],
    polish: bool,
    quiet: bool,
    *,
    residual_limit: float | None,
    **asked: Any,
) -> Plan:
    """The cheapest point of a metaheuristic's front within the residual limit, as a plan."""
    bound, seed = asked["bound"], asked["seed"]
    limit = limit_of(task, residual_limit) or SEARCH_RESIDUAL
    SolveSettings(residual_limit=limit, seed=seed)  # refused before the search, not after
    with search_display(Console(stderr=True), quiet=quiet) as report:
        front = search(
            task, method, profile=profile, bound=bound, settings=settings, seed=seed, report=report
        )
    if not front.complete:
        raise QuietarmError(
            "interrupted; a plan needs a whole search, and nothing was written; `quietarm front` "
            "keeps what a search has found until Ctrl-C"
        )
    try:
        point = front.cheapest(limit)
    except ValueError as error:
        raise SolverFailedError(f"{METHODS[method].label} found no such plan: {error}") from None
    used = {**front.settings, "seed": seed, "residual_limit": limit}
    found = evaluate_coefficients(
        task, point.coefficients, profile=profile, method=method, settings=used
    )
    found = _told(found, seconds=front.seconds)
    if not polish:
        return found
    polished = plan_move(
        task, profile, residual_limit=residual_limit, bound=bound, starts=1, seed=seed,
        guess=point.coefficients,
    )  # fmt: skip
    by, seconds = polished.provenance.method, front.seconds + polished.provenance.seconds
    return _told(polished, method=f"{method}, polished by {by}", search=used, seconds=seconds)


def _told(plan: Plan, **changes: Any) -> Plan:
    """The same plan with another record of how it was found."""
    return replace(plan, provenance=replace(plan.provenance, **changes))
