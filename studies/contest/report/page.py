"""The contest as one page of HTML that stands alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from metaheuristics.budget.run import MULTISTART, Help, parts_of
from studies.contest.imported import Imported
from studies.contest.landscape import CANDIDATES, LEVEL, Landscape
from studies.contest.measures import Arena, Outcome, methods_in
from studies.contest.names import is_own, label_of
from studies.contest.report.citations import bibtex
from studies.contest.report.figures import anytime_figure, attainment_figure, looks_of, ranks_figure
from studies.contest.report.tables import (
    effects_table,
    evaluations_words,
    summary_table,
    visits_table,
)
from studies.contest.statistics import ALPHA, Ranking, pairs_on, ranking_on, ranking_over, why_none
from studies.display.html_page import Markup, bullets, element, page, picture, table_element
from studies.display.words import counted, millimetres, title_of

_ANYTIME = (
    "Share of the exact front's hypervolume that is missing, over evaluations and over time: "
    "medians over the seeds in bands of the quartiles; dotted the targets of 1 % and 0.1 %."
)
_ATTAINMENT = (
    "What half of the runs of each method attain, with the exact front in black; and where more "
    "runs of the best method (blue) or of another (red) attain residual and energy."
)
_THE_EXACT = "the exact front's"
_RANKS = "Mean ranks, 1 the best; a bar joins methods that the tests do not tell apart."


def contest_page(arenas: Sequence[Arena], notes: Sequence[str] = ()) -> str:
    """The contest as a page.

    Parameters
    ----------
    arenas : sequence of Arena
        The problems with their runs.
    notes : sequence of str
        What else is to be known, in sentences without a full stop.

    Returns
    -------
    str
        HTML with its style and pictures inside; it loads nothing and runs nothing.
    """
    methods = methods_in(arenas)
    title = f"{counted(len(methods), 'method')} against the exact front"
    sections = [_section(arena, methods) for arena in arenas]
    return page(title, element("h1", title), _findings(arenas, notes), *sections, _methods(arenas))


def _findings(arenas: Sequence[Arena], notes: Sequence[str]) -> Markup:
    none, lines = why_none(arenas), list[str]()
    for arena in arenas:
        best = min(arena.alike, key=_middle)
        lines.append(
            f"{arena.problem}: {label_of(best.method)} ends nearest to the exact front, with "
            f"{_missing(best, 'its')}."
        )
    lines += [f"{none}."] if none else []
    over = None if none else ranking_over(arenas)
    stated = [*_unequal(arenas), *not_alike(arenas), *notes]
    parts = [bullets([*lines, *(line if line.endswith(".") else f"{line}." for line in stated)])]
    found = element("div", *parts, class_="findings")
    if over is None:
        return found
    words = f"{_RANKS} Over {over.blocks} problems, by medians. {_verdict(over)}"
    return element("div", found, picture(ranks_figure(over, "all problems"), words, words))


def _middle(one: Outcome) -> float:
    return sorted(one.final)[len(one.final) // 2]


def _missing(one: Outcome, whose: str) -> str:
    runs = f"the middle run of {len(one.runs)}" if len(one.runs) > 1 else "its only run"
    return f"{100 * _middle(one):.2g} % of {whose} hypervolume missing in {runs}"


def not_alike(arenas: Sequence[Arena]) -> list[str]:
    """Results from elsewhere that are shown and not compared by tests, and why, in sentences."""
    return [
        f"{arena.problem}: {label_of(one.method)} ends with {_missing(one, _THE_EXACT)}. "
        f"It does not compare: its evaluations are {evaluations_words(one)}, those of the others "
        f"{' or '.join(sorted({evaluations_words(field) for field in arena.fields}))}."
        for arena in arenas
        for one in arena.imports
        if one not in arena.alike
    ]


def _unequal(arenas: Sequence[Arena]) -> list[str]:
    """What is to be known of methods whose runs are not as many, or not as long, as others'."""
    lines = list[str]()
    for arena in arenas:
        counts = {len(field.runs) for field in arena.fields}
        if len(counts) > 1:
            stated = ", ".join(f"{label_of(f.method)} {len(f.runs)}" for f in arena.fields)
            lines.append(f"{arena.problem}: the methods have unequal numbers of runs: {stated}.")
        short = [f for f in arena.fields for run in f.runs if run.front.evaluations < run.budget]
        lines += [
            f"{arena.problem}: {label_of(field.method)} ended before its evaluations were spent."
            for field in dict.fromkeys(short)
        ]
    return lines


def _verdict(found: Ranking) -> str:
    says = "the methods differ" if found.differ else "no difference is shown"
    return (
        f"Friedman's test: chi2 = {found.statistic:.3g}, p = {found.p_value:.2g}, {says} at "
        f"{100 * ALPHA:g} %; Nemenyi's critical difference is {found.critical:.2f}."
    )


def _section(arena: Arena, methods: Sequence[str]) -> Markup:
    title, looks = title_of(arena.yardstick.front.task), looks_of(methods)
    parts = [
        element("h2", arena.problem),
        element("p", title, class_="soft"),
        picture(anytime_figure(arena, looks), f"{_ANYTIME} On {title}.", _anytime_words(arena)),
        table_element(summary_table(arena)),
        picture(attainment_figure(arena, looks), f"{_ATTAINMENT} On {title}.", _ATTAINMENT),
        *_statistics(arena),
        table_element(visits_table(arena)),
        *([bullets(explanation(arena.landscape))] if arena.landscape else []),
    ]
    return element("section", *parts, id=arena.problem)


def _anytime_words(arena: Arena) -> str:
    if not arena.imports:
        return _ANYTIME
    names = " and ".join(label_of(one.method) for one in arena.imports)
    return f"{_ANYTIME} Of {names} only the end is known, so that there are no curves."


def explanation(found: Landscape) -> list[str]:
    """What makes a problem hard, in sentences."""
    level = millimetres(LEVEL)
    lines = [
        f"Of {found.starts} random starts in the box, the gradient ended at a minimum of the "
        f"energy within {level} from {found.solved:.0%}, and at the best of these from "
        f"{found.best:.0%}; of the minima, {found.minima} differ by more than 0.1 % in energy.",
        f"Over {CANDIDATES} random candidates, energy and distance to the cheapest motion "
        f"correlate by {found.candidates:.2f} (1 where better candidates lie nearer to it).",
    ]
    if found.correlation is not None:
        lines.append(
            f"Over the minima found, energy and distance to the best one correlate by "
            f"{found.correlation:.2f}."
        )
    for share, ratio in found.boxes:
        of = f"With a box {share:g} times as large the least energy within {level} is"
        lines.append(
            f"{of} not found." if ratio is None else f"{of} {ratio:.4g} times that in this one."
        )
    return lines


def _statistics(arena: Arena) -> list[Markup]:
    none = why_none([arena])
    if none:
        return [element("p", f"{none[0].upper()}{none[1:]}.")]
    parts, found = list[Markup](), ranking_on(arena)
    if found is not None:
        words = f"{_RANKS} Over {found.blocks} seeds. {_verdict(found)}"
        parts.append(picture(ranks_figure(found, arena.problem), words, words))
    return [*parts, table_element(effects_table(arena, pairs_on(arena)))]


def _methods(arenas: Sequence[Arena]) -> Markup:
    references = bibtex(methods_in(arenas), statistics=not why_none(arenas))
    return element(
        "section",
        element("h2", "Methods"),
        element("p", methods_paragraph(arenas)),
        bullets(settings_lines(arenas)),
        element("h3", "References"),
        element("pre", references, class_="soft"),
    )


def methods_paragraph(arenas: Sequence[Arena]) -> str:
    """How the contest was held, ready for a paper."""
    runs = [run for arena in arenas for field in arena.fields for run in field.runs]
    seeds = sorted({run.key.seed for run in runs})
    budgets = sorted({run.budget for run in runs})
    versions: dict[str, set[str]] = {}
    for run in runs:
        for name, version in run.front.versions.items():
            versions.setdefault(name, set()).add(version)
    own = [method for method in methods_in(arenas) if is_own(method)]
    names = ", ".join(map(label_of, own))
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
        f"{', '.join(f'{name} {_either(known)}' for name, known in versions.items())}."
    )


def _either(versions: Iterable[str]) -> str:
    return " or ".join(sorted(versions))


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
        "others. "
    )


def _of_the_gradient(methods: Sequence[str]) -> str:
    """How the gradient's work is counted, where it has a part."""
    parts = [parts_of(method) for method in methods]
    words = list[str]()
    if any(helped is not Help.NONE or search == MULTISTART for search, helped in parts):
        words.append(
            "An iteration of IPOPT counts as the 1 + n + n (n + 1) / 2 evaluations that "
            "differences would take for its first and second derivatives of n coefficients. "
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


def wrong_claims(arenas: Sequence[Arena]) -> list[str]:
    """What files from elsewhere state otherwise than their coefficients give, in words."""
    return [
        f"{run.words}: {claim}"
        for arena in arenas
        for one in arena.imports
        for run in one.runs
        if isinstance(run, Imported)
        for claim in run.claims
    ]
