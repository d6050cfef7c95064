"""What a study found, in sentences with its figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import inf, isfinite

import numpy as np
from quietarm.studies.comparison.measures import Comparison, Group
from quietarm.studies.comparison.staircase import within
from quietarm.studies.display.words import REST, millimetres, residual_words, title_of
from quietarm.studies.document.prose import percents, told
from quietarm.studies.registry.methods import METHODS, WEIGHTED, Kind, Method
from quietarm.studies.study.work import CaseStudy, Study

STILL_LEVEL = 1
"""Which of the comparison's residual levels the summary speaks of."""
_ALIKE = 1e-4
"""Energies within this share of each other count as equal: filled fronts are no finer."""
_SAME_HYPERVOLUME = 1e-3
"""Hypervolumes nearer to each other count as equal: the number of points decides about them."""


def group_of(comparison: Comparison, method: Method) -> Group | None:
    """The group of a method; None where it found nothing."""
    return next((group for group in comparison.groups if group.method == method), None)


def gap(comparison: Comparison, method: Method, figure: str = "gaps_between") -> float:
    """Median share by which a method is above the best when still; infinite without a point."""
    group = group_of(comparison, method)
    return inf if group is None else group.spread(figure, STILL_LEVEL).median


def at_rest(found: CaseStudy) -> float:
    """Least energy [J] of all fronts at rest on arrival; NaN where none arrives so."""
    return float(within(found.comparison.best_front, [REST])[0])


def case_findings(found: CaseStudy) -> list[str]:
    """What was found for one task."""
    comparison, rest = found.comparison, at_rest(found)
    groups, best = comparison.groups, comparison.best[STILL_LEVEL]
    gaps = {group.label: group.spread("gaps_between", STILL_LEVEL).lower for group in groups}
    weighted = group_of(comparison, WEIGHTED)
    shares = {name: [gain.share for gain in one.gains] for name, one in found.polishes.items()}
    paper = [
        (point, point.energy / float(within(comparison.best_front, [at])[0]) - 1)
        for point in found.paper
        for at in (REST if point.residual is None else point.residual,)
    ]
    lines = told(
        "study/case.txt",
        level=comparison.levels[STILL_LEVEL],
        best=best,
        found=[label for label, share in gaps.items() if isfinite(best) and share <= _ALIKE],
        stillest=comparison.best_front[0],
        searches=[
            (group, *_reached(group, comparison.levels))
            for group in groups
            if group.method.kind is not Kind.GRADIENT and not group.method.polished
        ],
        holes=None if weighted is None else _holes(weighted),
        polished=[
            (METHODS[name].label, saved, sum(share > _ALIKE for share in saved))
            for name, saved in shares.items()
        ],
        paper=[(point, share) for point, share in paper if isfinite(share)],
        terms=comparison.runs[0].front.profile.size,
        rest=rest if isfinite(rest) else None,
        floor=found.floor.energy if found.floor else None,
    )
    return [*lines, *found.failures]


def _reached(group: Group, levels: Sequence[float]) -> tuple[float | None, list[str]]:
    """The residual of the stillest motion where none is within a level; and what each level takes.

    In words, with the share above the best.
    """
    runs, words = len(group.runs), list[str]()
    for i, level in enumerate(map(millimetres, levels)):
        reached, share = group.reached(i), group.spread("gaps_between", i).median
        short = "" if reached == runs else f" ({reached} of {runs} seeds get there)"
        stated = f"{percents([share])} at {level}" if isfinite(share) else f"{level} not reached"
        words.append(stated + short * (reached > 0))
    if any(group.reached(i) for i in range(len(levels))):
        return None, words
    return min(run.front.stillest().residual for run in group.runs), words


def _holes(group: Group) -> list[str]:
    return [
        f"between {residual_words(low)} and {millimetres(high)}"
        for low, high in group.runs[0].front.gaps
    ]


def findings(study: Study) -> list[str]:
    """What the whole study found, in a few sentences."""
    cases, searches = study.cases, study.settings.searches
    saved = {
        method.label: [
            float(np.median([gain.share for gain in found.polishes[method.name].gains]))
            for found in cases
            if method.name in found.polishes
        ]
        for method in searches
    }
    weighted = [group_of(found.comparison, WEIGHTED) for found in cases]
    ratios = [at_rest(found) / found.floor.energy for found in cases if found.floor]
    finite = sorted(ratio for ratio in ratios if isfinite(ratio))
    times: dict[str, list[float]] = {}
    winners = Counter[str]()
    for groups in (found.comparison.groups for found in cases):
        volumes = {group.label: group.spread("hypervolume").median for group in groups}
        most = max(volumes.values()) - _SAME_HYPERVOLUME
        winners.update(label for label, volume in volumes.items() if volume > most)
        for group in groups:
            if not group.method.polished:
                seconds = [run.front.seconds for run in group.runs]
                times.setdefault(group.method.label, []).extend(seconds)
    return told(
        "study/tasks.txt",
        tasks=len(cases),
        winners=winners.most_common(),
        same=f"{_SAME_HYPERVOLUME:g}",
        level=cases[0].comparison.levels[STILL_LEVEL],
        searches=[_over_tasks(study, method) for method in searches],
        seeds=study.settings.runs,
        saved=[f"{percents(shares)} for {label}" for label, shares in saved.items() if shares],
        holes=[len(group.runs[0].front.gaps) > 0 for group in weighted if group is not None],
        ratios=list(dict.fromkeys(f"{ratio:.3g}" for ratio in (*finite[:1], *finite[-1:]))),
        terms=study.settings.terms,
        times=times,
    )


def _over_tasks(study: Study, method: Method) -> tuple[Method, list[float], str, list[float]]:
    """A method, its gaps to the best, the task with the largest, and the gaps of points alone."""
    gaps = [gap(found.comparison, method) for found in study.cases]
    alone = [gap(found.comparison, method, "gaps") for found in study.cases]
    finite = [share for share in gaps if isfinite(share)]
    worst = study.cases[gaps.index(max(finite))].case.task if finite else study.cases[0].case.task
    return method, finite, title_of(worst), [share for share in alone if isfinite(share)]
