"""What a contest found and how it was held, in sentences."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.metaheuristics.budget.run import MULTISTART, Help, parts_of
from quietarm.studies.contest.landscape import CANDIDATES, LEVEL, Landscape
from quietarm.studies.contest.measures import Arena, Field, methods_in
from quietarm.studies.contest.names import is_own, label_of, method_in
from quietarm.studies.contest.report.tables import evaluations_words
from quietarm.studies.contest.statistics import ALPHA, Ranking, why_none
from quietarm.studies.display.words import counted, millimetres, versions_of

_EXACT = "the exact front's"
_MEASURED = (
    "the last generation cut short where the budget does not suffice for it. Every feasible "
    "candidate that no other dominates is kept, whatever the method itself keeps. Hypervolumes are "
    "measured from a tenth beyond the worst of the exact front in each objective, both scaled to "
    "its extent; that of the exact front counts the motions between its points. The expected "
    "running time is COCO's: the evaluations that all runs spent until they reached a target, or "
    "in all, over the number that reached it, seen at marks 5 % apart. Time is processor time of "
    "the search, without that of the record."
)
_GRADIENT = (
    "An iteration of the gradient's solver counts as the 1 + n + n (n + 1) / 2 evaluations that "
    "differences would take for its first and second derivatives of n coefficients."
)
_POLISH = "What is polished is searched with half of the evaluations first."
_SEEDS = (
    "Gradient seeds are five motions in the first population, each solved from a random start: at "
    "rest, with any residual, and at a quarter, half and three quarters of that."
)
_TESTS = (
    f"Differences are tested at {100 * ALPHA:g} %: by Friedman's test and Nemenyi's critical "
    "difference over seeds on each problem and over the problems' medians, and in pairs by the "
    "Mann-Whitney test with Holm's correction; the effect size is Vargha and Delaney's A."
)
_IMPORTS = (
    "Their coefficients were evaluated here by CVODES; only what a run ended with is known of "
    "them, so that they have no anytime curves, expected running times or times, and tests compare "
    "those alone whose evaluations are those of the others. Ranks over seeds are without them."
)


def findings(arenas: Sequence[Arena], notes: Sequence[str] = ()) -> list[str]:
    """What is to be read first."""
    lines = [
        f"{arena.problem}: {arena.best.label} ends nearest to the exact front, with "
        f"{_missing_words(arena.best, 'its')}."
        for arena in arenas
    ]
    none = why_none(arenas)
    lines += [f"{none}."] if none else []
    for arena in arenas:
        lines += [f"{arena.problem}: {line}." for line in _unequal(arena)]
    return [*lines, *not_alike(arenas), *(f"{note}." for note in notes)]


def _unequal(arena: Arena) -> list[str]:
    """What is to be known of runs that are not as many, as long or of the same versions."""
    lines, fields = list[str](), arena.own
    if len({len(field.runs) for field in fields}) > 1:
        stated = ", ".join(f"{field.label} {len(field.runs)}" for field in fields)
        lines.append(f"the methods have unequal numbers of runs: {stated}")
    lines += [
        f"{field.label} ended before its evaluations were spent"
        for field in fields
        if any(run.front.evaluations < (run.evaluations or 0) for run in field.runs)
    ]
    versions = versions_of(run.front for field in fields for run in field.runs)
    mixed = [words for words in versions if " and " in words]
    return lines + [f"the runs are of different versions: {', '.join(mixed)}"] * bool(mixed)


def not_alike(arenas: Sequence[Arena]) -> list[str]:
    """Results from elsewhere that are shown and not compared by tests, and why, in sentences."""
    return [
        f"{arena.problem}: {one.label} ends with {_missing_words(one, _EXACT)}. It does not "
        f"compare: its evaluations are {evaluations_words(one)}, those of the others "
        f"{' or '.join(sorted({evaluations_words(field) for field in arena.own}))}."
        for arena in arenas
        for one in arena.imports
        if one not in arena.alike
    ]


def wrong_claims(arenas: Sequence[Arena]) -> list[str]:
    """What files from elsewhere state otherwise than their coefficients give, in words."""
    runs = [run for arena in arenas for field in arena.fields for run in field.runs]
    return [f"{run.words}: {claim}" for run in runs for claim in run.claims]


def _missing_words(one: Field, whose: str) -> str:
    """What the middle run has not found, in words."""
    runs = f"the middle run of {len(one.runs)}" if len(one.runs) > 1 else "its only run"
    return f"{100 * one.middle:.3g} % of {whose} hypervolume missing in {runs}"


def verdict(found: Ranking) -> str:
    """What the tests say of a ranking."""
    says = "the methods differ" if found.differ else "no difference is shown"
    return (
        f"Friedman's test: chi2 = {found.statistic:.3g}, p = {found.p_value:.2g}, {says} at "
        f"{100 * ALPHA:g} %; Nemenyi's critical difference is {found.critical:.2f}."
    )


def explanation(found: Landscape) -> list[str]:
    """What makes a problem hard, in sentences."""
    level, number = millimetres(LEVEL), found.minima
    differ = "all these minima have the same energy, to 0.1 %"
    if number > 1:
        differ = f"{number} of the minima differ by more than 0.1 % in energy"
    lines = [
        f"Of {found.starts} random starts in the box, the gradient ended at a minimum of the "
        f"energy within {level} from {100 * found.solved:.0f} %, and at the best of these from "
        f"{100 * found.best:.0f} %; {differ}.",
        f"Over {CANDIDATES} random candidates, energy and distance to the cheapest motion "
        f"correlate by {found.candidates:.2f} (1 where better candidates lie nearer to it).",
    ]
    if found.correlation is not None:
        lines.append(
            "Over the minima found, energy and distance to the best one correlate by "
            f"{found.correlation:.2f}."
        )
    for share, ratio in found.boxes:
        least = f"the least energy within {level} is {ratio or 0:.4g} times that in this one"
        none = f"no motion within {level} was found"
        lines.append(f"With a box {share:g} times as large {none if ratio is None else least}.")
    return lines


def methods_paragraph(arenas: Sequence[Arena]) -> str:
    """How the contest was held, ready for a paper."""
    runs = [run for arena in arenas for field in arena.own for run in field.runs]
    seeds = sorted({run.front.seed or 0 for run in runs})
    budgets = sorted({run.evaluations or 0 for run in runs})
    methods = [method for method in methods_in(arenas) if is_own(method)]
    parts = [parts_of(method_in(method)) for method in methods]
    helps = {helped for _, helped in parts}
    by_gradient = helps - {Help.NONE} or any(search == MULTISTART for search, _ in parts)
    imports = ", ".join(
        f"{one.label} on {arena.problem} ({counted(len(one.runs), 'run')}, evaluations "
        f"{evaluations_words(one)})"
        for arena in arenas
        for one in arena.imports
    )
    sentences = [
        # some labels have a comma
        f"{'; '.join(map(label_of, methods))}: {counted(len(arenas), 'problem')}, seeds {seeds[0]} "
        f"to {seeds[-1]}, {' or '.join(map(str, budgets))} evaluations a run, {_MEASURED}",
        _GRADIENT if by_gradient else "",
        _POLISH if Help.POLISH in helps else "",
        _SEEDS if Help.SEEDS in helps else "",
        "" if why_none(arenas) else _TESTS,
        f"Results from elsewhere: {imports}. {_IMPORTS}" if imports else "",
        f"Computed with {', '.join(versions_of(run.front for run in runs))}.",
    ]
    return " ".join(filter(None, sentences))


def settings_lines(arenas: Sequence[Arena]) -> list[str]:
    """The settings of every method, as its runs state them."""
    lines = list[str]()
    for method in filter(is_own, methods_in(arenas)):
        fields = [field for arena in arenas for field in arena.own if field.method == method]
        fronts = [field.runs[0].front for field in fields]
        bounds = dict.fromkeys(f"{front.settings['bound']:g}" for front in fronts)
        settings = {**fronts[0].settings, "bound": " or ".join(bounds)}
        stated = ", ".join(f"{name} {value}" for name, value in settings.items())
        lines.append(f"{label_of(method)}: {stated}.")
    return [*lines, *(f"{claim}." for claim in wrong_claims(arenas))]
