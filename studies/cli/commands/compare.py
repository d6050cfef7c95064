"""`quietarm compare`: fronts of one task, or plans of one move with baselines and errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click
from quietarm.studies.cli.files import FOLDER, finish, output_option, report_files
from quietarm.studies.cli.options import busy, command, option, refuse_typed
from quietarm.studies.cli.quantities import MEASURED, once
from quietarm.studies.cli.task import error_option
from quietarm.studies.cli.types import INPUT, Parsed
from quietarm.studies.compare.judged import SAMPLES
from quietarm.studies.report import Report
from quietarm.studies.report.words import print_lines
from rich.console import Console

if TYPE_CHECKING:
    from quietarm.ocp import Front, Plan
    from quietarm.studies.compare.fronts import Comparison

_OF_PLANS, _OF_FRONTS = ("baselines", "errors", "samples"), ("reference", "free")


def _names(text: str) -> tuple[str, ...]:
    from quietarm.ocp.checks import unknown
    from quietarm.studies.compare.baselines import BASELINES

    names = BASELINES if text == "all" else tuple(dict.fromkeys(text.split(",")))
    for name in names:
        if name not in BASELINES:
            raise ValueError(unknown("baseline", name, ("all", *BASELINES)))
    return names


@command()
@click.argument("files", nargs=-1, type=INPUT, metavar="FILE...")
@option("--baselines", type=Parsed("names", _names),
        help="Plans: add these for the same move, as zvd,ruckig; or all.")  # fmt: skip
@error_option
@option("--samples", default=SAMPLES, help="Plans: random plants for the percentiles.")
@option("--reference", type=INPUT, help="Fronts: measure IGD+ and epsilon against this one.")
@option("--free-motion/--no-free-motion", "free", default=True,
        help="Fronts: find the best free motion as well.")  # fmt: skip
@output_option({FOLDER: "Markdown, CSV and pictures", ".html": "a page", ".tex": "the tables"})
def compare(
    files: tuple[Path, ...],
    baselines: tuple[str, ...] | None,
    errors: tuple[tuple[str, float], ...],
    samples: int,
    reference: Path | None,
    free: bool,
    output: Sequence[Path],
) -> None:
    """Compare fronts of one task, or plans of one move.

    Fronts, found by any methods, or a folder of a bench: energies within residuals, hypervolume,
    IGD+, epsilon, candidates and time; several seeds of a method as median and quartiles.

    Plans: energy, residual, the worst case within parameter errors, insensitivity, percentiles,
    peaks, and the limits that they exceed, beside the cycloid, input shapers and ruckig. Ruckig
    needs quietarm[ruckig] and an acceleration limit.

    \b
    Examples:
      quietarm compare nsga2.json vepso.json epsilon.json --output compared
      quietarm compare plan.json robust.json --error frequency=8% --baselines zvd,ruckig
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.ocp import Front, Plan
    from quietarm.studies.compare.opening import open_answers

    with busy("comparing"):
        answers = open_answers(files)
        plans = {name: one for name, one in answers.items() if isinstance(one, Plan)}
        fronts = {name: one for name, one in answers.items() if isinstance(one, Front)}
        if plans:
            refuse_typed(_OF_FRONTS, "is for fronts; leave it out")
            report = _of_plans(plans, baselines or (), _ranges(plans, errors), samples)
        else:
            refuse_typed(_OF_PLANS, "is for plans; leave it out")
            report = _of_fronts(fronts, reference, free)
    finish(report_files(output, report), report)


def _ranges(plans: Mapping[str, Plan], errors: Sequence[tuple[str, float]]) -> dict[str, float]:
    """Ranges of the parameter errors; `measured` are those that the plans are made for."""
    from quietarm.studies.compare.judged import merged_ranges

    ranges = once(errors, "--error ")
    if ranges.pop(MEASURED, None) is None:
        return ranges
    measured = merged_ranges(one.task for one in plans.values())
    if not measured:
        raise ValueError(
            "--error measured takes the ranges that the plans are made for, and these have none; "
            "give errors as frequency=10%"
        )
    return {**measured, **ranges}


def _of_plans(
    plans: Mapping[str, Plan], baselines: Sequence[str], ranges: Mapping[str, float], samples: int
) -> Report:
    from quietarm.studies.compare.plans import compare_plans, plans_report

    judged = compare_plans(plans, baselines, ranges, samples)
    return plans_report(next(iter(plans.values())).task, judged)


def _of_fronts(fronts: dict[str, Front], reference: Path | None, free: bool) -> Report:
    from quietarm.studies.compare.front_report import by_task, fronts_report
    from quietarm.studies.compare.fronts import compare_fronts
    from quietarm.studies.reading.saved import load_front
    from quietarm.studies.reproduce.paper import paper_points

    tasks = by_task(fronts)
    if reference is not None and len(tasks) > 1:
        raise ValueError(
            "--reference is for fronts of one task; these are of several: leave it out"
        )
    named = None if reference is None else load_front(reference)
    found = [
        compare_fronts(
            list(one.values()), list(one), reference=named, reference_name=str(reference)
        )
        for one in tasks
    ]
    found = list(map(_with_floor, found)) if free else found
    terms = [{run.front.profile.size for run in one.runs} for one in found]
    return fronts_report(
        found, [paper_points(one.task, sizes) for one, sizes in zip(found, terms, strict=True)]
    )


def _with_floor(comparison: Comparison) -> Comparison:
    """With the least energy over all joint motions; without where none is found."""
    from quietarm.ocp import QuietarmError, energy_floor

    try:
        return replace(comparison, floor=energy_floor(comparison.task).energy)
    except QuietarmError as error:
        print_lines(Console(stderr=True), f"no free motion: {error}")
        return comparison
