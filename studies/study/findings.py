"""What a study found, in sentences with its figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import isfinite, nan

import numpy as np
from quietarm.studies.comparison.measures import Comparison, Group
from quietarm.studies.comparison.staircase import within
from quietarm.studies.display.words import millimetres, title_of
from quietarm.studies.paper.points import PaperPoint
from quietarm.studies.registry.methods import METHODS, WEIGHTED, Kind, Method
from quietarm.studies.study.work import CaseStudy, Study

STILL_LEVEL = 1
"""Which of the comparison's residual levels the summary speaks of."""
_ALIKE = 1e-4
"""Energies within this share of each other count as equal: filled fronts are no finer."""
_SAME_HYPERVOLUME = 1e-3
"""Hypervolumes nearer to each other count as equal: the number of points decides about them."""
_REST = 1e-6
"""A residual within this [m] counts as rest."""


def group_of(comparison: Comparison, method: Method) -> Group | None:
    """The group of a method; None where it found nothing."""
    return next((group for group in comparison.groups if group.method == method), None)


def gap(comparison: Comparison, method: Method, figure: str = "gaps_between") -> float:
    """Median share by which a method is above the best when still; NaN without a point there."""
    group = group_of(comparison, method)
    return nan if group is None else group.spread(figure, STILL_LEVEL).median


def at_rest(found: CaseStudy) -> float:
    """Least energy [J] of all fronts at rest on arrival; NaN where none arrives so."""
    return float(within(found.comparison.best_front, [_REST])[0])


def _percents(*shares: float) -> str:
    """A share, or the range of several, in words."""
    words = [
        "less than 0.01" if abs(share) < 1e-4 else f"{float(f'{100 * share:.2g}'):g}"
        for share in (min(shares), max(shares))  # 120 %, not 1.2e+02 %
    ]
    return f"{' to '.join(dict.fromkeys(words))} %"


def _listed(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def case_findings(found: CaseStudy) -> list[str]:
    """What was found for one task."""
    comparison, groups = found.comparison, found.comparison.groups
    searches = [g for g in groups if g.method.kind is not Kind.GRADIENT and not g.method.polished]
    lines = [_best(comparison), *(_search(group, comparison.levels) for group in searches)]
    weighted = group_of(comparison, WEIGHTED)
    lines += [] if weighted is None else [_weighted(weighted)]
    for name, polish in found.polishes.items():
        shares = [gain.share for gain in polish.gains]
        better, median = sum(share > _ALIKE for share in shares), float(np.median(shares))
        lines.append(
            f"Polished by the gradient, each at its own residual, {better} of the {len(shares)} "
            f"points of {METHODS[name].label}'s first front save energy: the median of all "
            f"{_percents(median)}, the most {_percents(max(shares))}."
        )
    lines += [_paper(point, found) for point in found.paper]
    return [*filter(None, lines), *_floor(found), *found.failures]


def _best(comparison: Comparison) -> str:
    level, best = millimetres(comparison.levels[STILL_LEVEL]), comparison.best[STILL_LEVEL]
    if not isfinite(best):
        residual, energy = comparison.best_front[0]
        return (
            f"No method arrives within {level}: the stillest motion leaves {millimetres(residual)} "
            f"and takes {energy:.4g} J."
        )
    gaps = {g.label: g.spread("gaps_between", STILL_LEVEL).lower for g in comparison.groups}
    labels = [label for label, share in gaps.items() if share <= _ALIKE]
    return (
        f"The least energy with a residual within {level} is {best:.4g} J, found by "
        f"{_listed(labels)}."
    )


def _search(group: Group, levels: Sequence[float]) -> str:
    runs, words = len(group.runs), list[str]()
    for i, level in enumerate(levels):
        reached, where = group.reached(i), millimetres(level)
        short = "" if reached == runs else f" ({reached} of {runs} seeds get there)"
        share = group.spread("gaps_between", i).median
        words.append(f"{_percents(share)} at {where}{short}" if reached else f"{where} not reached")
    if not any(map(group.reached, range(len(levels)))):
        least = min(run.front.stillest().residual for run in group.runs)
        return f"The stillest motion of {group.label} leaves {millimetres(least)}."
    return (
        f"With the motions between its points, {group.label} needs more energy than the best: "
        f"{', '.join(words)}."
    )


def _weighted(group: Group) -> str:
    holes = [
        f"between {'rest' if low <= _REST else millimetres(low)} and {millimetres(high)}"
        for low, high in group.runs[0].front.gaps
    ]
    if not holes:
        return "The weighted sum reaches the whole front."
    return f"No weighted sum reaches the front {_listed(holes)}."


def _paper(point: PaperPoint, found: CaseStudy) -> str:
    if point.residual is None:
        share = point.energy / at_rest(found) - 1
        if not isfinite(share):
            return ""
        return (
            f"The paper prints {point.energy:.3g} J for N = {point.terms}, of unknown residual: "
            f"{_percents(share)} more than the best found here at rest on arrival."
        )
    (best,) = within(found.comparison.best_front, [point.residual])
    return (
        f"The paper's own motion, N = {point.terms}, takes {point.energy:.4g} J at "
        f"{millimetres(point.residual)}: {_percents(point.energy / best - 1)} more than the best "
        "found here at that residual."
    )


def _floor(found: CaseStudy) -> list[str]:
    if found.floor is None:
        return []
    best, floor = at_rest(found), found.floor.energy
    terms = found.comparison.runs[0].front.profile.size
    if not isfinite(best):
        return [
            f"No motion of {terms} coefficients was found that arrives at rest; the floor, the "
            f"least energy of any joint motion that does, is {floor:.4g} J."
        ]
    return [
        f"At rest on arrival, the best motion of {terms} coefficients takes {best:.4g} J, "
        f"{best / floor:.3g} times the floor of {floor:.4g} J that any joint motion needs."
    ]


def findings(study: Study) -> list[str]:
    """What the whole study found, in a few sentences."""
    searches = study.settings.searches
    lines = [_whose_hypervolume(study), *(_over_tasks(study, method) for method in searches)]
    saved = {
        method.label: [
            float(np.median([gain.share for gain in found.polishes[method.name].gains]))
            for found in study.cases
            if method.name in found.polishes
        ]
        for method in searches
    }
    words = [f"{_percents(*shares)} for {label}" for label, shares in saved.items() if shares]
    if words:
        lines.append(
            "Polished by the gradient, the median point saves this share of its energy: "
            f"{_listed(words)}."
        )
    weighted = [group_of(found.comparison, WEIGHTED) for found in study.cases]
    holes = [len(group.runs[0].front.gaps) > 0 for group in weighted if group is not None]
    if holes:
        lines.append(f"The weighted sum leaves gaps in {sum(holes)} of {len(holes)} fronts.")
    ratios = [at_rest(found) / found.floor.energy for found in study.cases if found.floor]
    finite = sorted(ratio for ratio in ratios if isfinite(ratio))
    if finite:
        between = " to ".join(dict.fromkeys(f"{ratio:.3g}" for ratio in (finite[0], finite[-1])))
        lines.append(
            f"At rest on arrival, the best motion of {study.settings.terms} coefficients takes "
            f"{between} times the floor, the least energy of any joint motion at all."
        )
    return [*filter(None, lines), _times(study)]


def _whose_hypervolume(study: Study) -> str:
    winners, total = Counter[str](), len(study.cases)
    for found in study.cases:
        shares = {g.label: g.spread("hypervolume").median for g in found.comparison.groups}
        most = max(shares.values()) - _SAME_HYPERVOLUME
        winners.update(label for label, share in shares.items() if share > most)
    words = ", ".join(f"{label} in {count} of {total}" for label, count in winners.most_common())
    if total == 1:
        return ""
    return (
        f"The front that dominates most: {words}; hypervolumes that differ by less than "
        f"{_SAME_HYPERVOLUME:g} count as equal."
    )


def _over_tasks(study: Study, method: Method) -> str:
    gaps = [gap(found.comparison, method) for found in study.cases]
    finite = [share for share in gaps if isfinite(share)]
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    if not finite:
        return f"{method.label} never comes within {level}."
    worst = title_of(study.cases[int(np.nanargmax(gaps))].case.task)
    where = f", most for {worst}" if len(finite) > 1 else ""
    alone = [gap(case.comparison, method, "gaps") for case in study.cases]
    reached = [share for share in alone if isfinite(share)]
    return (
        f"{method.label} takes {_percents(*finite)} more energy than the best at {level}{where}; "
        f"{_percents(*reached) if reached else 'never so still'} with the points of its front "
        f"alone, no motions between them (median of {study.settings.runs} seeds)."
    )


def _times(study: Study) -> str:
    times: dict[str, list[float]] = {}
    for group in (group for found in study.cases for group in found.comparison.groups):
        if not group.method.polished:
            seconds = [run.front.seconds for run in group.runs]
            times.setdefault(group.method.label, []).extend(seconds)
    words = ", ".join(f"{name} {np.median(values):.2g} s" for name, values in times.items())
    return f"Median time of a front: {words}."
