"""The first line of a comparison: which plan leaves least, which front takes least energy."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from quietarm.metaheuristics.score import HYPERVOLUME, gap
from quietarm.metaheuristics.spread import SEARCH_RESIDUAL, Spread
from quietarm.ocp.rest import is_at_rest
from quietarm.studies.compare.compared_motions import ComparedMotion
from quietarm.studies.compare.front_comparison import Comparison, RunsOfMethod
from quietarm.views.report.captions import left_words
from quietarm.views.report.words import counted
from quietarm.views.tips import tip_words

_MOST_NAMED = 3


def answer_by_residual(motions: Sequence[ComparedMotion]) -> str:
    """Return which motions leave least, in the worst case if there are errors, and their energy.

    Of those that keep the limits; of motions at rest the one of least energy is first.
    """
    there = [motion for motion in motions if motion.motion is not None]
    if not there:
        return "None of these motions is possible."
    order = sorted([motion for motion in there if not motion.exceeded] or there, key=_rank)
    clauses = [f"{motion.name} {_left(motion)} for {_energy(motion)}" for motion in order]
    named, others = clauses[:_MOST_NAMED], clauses[_MOST_NAMED:]
    if others:
        named.append(f"{counted(len(others), 'other')} below")
    worst = "In the worst case, " if order[0].worst is not None else ""
    return f"{worst}{'; '.join(named)}."


def _rank(judged: ComparedMotion) -> tuple[float, float]:
    assert judged.motion is not None
    residual = _residual(judged)
    return (0.0 if is_at_rest(residual, judged.task) else residual), judged.motion.energy


def _residual(judged: ComparedMotion) -> float:
    assert judged.motion is not None
    return judged.motion.residual if judged.worst is None else judged.worst.residual


def _left(judged: ComparedMotion) -> str:
    return left_words(_residual(judged), judged.task)


def _energy(judged: ComparedMotion) -> str:
    assert judged.motion is not None
    return f"{judged.motion.energy:.3g} J"


def answer_of_fronts(comparison: Comparison) -> str:
    """Return which front takes least energy within 1 mm, or the largest residual compared.

    Of several seeds the medians; beside it the next, with the hypervolume gaps of both.
    """
    tip_unit = comparison.task.plant.tip_unit
    levels = sorted(comparison.levels, key=lambda level: (level != SEARCH_RESIDUAL, -level))
    for level in levels:
        place = comparison.levels.index(level)
        medians = [(group.spread("energies", place).median, group) for group in comparison.groups]
        reached = sorted((one for one in medians if isfinite(one[0])), key=lambda one: one[0])
        if reached:
            within = tip_words(level, tip_unit)
            clauses = [f"{group.label} takes {energy:.4g} J" for energy, group in reached]
            clauses += [
                f"{group.label} has no such motion"
                for median, group in medians
                if not isfinite(median)
            ]
            named = clauses[:_MOST_NAMED]
            return f"Within {within}, {'; '.join(named)}{_gaps(comparison, reached[0][1])}."
    most = tip_words(max(comparison.levels), tip_unit)
    return f"No front comes within {most}."


def _gaps(comparison: Comparison, first: RunsOfMethod) -> str:
    """Return the least hypervolume gap of several methods, unless the first one has it."""
    if len(comparison.groups) < 2 or not comparison.fill:
        return ""
    gaps = [
        (Spread.of([gap(run.scores[HYPERVOLUME.name]) for run in group.runs]).median, group.label)
        for group in comparison.groups
    ]
    least, label = min(gaps)
    whose = "the first" if label == first.label else label
    return f"; {whose} has the smallest hypervolume gap, {least:.2g} %"
