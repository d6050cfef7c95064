"""How a contest was held: a paragraph for a paper, and the settings of its methods."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.metaheuristics.budget.run import MULTISTART, Help, parts_of
from quietarm.studies.contest.measures import Arena, methods_in
from quietarm.studies.contest.names import is_own, label_of, method_in
from quietarm.studies.contest.report.notes import versions_of, wrong_claims
from quietarm.studies.contest.report.tables import evaluations_words
from quietarm.studies.contest.statistics import ALPHA, why_none
from quietarm.studies.display.words import counted


def methods_paragraph(arenas: Sequence[Arena]) -> str:
    """How the contest was held, ready for a paper."""
    runs = [run for arena in arenas for field in arena.fields for run in field.runs]
    seeds = sorted({run.key.seed for run in runs})
    budgets = sorted({run.budget for run in runs})
    versions = [f"{name} {' or '.join(known)}" for name, known in versions_of(runs).items()]
    own = [method for method in methods_in(arenas) if is_own(method)]
    names = "; ".join(map(label_of, own))  # some have a comma
    helped = _of_the_gradient(own)
    tests = (
        ""
        if why_none(arenas)
        else (
            f"Differences are tested at {100 * ALPHA:g} %: by Friedman's test and Nemenyi's "
            "critical difference over seeds on each problem and over the problems' medians, and in "
            "pairs by the Mann-Whitney test with Holm's correction; the effect size is Vargha and "
            "Delaney's A. "
        )
    )
    return (
        f"{names}: {counted(len(arenas), 'problem')}, seeds {seeds[0]} to {seeds[-1]}, "
        f"{' or '.join(map(str, budgets))} evaluations a run, the last generation cut short where "
        "the budget does not suffice for it. Every feasible candidate that no other dominates is "
        "kept, whatever the method itself keeps. Hypervolumes are measured from a tenth beyond the "
        "worst of the exact front in each objective, both scaled to its extent; that of the exact "
        "front counts the motions between its points. The expected running time is COCO's: the "
        "evaluations that all runs spent until they reached a target, or in all, over the number "
        f"that reached it, seen at marks 5 % apart. {helped}{tests}{_of_imports(arenas)}Time is "
        "processor "
        "time of the search, without that of the record. Computed with "
        f"{', '.join(versions)}."
    )


def _of_imports(arenas: Sequence[Arena]) -> str:
    """What was done with results from elsewhere, where there are some."""
    imports = [one for arena in arenas for one in arena.imports]
    if not imports:
        return ""
    runs = ", ".join(
        f"{label_of(one.method)} on {one.yardstick.problem} ({counted(len(one.runs), 'run')}, "
        f"evaluations {evaluations_words(one)})"
        for one in imports
    )
    return (
        f"Results from elsewhere: {runs}. Their coefficients were evaluated here by CVODES; only "
        "what a run ended with is known of them, so that they have no anytime curves, expected "
        "running times or times, and tests compare those alone whose evaluations are those of the "
        "others. Ranks over seeds are without them. "
    )


def _of_the_gradient(methods: Sequence[str]) -> str:
    """How the gradient's work is counted, where it has a part."""
    parts = [parts_of(method_in(method)) for method in methods]
    words = list[str]()
    if any(helped is not Help.NONE or search == MULTISTART for search, helped in parts):
        words.append(
            "An iteration of the gradient's solver counts as the 1 + n + n (n + 1) / 2 evaluations "
            "that differences would take for its first and second derivatives of n coefficients. "
        )
    if any(helped is Help.POLISH for _, helped in parts):
        words.append("What is polished is searched with half of the evaluations first. ")
    if any(helped is Help.SEEDS for _, helped in parts):
        words.append(
            "Gradient seeds are five motions in the first population, each solved from a random "
            "start: at rest, with any residual, and at a quarter, half and three quarters of that. "
        )
    return "".join(words)


def settings_lines(arenas: Sequence[Arena]) -> list[str]:
    """The settings of every method, as its runs state them."""
    lines = list[str]()
    for method in filter(is_own, methods_in(arenas)):
        fields = [field for arena in arenas for field in arena.fields if field.method == method]
        settings = {**fields[0].runs[0].front.settings}
        bounds = {field.runs[0].front.settings.get("bound") for field in fields}
        settings["bound"] = " or ".join(f"{b:g}" for b in bounds if isinstance(b, float | int))
        stated = ", ".join(f"{name} {value}" for name, value in settings.items())
        lines.append(f"{label_of(method)}: {stated}.")
    return [*lines, *(f"{claim}." for claim in wrong_claims(arenas))]
