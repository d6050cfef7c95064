"""The contest as one page of HTML that stands alone."""

from __future__ import annotations

from collections.abc import Sequence

from studies.contest.figures import anytime_figure, looks_of
from studies.contest.measures import Arena, methods_in
from studies.contest.tables import label_of, summary_table
from studies.display.html_page import Markup, bullets, element, page, picture, table_element
from studies.display.words import counted, title_of


def contest_page(arenas: Sequence[Arena]) -> str:
    """The contest as a page.

    Parameters
    ----------
    arenas : sequence of Arena
        The problems with their runs.

    Returns
    -------
    str
        HTML with its style and pictures inside; it loads nothing and runs nothing.
    """
    methods = methods_in(arenas)
    title = f"{counted(len(methods), 'method')} against the exact front"
    sections = [_section(arena, methods) for arena in arenas]
    return page(title, element("h1", title), *sections, _methods(arenas))


def _section(arena: Arena, methods: Sequence[str]) -> Markup:
    title = title_of(arena.yardstick.front.task)
    words = (
        "Share of the exact front's hypervolume that is missing, over evaluations and over time: "
        "medians over the seeds in bands of the quartiles; dotted the targets of 1 % and 0.1 %."
    )
    return element(
        "section",
        element("h2", arena.problem),
        element("p", title, class_="soft"),
        picture(anytime_figure(arena, looks_of(methods)), f"{words} On {title}.", words),
        table_element(summary_table(arena)),
        id=arena.problem,
    )


def _methods(arenas: Sequence[Arena]) -> Markup:
    return element("section", element("h2", "Methods"), element("p", methods_paragraph(arenas)),
                   bullets(settings_lines(arenas)))  # fmt: skip


def methods_paragraph(arenas: Sequence[Arena]) -> str:
    """How the contest was held, ready for a paper."""
    runs = [run for arena in arenas for field in arena.fields for run in field.runs]
    seeds = sorted({run.key.seed for run in runs})
    budgets = sorted({run.budget for run in runs})
    versions = {name: version for run in runs for name, version in run.front.versions.items()}
    names = ", ".join(label_of(method) for method in methods_in(arenas))
    return (
        f"{names}: {counted(len(arenas), 'problem')}, seeds {seeds[0]} to {seeds[-1]}, "
        f"{' or '.join(map(str, budgets))} evaluations a run, the last generation cut short where "
        "the budget does not suffice for it. Every feasible candidate that no other dominates is "
        "kept, whatever the method itself keeps. Hypervolumes are measured from a tenth beyond the "
        "worst of the exact front in each objective, both scaled to its extent; that of the exact "
        "front counts the motions between its points. Time is processor time of the search, "
        "without that of the record. Computed with "
        f"{', '.join(f'{name} {version}' for name, version in versions.items())}."
    )


def settings_lines(arenas: Sequence[Arena]) -> list[str]:
    """The settings of every method, as its runs state them."""
    lines = list[str]()
    for method in methods_in(arenas):
        fields = [field for arena in arenas for field in arena.fields if field.method == method]
        settings = {**fields[0].runs[0].front.settings}
        bounds = {field.runs[0].front.settings.get("bound") for field in fields}
        settings["bound"] = " or ".join(f"{b:g}" for b in bounds if isinstance(b, float | int))
        stated = ", ".join(f"{name} {value}" for name, value in settings.items())
        lines.append(f"{label_of(method)}: {stated}.")
    return lines
