"""`quietarm compare`: fronts of one task, or plans of one move with baselines and errors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import click

from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import BAND as BAND_OPTIONS
from quietarm.studies.cli.options import ERROR, SOLVER, busy, command, option
from quietarm.studies.cli.outputs import REPORT_OPTION, finish
from quietarm.studies.cli.plants import warn_of_notes
from quietarm.studies.cli.quantities import (
    BAND,
    MEASURED,
    once,
    parse_energy,
)
from quietarm.studies.cli.types import INPUT, NAMES, Named, Parsed
from quietarm.studies.compare.compared_motions import SAMPLES
from quietarm.studies.compare.plan_comparison import DURATIONS
from quietarm.views.report import Report
from quietarm.views.report.terminal import ErrorConsole, print_lines

if TYPE_CHECKING:
    from quietarm.ocp import Front, Plan, PointToPoint, Solver
    from quietarm.studies.compare.front_comparison import Comparison


_OF_PLANS = [
    "baselines", "errors", "band", "band_margin", "durations", "energy", "samples",
]  # fmt: skip
"""Options that judge plans."""
_OF_FLOOR = [param.name or "" for param in SOLVER]
"""Options of what solves here: the floor beneath fronts."""


@command(
    click.Argument(["files"], nargs=-1, type=INPUT, metavar="FILE..."),
    option("--baselines", type=NAMES, help="Plans: add for the same move, such as zvd,ruckig; or "
                                           "all."),
    ERROR,
    *BAND_OPTIONS,
    option("--durations", type=Named("durations", DURATIONS), help="Plans: how long baselines "
           "take, the shortest time of each within the limits, as long as the plan, or a row of "
           "each. [default: own with --band, else plan]"),
    option("--energy", type=Parsed("energy", parse_energy), help="Plans: what counts as energy "
           "here, such as positive+copper:30 with the windings' heat by the motor constant. "
           "[default: the plan's]"),
    option("--samples", default=SAMPLES, help="Plans: random plants for the percentiles."),
    option("--reference", type=INPUT,
           help="Fronts: measure IGD+ and additive epsilon against this one."),
    option("--free-motion/--no-free-motion", "free", default=True,
           help="Fronts: find the best free motion as well."),
    *SOLVER, REPORT_OPTION,
)  # fmt: skip
def compare(given: Given) -> None:
    """Compare fronts of one task, or plans of one move.

    Fronts, found by any methods, or a folder of a bench: energies within residuals, hypervolume,
    IGD+, additive epsilon, candidates and time; several seeds of a method as median and quartiles.

    Plans: energy, residual, the worst case within parameter errors, insensitivity, percentiles,
    peaks, and the limits that they exceed, beside the cycloid, S-curves, input shapers, ruckig and
    toppra. Ruckig needs quietarm[ruckig] and an acceleration limit, toppra quietarm[toppra] and one
    of acceleration or torque.

    With --band: who may act first within the errors, and at what energy and force. Each baseline
    takes its own shortest time within the limits.

    \b
    Examples:
      quietarm compare nsga2.json vepso.json epsilon.json --output compared
      quietarm compare plan.json robust.json --error frequency=8% --baselines zvd,ruckig
      quietarm compare plan.json robust.json --band 0.1mm --baselines all
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.ocp import Front, Plan
    from quietarm.studies.compare.load_answers import open_answers

    with busy("comparing"):
        answers = open_answers(given.files)
        plans = {name: answer for name, answer in answers.items() if isinstance(answer, Plan)}
        fronts = {name: answer for name, answer in answers.items() if isinstance(answer, Front)}
        if plans:
            given.refuse(["reference", "free", *_OF_FLOOR], "is for fronts")
            report = _of_plans(given, plans)
        else:
            given.refuse(_OF_PLANS, "is for plans")
            if not given.free:
                given.refuse(_OF_FLOOR, "is for the free motion, which --no-free-motion leaves out")
            report = _of_fronts(given, fronts)
    finish(report.files(*given.output), report)


def _of_plans(given: Given, plans: Mapping[str, Plan]) -> Report:
    """Plans and baselines; `measured` errors are those that the plans are made for."""
    from quietarm.studies.compare.compared_motions import merged_ranges
    from quietarm.studies.compare.plan_comparison import compare_plans, plans_report

    ranges = once(given.errors, "--error ")
    if ranges.pop(MEASURED, None) is not None:
        measured = merged_ranges(plan.task for plan in plans.values())
        if not measured:
            raise ValueError(
                "--error measured takes the ranges that the plans are made for, and these have "
                "none; give errors as frequency=10%"
            )
        ranges = {**measured, **ranges}
    first = next(iter(plans.values())).task
    task = _judging(given, first)
    if task.band is not None:
        given.refuse(["samples"], "is for residuals, which a band leaves out")
    judged = compare_plans(
        plans,
        given.baselines or (),
        ranges,
        given.samples,
        task=None if task is first else task,
        durations=given.durations,
    )
    return plans_report(task, judged)


def _judging(given: Given, task: PointToPoint) -> PointToPoint:
    """The task of the first plan, with the band and the energy that were typed."""
    band = given.read_of_plant(BAND, task.plant)
    if band is not None:
        task = replace(task, band=band, margin=given.band_margin)
    elif task.band is None:
        given.refuse(["band_margin"], "is of a --band, and none is given")
    elif given.typed("band_margin"):
        task = replace(task, margin=given.band_margin)
    return task if given.energy is None else replace(task, energy=given.energy)


def _of_fronts(given: Given, fronts: dict[str, Front]) -> Report:
    from quietarm.ocp import FunctionFront
    from quietarm.studies.answers.read_answers import load_front
    from quietarm.studies.compare.front_report import compare_by_task, fronts_report
    from quietarm.studies.compare.function_report import functions_report
    from quietarm.studies.reproduce.paper import paper_points

    reference = None if given.reference is None else load_front(given.reference)
    if any(isinstance(front, FunctionFront) for front in fronts.values()):
        given.refuse(["free", *_OF_FLOOR], "is for fronts of a move, and these are of a function")
        return functions_report(fronts, reference, str(given.reference))
    comparisons = compare_by_task(fronts, reference, str(given.reference))
    if given.free:
        solver = given.read_solver()
        comparisons = list(map(partial(_with_floor, solver=solver), comparisons))
    of_paper = [
        paper_points(comparison.task, {run.front.profile.size for run in comparison.runs})
        for comparison in comparisons
    ]
    for comparison in comparisons:
        warn_of_notes(comparison.task.plant)
    return fronts_report(comparisons, of_paper)


def _with_floor(comparison: Comparison, solver: Solver) -> Comparison:
    """Add the least energy over all joint motions to a comparison; nothing where none is found."""
    from quietarm.ocp import QuietarmError, energy_floor

    try:
        return replace(comparison, floor=energy_floor(comparison.task, solver=solver).energy)
    except QuietarmError as error:
        print_lines(ErrorConsole(), f"no free motion: {error}")
        return comparison
