"""`quietarm front`: the trade-off of residual and energy by the gradient."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from quietarm.ocp import SolverFailedError, cross_check, polish_front
from quietarm.studies import figures
from quietarm.studies.cli.files import PICTURE, finish, front_files, output_option
from quietarm.studies.cli.options import (
    bound_option,
    busy,
    command,
    counting,
    option,
    profile_options,
    refuse_typed,
    seed_option,
    solver_option,
    starts_option,
)
from quietarm.studies.cli.quantities import parse_weights
from quietarm.studies.cli.task import NAMES, TypedMove, task_options
from quietarm.studies.cli.types import INPUT, Named, Parsed
from quietarm.studies.reading.saved import load_front
from quietarm.studies.registry.methods import EPSILON, METHODS, WEIGHTED, Kind, methods_of
from quietarm.studies.registry.profiles import profile_of
from quietarm.studies.report.fronts import failure_lines, gradient_lines, polish_lines

_GRADIENT = [method.name for method in methods_of(Kind.GRADIENT)]
_SEARCHES = {
    method.name: f"{method.name} is a metaheuristic; give quietarm search --method {method.name}"
    for method in methods_of(Kind.METAHEURISTIC)
}
_CHECKED = 7
"""Points that the other solver finds again."""
_OF_CURVES = (
    "method", "profile", "terms", "bound", "points", "weights", "starts", "seed", "solver", "check",
)  # fmt: skip


@command()
@task_options
@option(
    "--method", type=Named("method", _GRADIENT, _SEARCHES), default=EPSILON.name,
    help="Least energy at one residual limit after another (epsilon), or the least weighted sum "
    "for one pair of weights after another (weighted).",
)  # fmt: skip
@profile_options()
@bound_option
@option("--points", default=50, help="Points of the front; epsilon has 0.1, 1 and 5 mm besides.")
@option(
    "--weights", type=Parsed("weights", parse_weights), multiple=True, metavar="R:E",
    help="weighted: weights of residual and energy, scaled to the ends of the front, in place of "
    "--points; may be repeated, as --weights 1:1 --weights 1:3.",
)  # fmt: skip
@starts_option
@seed_option
@solver_option
@option("--check", is_flag=True, help="Solve seven points by the other solver as well, from the "
        "plain cycloid, and say by how much the two differ.")  # fmt: skip
@option("--polish", type=INPUT, metavar="FILE", help="Improve the points of this front, by any "
        "method: from each to less energy and no larger residual.")  # fmt: skip
@output_option({".json": "the front", ".csv": "its points", PICTURE: "a picture"})
def front(
    move: TypedMove,
    method: str,
    profile: str,
    terms: int | None,
    points: int,
    weights: Sequence[tuple[float, float]],
    check: bool,
    polish: Path | None,
    output: Sequence[Path],
    **settings: Any,
) -> None:
    """Find the trade-off of residual and energy by the gradient.

    \b
    Examples:
      quietarm front arm-on-flexible-link --target pi/2 --duration 0.8 --output front.json \\
          --output front.csv --output front.png
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --method weighted
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --check
      quietarm front --polish nsga2.json --output polished.json --output polished.png
    """  # noqa: D301  # \b is click's: do not rewrap
    if polish is not None:
        refuse_typed((*_OF_CURVES, *NAMES), "is in the front of --polish; leave it out")
        return _polish(polish, output)
    if weights and method != WEIGHTED.name:
        raise ValueError(f"--weights is for weighted, not for {method}; leave it out")
    if weights:
        refuse_typed(["points"], "is for weights that are chosen by the method; leave it out")
    task, total = move.task(), len(weights) or points
    asked = {"weights": weights} if weights else {"points": points}
    settings["profile"] = profile_of(profile, task, terms)
    with counting(total, *asked) as report:
        found = METHODS[method].sweep(task, report=report, **asked, **settings)
    # the ends come with weights, and epsilon has residuals of its own
    asked_for = max(total + 2 * bool(weights), len(found.points) + len(found.failures))
    if not found.points:
        reasons = "; ".join(line.strip() for line in failure_lines(found, asked_for)[1:])
        raise SolverFailedError(f"no point was found: {reasons}")
    checked = None
    if check:
        with counting(_CHECKED, "checked points") as report:
            checked = cross_check(found, _CHECKED, report)
    draw = partial(figures.front_figure, [found])
    return finish(front_files(output, found, draw), gradient_lines(found, asked_for, checked))


def _polish(file: Path, output: Sequence[Path]) -> None:
    with busy("checking"):
        given = load_front(file)
    with counting(len(given.points), "points") as report:
        polished = polish_front(given, report=report)
    draw = partial(figures.polish_figure, given, polished)
    lines = polish_lines(given, polished.front, polished.gains)
    finish(front_files(output, polished.front, draw), lines)
