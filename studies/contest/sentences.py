"""What a contest found, how it was held and what it used, in sentences and references."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from importlib.resources import files
from importlib.util import find_spec

import numpy as np
from quietarm.metaheuristics.budget.run import MULTISTART, Help, parts_of
from quietarm.metaheuristics.problems.certificate import checksum
from quietarm.studies.compare.staircase import objectives
from quietarm.studies.contest.landscape import CANDIDATES, LEVEL, Landscape
from quietarm.studies.contest.measures import Arena, Field, methods_in
from quietarm.studies.contest.names import is_own, label_of, method_in
from quietarm.studies.contest.statistics import (
    ALPHA,
    Ranking,
    nearest,
    ranking_on,
    ranking_over,
    why_none,
)
from quietarm.studies.contest.tables import evaluations_words
from quietarm.studies.display.words import counted, versions_of
from quietarm.studies.document.prose import told

_ALWAYS = (
    "quietarm", "abe2016", "casadi", "ipopt", "pymoo", "moocore", "numpy", "coco", "attainment",
)  # fmt: skip
_OF_PAIRS = ("scipy", "mannwhitney", "holm", "varghadelaney")


def bibtex(arenas: Sequence[Arena]) -> str:
    """References to the methods, the software and the statistics of a contest."""
    from quietarm.metaheuristics import PRESETS

    entries, methods, tested = _entries(), methods_in(arenas), _tests(arenas)
    searches = dict.fromkeys(parts_of(method_in(method))[0] for method in methods if is_own(method))
    elsewhere = [method for method in methods if not is_own(method)]
    keys = [*_ALWAYS, *(_OF_PAIRS if tested["pairs"] else ())]
    keys += ["kruskalwallis"] * tested["within"] + ["friedman", "demsar"] * tested["over"]
    unknown = [one for one in searches if one not in entries and one != MULTISTART]
    keys += [one for one in searches if one in entries]
    comments = [f"% {one}: see {PRESETS[one].source}" for one in unknown]
    comments += [f"% {one}: results from elsewhere" for one in elsewhere]
    return "\n\n".join([*(entries[key] for key in keys), *comments]) + "\n"


def _entries() -> dict[str, str]:
    text = (files("quietarm.studies.contest") / "references.bib").read_text(encoding="utf-8")
    entries = text.replace("VERSION", version("quietarm")).strip().split("\n\n")
    return {entry.partition("{")[2].partition(",")[0]: entry for entry in entries}


_EXACT = "the exact front's"


def findings(arenas: Sequence[Arena], notes: Sequence[str] = ()) -> list[str]:
    """What is to be read first."""
    lines = [f"{arena.problem}: {_headline(arena)}." for arena in arenas]
    none = why_none(arenas)
    lines += [f"{none}."] if none else []
    for arena in arenas:
        lines += [f"{arena.problem}: {line}." for line in _unequal(arena)]
    return [*lines, *not_alike(arenas), *(f"{note}." for note in notes)]


def _headline(arena: Arena) -> str:
    """Who ends nearest to the exact front: a winner only where the tests name one."""
    missing, among = _missing_words(arena.best, "its"), ""
    if len(arena.alike) < len(arena.fields):
        among = f"of the methods with {_evaluations_compared(arena)} evaluations "
    if why_none([arena]):
        return (
            f"{among}{arena.best.label} ends nearest to the exact front, untested, with {missing}"
        )
    best, *alike = nearest(arena)
    if not alike:
        return f"{among}{best.label} ends nearest to the exact front, with {missing}"
    stated = ", ".join(f"{one.label} ({100 * one.middle:.3g} %)" for one in (best, *alike))
    return (
        f"no winner: {among}the tests do not tell apart those that end nearest to the exact front "
        f"(hypervolume missing in their middle runs: {stated})"
    )


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
        f"{_evaluations_compared(arena)}."
        for arena in arenas
        for one in arena.fields
        if one not in arena.alike
    ]


def _evaluations_compared(arena: Arena) -> str:
    return " or ".join(sorted({evaluations_words(field) for field in arena.alike}))


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
    pairs = "pairs are told apart by the Mann-Whitney test after Holm"
    if found.critical is not None:
        pairs = f"Nemenyi's critical difference is {found.critical:.2f}"
    says = "the methods differ" if found.differ else "no difference is shown"
    return (
        f"{found.test}: chi2 = {found.statistic:.3g}, p = {found.p_value:.2g}, {says} at "
        f"{100 * ALPHA:g} %; {pairs}."
    )


def explanation(found: Landscape) -> list[str]:
    """What makes a problem hard, in sentences."""
    figures = {"found": found, "level": LEVEL, "candidates": CANDIDATES}
    return told("contest/landscape.txt", **figures)


def methods_paragraph(arenas: Sequence[Arena]) -> str:
    """How the contest was held, ready for a paper."""
    runs = [run for arena in arenas for field in arena.fields if field.here for run in field.runs]
    methods = [method for method in methods_in(arenas) if is_own(method)]
    parts = [parts_of(method_in(method)) for method in methods]
    elsewhere = [
        f"{one.label} on {arena.problem} ({counted(len(one.runs), 'run')}, evaluations "
        f"{evaluations_words(one)})"
        for own in (True, False)
        for arena in arenas
        for one in arena.fields
        if not one.here and one.own is own
    ]
    exact = [arena.yardstick.scale.scaled(objectives(arena.yardstick.front)) for arena in arenas]
    (paragraph,) = told(
        "contest/methods.txt",
        points=min(map(len, exact)),
        step=100 * max(float(-np.diff(front[:, 1]).min()) for front in exact),
        methods="; ".join(map(label_of, methods)),  # some have a comma
        problems=counted(len(arenas), "problem"),
        first=min(run.front.seed or 0 for run in runs),
        last=max(run.front.seed or 0 for run in runs),
        budgets=" or ".join(map(str, sorted({run.evaluations or 0 for run in runs}))),
        gradient=any(helped is not Help.NONE or search == MULTISTART for search, helped in parts),
        helps={helped.value for _, helped in parts},
        alpha=f"{100 * ALPHA:g}",
        tested=_tests(arenas),
        even=any(len(field.runs) % 2 == 0 for arena in arenas for field in arena.fields),
        elsewhere=", ".join(elsewhere),
        imports=any(arena.imports for arena in arenas),
        versions=", ".join(
            [
                *versions_of(run.front for run in runs),
                *(f"{name} {version(name)}" for name in ("moocore", "scipy") if find_spec(name)),
            ]
        ),
    )
    return paragraph


def _tests(arenas: Sequence[Arena]) -> dict[str, bool]:
    """Which tests were held: of pairs, of all methods on a problem, over the problems."""
    held = not why_none(arenas)
    return {
        "pairs": held,
        "within": held and any(ranking_on(arena) for arena in arenas),
        "over": held and ranking_over(arenas) is not None,
    }


def settings_lines(arenas: Sequence[Arena]) -> list[str]:
    """The exact fronts and the settings of every method, as its runs state them."""
    fronts = [(arena.problem, arena.yardstick.front) for arena in arenas]
    lines = [
        f"Exact front of {problem}: {len(front.points)} points, SHA-256 {checksum(front)}."
        for problem, front in fronts
    ]
    for method in filter(is_own, methods_in(arenas)):
        fields = [field for arena in arenas for field in arena.own if field.method == method]
        fronts = [field.runs[0].front for field in fields]
        bounds = dict.fromkeys(f"{front.settings['bound']:g}" for front in fronts)
        settings = {**fronts[0].settings, "bound": " or ".join(bounds)}
        stated = ", ".join(f"{name} {value}" for name, value in settings.items())
        lines.append(f"{label_of(method)}: {stated}.")
    return [*lines, *(f"{claim}." for claim in wrong_claims(arenas))]
