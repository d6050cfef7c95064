"""`quietarm front`: the trade-off of residual, energy and peaks by the gradient."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from quietarm.metaheuristics import PRESETS
from quietarm.ocp import (
    Front,
    SolverFailedError,
    cross_check,
    epsilon_front,
    interpolate_front,
    polish_front,
    weighted_front,
)
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.front.time_front import TIME_AND_ENERGY, TimeFront, time_front
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, refuse_more_objectives
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.studies.answers.read_answers import load_front
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.interrupted import InterruptedCommandError
from quietarm.studies.cli.options import (
    BOUND,
    ROBOT_PATH,
    SEED,
    SOLVER,
    STARTS,
    TASK,
    YES,
    busy,
    command,
    counting,
    method_option,
    objectives_option,
    option,
    profile_options,
)
from quietarm.studies.cli.outputs import (
    PICTURE,
    answer_files,
    check_page,
    finish,
    output_option,
    refuse_formats,
)
from quietarm.studies.cli.quantities import parse_objectives_of_front, parse_weights
from quietarm.studies.cli.types import INPUT, Parsed
from quietarm.views import pictures
from quietarm.views.report.acting_words import band_lines_of_front
from quietarm.views.report.front_rows import (
    failure_lines,
    gradient_lines,
    polish_lines,
    search_lines,
)
from quietarm.views.report.time_rows import time_front_lines
from quietarm.views.report.words import counted

_METHODS = {"epsilon": epsilon_front, "weighted": weighted_front}
_DURATIONS = 9
"""Points of a front of time and energy where none are asked for: each is a robust plan."""
_SEARCHES = {
    name: f"{name} is a metaheuristic; give quietarm search --method {name}" for name in PRESETS
} | {
    f"{name}:{solver}": f"{name}:{solver} names its solver; give --method {name} --solver {solver}"
    for name in _METHODS
    for solver in SOLVERS
}


@command(
    *TASK, *ROBOT_PATH,
    method_option(_METHODS, _SEARCHES, "epsilon",
                  "Least energy at one residual limit after another (epsilon), or the least "
                  "weighted sum for one pair of weights after another."),
    *profile_options(), BOUND,
    objectives_option(
        parse_objectives_of_front,
        " Or time,energy with a --band: moves from the fastest to --duration.",
    ),
    option("--points", default=50,
           help="Points of the front, with peaks about so many; epsilon has 0.1, 1 and 5 mm "
           "besides."),
    option("--weights", type=Parsed("weights", parse_weights), multiple=True, metavar="R:E",
           help="weighted: weights of residual and energy, scaled to the ends of the front, as "
           "1:3; in place of --points."),
    STARTS, SEED, *SOLVER, YES,
    option("--check", is_flag=True, help="Solve seven points by the other solver as well, from the "
           "plain cycloid, and say by how much the two differ."),
    option("--polish", type=INPUT, metavar="FILE", help="Improve the points of this front, by any "
           "method: from each to less energy and no larger residual."),
    option("--interpolate", type=INPUT, metavar="FILE", help="Simulate about 300 motions "
           "between the points of this front, by any method, and add those that are not "
           "dominated."),
    output_option({".json": "the front", ".csv": "its points", PICTURE: "a picture"},
                  formats=["front"]),
)  # fmt: skip
def front(given: Given) -> None:
    """Find the trade-off of residual, energy and peaks by the gradient, or of time and energy.

    \b
    Examples:
      quietarm front arm-on-flexible-link --target pi/2 --duration 0.8 --output front.json \\
          --output front.csv --output front.png --output front.html
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --method weighted
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --check
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 \\
          --objectives residual,energy,peak-torque --output front.json --output front.png
      quietarm front single-link --target pi/6 --band 1mm --objectives time,energy \\
          --torque-limit 0.15 --jerk-limit 500 --output time.json --output time.png
      quietarm front --polish nsga2.json --output polished.json --output polished.png
      quietarm front --interpolate gp.json --output finer.json --output finer.csv
    """  # noqa: D301  # \b is click's: do not rewrap
    if given.polish is not None:
        return _polish(given)
    if given.interpolate is not None:
        return _interpolate(given)
    if given.objectives == TIME_AND_ENERGY:
        return _of_time(given)
    wanted = "points"
    if given.weights:
        if given.method != "weighted":
            raise ValueError(f"--weights is for weighted, not for {given.method}; leave it out")
        given.refuse(["points"], "is for weights that are chosen by the method")
        wanted = "weights"
    refuse_more_objectives(given.method, given.objectives)
    check_page(given.output, given.objectives)
    if given.check and given.objectives != RESIDUAL_AND_ENERGY:
        raise ValueError(
            "--check is for residual and energy; find the front again with the other --solver"
        )
    task = given.read_task()
    profile = given.read_profile(task)
    solver = given.read_solver()
    total = len(given.weights) or given.points
    options = given.pick(wanted, "bound", "starts", "seed")
    if given.method == "epsilon":
        options["at"] = LEVELS if task.band_limit is None else (*LEVELS, task.band_limit)
    if given.objectives != RESIDUAL_AND_ENERGY:
        options |= given.pick("objectives")
    with counting(total, wanted) as report:
        solution = _METHODS[given.method](
            task,
            profile=profile,
            report=report,
            solver=solver,
            **options,
        )
    # the ends come with weights, and epsilon has residuals of its own
    with_ends = total + 2 * bool(given.weights)
    points = max(with_ends, len(solution.points) + len(solution.failures))
    if not solution.points:
        reasons = "; ".join(line.strip() for line in failure_lines(solution, points)[1:])
        raise SolverFailedError(f"no point was found: {reasons}")
    checked = None
    if given.check:
        checked_points = 7
        with counting(checked_points, "checked points") as report:
            checked = cross_check(solution, checked_points=checked_points, report=report)
    files = answer_files(given.output, lambda: pictures.front_figure([solution]), solution)
    lines = gradient_lines(solution, points, checked)
    return finish(files, *band_lines_of_front(solution), *lines, *given.remarks)


def _of_time(given: Given) -> None:
    """The trade-off of the time to act and the energy."""
    shown_by_others = ("method", "profile", "terms", "weights", "check", "starts")
    given.refuse(shown_by_others, "is not for time,energy")
    refuse_formats(given.output, (".json", ".csv", PICTURE), "time front")
    longest = given.typed("duration")
    task = given.read_task(**({} if longest else {"duration": 1.0}))  # the search begins from it
    points = given.points if given.typed("points") else _DURATIONS
    kept = list[TimeFront]()
    trouble = None
    try:
        with counting(points, "durations") as report:
            time_front(
                task,
                longest=task.duration if longest else None,
                points=points,
                report=report,
                keep=kept.append,
                solver=given.read_solver(),
                **given.pick("bound", "seed"),
            )
    except KeyboardInterrupt as stop:
        if not kept:
            raise
        done = f"{len(kept[-1].points)} of {points} points are found and kept"
        trouble = InterruptedCommandError(f"interrupted: {done}", stop)
    solution = kept[-1]  # of all durations, or of those until a stop
    files = answer_files(given.output, partial(pictures.time_front_figure, solution), solution)
    finish(files, *time_front_lines(solution), *given.remarks, trouble=trouble)


def _polish(given: Given) -> None:
    before = _front_to_change(given, "polish", [param.name or "" for param in SOLVER])
    with counting(len(before.points), "points") as report:
        polished = polish_front(before, solver=given.read_solver(), report=report)
    lines = polish_lines(before, polished.front, polished.gains)
    files = answer_files(
        given.output, lambda: pictures.polish_figure(before, polished), polished.front, [before]
    )
    finish(files, *lines)


def _interpolate(given: Given) -> None:
    before = _front_to_change(given, "interpolate")
    with busy("evaluating motions between its points"):
        finer = interpolate_front(before)
    added = sum(point not in before.points for point in finer.points)
    tried = finer.record.evaluations - before.record.evaluations
    note = (
        f"{added} of {counted(tried, 'motion')} tried between its points were added"
        if tried
        else "no motion was tried: its points are as close as they would become"
    )
    files = answer_files(given.output, lambda: pictures.front_figure([finer]), finer, [before])
    finish(files, *search_lines([finer], [note]))


def _front_to_change(given: Given, option: str, further: Sequence[str] = ()) -> Front:
    """The front in the file of an option, which leaves no room for others but a few."""
    given.refuse_others(
        {option, "output", *further},
        f"is not for --{option}, which keeps the task, profile and bound of its front",
    )
    with busy("checking"):
        before = load_front(getattr(given, option))
    check_page(given.output, before.objectives)
    return before
