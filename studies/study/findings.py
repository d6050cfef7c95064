"""What a study found, in sentences with its figures."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np
from quietarm.studies.comparison.measures import Comparison, Group
from quietarm.studies.comparison.staircase import within
from quietarm.studies.display.words import millimetres, title_of
from quietarm.studies.registry.methods import WEIGHTED, Kind, Method
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


def gap(
    comparison: Comparison, method: Method, level: int = STILL_LEVEL, name: str = "gaps_between"
) -> float:
    """Median share by which a method is above the best at a level; NaN without a point there."""
    group = group_of(comparison, method)
    return np.nan if group is None else group.spread(name, level).median


def percent(share: float) -> str:
    """A share in words."""
    if abs(share) < 1e-4:
        return "less than 0.01 %"
    return f"{float(f'{100 * share:.2g}'):g} %"  # 120 %, not 1.2e+02 %


def percents(shares: Sequence[float]) -> str:
    """The range of several shares in words."""
    low, high = percent(min(shares)), percent(max(shares))
    return low if low == high else f"{low.removesuffix(' %')} to {high}"


def _listed(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def case_findings(found: CaseStudy) -> list[str]:
    """What was found for one task."""
    comparison, searches = found.comparison, _searches_of(found)
    lines = [_best(comparison), *(_search(found, method) for method in searches), _weighted(found)]
    lines += [_polish(found, method) for method in searches]
    lines += [_paper(found), _floor(found), *found.failures]
    return [line for line in lines if line]


def _searches_of(found: CaseStudy) -> list[Method]:
    """The metaheuristics that found something, and others' fronts, in the order of the work."""
    methods = [group.method for group in found.comparison.groups if not group.method.polished]
    return [method for method in methods if method.kind is not Kind.GRADIENT]


def _best(comparison: Comparison) -> str:
    level, best = comparison.levels[STILL_LEVEL], comparison.best[STILL_LEVEL]
    if not isfinite(best):
        residual, energy = comparison.best_front[0]
        return (
            f"No method arrives within {millimetres(level)}: the stillest motion leaves "
            f"{millimetres(residual)} and takes {energy:.4g} J."
        )
    labels = [
        g.label for g in comparison.groups if g.spread("gaps_between", STILL_LEVEL).lower <= _ALIKE
    ]
    return (
        f"The least energy with a residual within {millimetres(level)} is {best:.4g} J, found by "
        f"{_listed(labels)}."
    )


def _search(found: CaseStudy, method: Method) -> str:
    comparison = found.comparison
    group = group_of(comparison, method)
    if group is None:
        return ""
    if not any(group.reached(i) for i in range(len(comparison.levels))):
        least = min(run.front.stillest().residual for run in group.runs)
        return f"The stillest motion of {method.label} leaves {millimetres(least)}."
    words: list[str] = []
    for i, level in enumerate(comparison.levels):
        reached, runs = group.reached(i), len(group.runs)
        short = "" if reached == runs else f" ({reached} of {runs} seeds get there)"
        if reached:
            words.append(f"{percent(gap(comparison, method, i))} at {millimetres(level)}{short}")
        else:
            words.append(f"{millimetres(level)} not reached")
    return (
        f"With the motions between its points, {method.label} needs more energy than the best: "
        f"{', '.join(words)}."
    )


def _weighted(found: CaseStudy) -> str:
    group = group_of(found.comparison, WEIGHTED)
    if group is None:
        return ""
    gaps = group.runs[0].front.gaps
    if not gaps:
        return "The weighted sum reaches the whole front."
    holes = [
        f"between {'rest' if low <= _REST else millimetres(low)} and {millimetres(high)}"
        for low, high in gaps
    ]
    return f"No weighted sum reaches the front {_listed(holes)}."


def _polish(found: CaseStudy, method: Method) -> str:
    polish = found.polishes.get(method.name)
    if polish is None:
        return ""
    shares = [gain.share for gain in polish.gains]
    better = sum(share > _ALIKE for share in shares)
    return (
        f"Polished by the gradient, each at its own residual, {better} of the {len(shares)} points "
        f"of {method.label}'s first front save energy: the median of all "
        f"{percent(float(np.median(shares)))}, the most {percent(max(shares))}."
    )


def _paper(found: CaseStudy) -> str:
    words: list[str] = []
    for point in found.paper:
        if point.residual is None:
            rest = at_rest(found)
            if isfinite(rest):
                words.append(
                    f"The paper prints {point.energy:.3g} J for N = {point.terms}, of unknown "
                    f"residual: {percent(point.energy / rest - 1)} more than the best found here "
                    "at rest on arrival."
                )
            continue
        (best,) = within(found.comparison.best_front, [point.residual])
        words.append(
            f"The paper's own motion, N = {point.terms}, takes {point.energy:.4g} J at "
            f"{millimetres(point.residual)}: {percent(point.energy / best - 1)} more than the best "
            "found here at that residual."
        )
    return " ".join(words)


def at_rest(found: CaseStudy) -> float:
    """Least energy [J] of all fronts at rest on arrival; NaN where none arrives so."""
    return float(within(found.comparison.best_front, [_REST])[0])


def _floor(found: CaseStudy) -> str:
    best = at_rest(found)
    if found.floor is None:
        return ""
    terms = found.comparison.runs[0].front.profile.size
    if not isfinite(best):
        return (
            f"No motion of {terms} coefficients was found that arrives at rest; the floor, the "
            f"least energy of any joint motion that does, is {found.floor.energy:.4g} J."
        )
    return (
        f"At rest on arrival, the best motion of {terms} coefficients takes {best:.4g} J, "
        f"{best / found.floor.energy:.3g} times the floor of {found.floor.energy:.4g} J that any "
        "joint motion needs."
    )


def findings(study: Study) -> list[str]:
    """What the whole study found, in a few sentences."""
    searches = study.settings.searches
    lines = [_whose_hypervolume(study), *(_searches(study, method) for method in searches)]
    lines += [_polishes(study), _weights(study), _floors(study), _times(study)]
    return [line for line in lines if line]


def _whose_hypervolume(study: Study) -> str:
    winners: dict[str, int] = {}
    for found in study.cases:
        shares = {g.label: g.spread("hypervolume").median for g in found.comparison.groups}
        for label, share in shares.items():
            if share > max(shares.values()) - _SAME_HYPERVOLUME:
                winners[label] = winners.get(label, 0) + 1
    total = len(study.cases)
    words = ", ".join(
        f"{label} in {count} of {total}" for label, count in sorted(winners.items(), key=_last)
    )
    if total == 1:
        return ""
    return (
        f"The front that dominates most: {words}; hypervolumes that differ by less than "
        f"{_SAME_HYPERVOLUME:g} count as equal."
    )


def _last(item: tuple[str, int]) -> int:
    return -item[1]


def _searches(study: Study, method: Method) -> str:
    gaps = [gap(found.comparison, method) for found in study.cases]
    finite = [share for share in gaps if isfinite(share)]
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    if not finite:
        return f"{method.label} never comes within {level}." if study.cases else ""
    worst = study.cases[int(np.nanargmax(gaps))]
    where = f", most for {title_of(worst.case.task)}" if len(finite) > 1 else ""
    found = [gap(case.comparison, method, name="gaps") for case in study.cases]
    reached = [share for share in found if isfinite(share)]
    alone = percents(reached) if reached else "never so still"
    return (
        f"{method.label} takes {percents(finite)} more energy than the best at {level}"
        f"{where}; {alone} with the points of its front alone, no motions between them (median of "
        f"{study.settings.runs} seeds)."
    )


def _polishes(study: Study) -> str:
    words: list[str] = []
    for method in study.settings.searches:
        medians = [
            float(np.median([gain.share for gain in found.polishes[method.name].gains]))
            for found in study.cases
            if method.name in found.polishes
        ]
        if medians:
            words.append(f"{percents(medians)} for {method.label}")
    if not words:
        return ""
    return (
        "Polished by the gradient, the median point saves this share of its energy: "
        f"{_listed(words)}."
    )


def _weights(study: Study) -> str:
    groups = [group_of(found.comparison, WEIGHTED) for found in study.cases]
    holes = [len(group.runs[0].front.gaps) > 0 for group in groups if group is not None]
    if not holes:
        return ""
    return f"The weighted sum leaves gaps in {sum(holes)} of {len(holes)} fronts."


def _floors(study: Study) -> str:
    ratios = [at_rest(f) / f.floor.energy for f in study.cases if f.floor is not None]
    finite = [ratio for ratio in ratios if isfinite(ratio)]
    if not finite:
        return ""
    low, high = f"{min(finite):.3g}", f"{max(finite):.3g}"
    return (
        f"At rest on arrival, the best motion of {study.settings.terms} coefficients takes "
        f"{low if low == high else f'{low} to {high}'} times the floor, the least energy of any "
        "joint motion at all."
    )


def _times(study: Study) -> str:
    times: dict[str, list[float]] = {}
    for found in study.cases:
        for group in found.comparison.groups:
            if not group.method.polished:
                seconds = (run.front.seconds for run in group.runs)
                times.setdefault(group.method.label, []).extend(seconds)
    words = ", ".join(f"{name} {np.median(values):.2g} s" for name, values in times.items())
    return f"Median time of a front: {words}."
