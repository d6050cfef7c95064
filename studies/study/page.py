"""The study as one page of HTML: findings first, then a section for each task."""

from __future__ import annotations

from math import isfinite, nan

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from studies.comparison.figure import BANDS, PANELS, looks, panel_figure
from studies.comparison.tables import how_to_read, tables, units
from studies.display.html_page import Markup, bullets, element, joined, page, picture, table_element
from studies.display.tables import Cell, Column, Table
from studies.display.words import millimetres
from studies.methods import Method
from studies.paper.tasks import title_of
from studies.study.findings import STILL_LEVEL, at_rest, case_findings, findings, gap
from studies.study.work import CaseStudy, Study

_METHODS = (
    "epsilon constraint: the least energy at each of a series of residual limits, by IPOPT.",
    "weighted sum: the least weighted sum of residual and energy, by IPOPT, for a series of "
    "weights.",
    "NSGA-II and VEPSO: the paper's searches with the paper's settings, from several seeds.",
    "polished: each point of the first seed's front improved by IPOPT at its own residual.",
    "floor: the least energy of any joint motion at all that arrives at rest, on a grid "
    "refined until its energy no longer changes.",
)
_ALTERNATIVES = {
    "whole": "Energy against residual vibration, one staircase for each method, for {0}.",
    "still": "The nearly still end of the same fronts with a logarithmic residual, for {0}.",
    "gaps": "How far each method's energy is above the best, against residual, for {0}.",
}
_CAPTIONS = {
    "whole": f"The whole fronts; down and left is better. {BANDS}.",
    "still": "The nearly still end, where the residual is logarithmic.",
    "gaps": "How far each point is above the best of all fronts within its residual; those on the "
    "bottom line are the best.",
}


def study_page(study: Study) -> str:
    """The study as a page that stands alone.

    Parameters
    ----------
    study : Study
        What was found.

    Returns
    -------
    str
        HTML with its style and pictures inside; it loads nothing and runs nothing.
    """
    title = "Residual vibration against energy: every method on one task"
    if len(study.cases) > 1:
        title = f"Residual vibration against energy: every method on {len(study.cases)} tasks"
    parts = [element("h1", title)]
    if len(study.cases) > 1:
        parts += [_findings(findings(study)), _overview(study), _contents(study)]
    parts += [_section(found, f"task-{i}") for i, found in enumerate(study.cases, start=1)]
    return page(title, *parts, _reading(study))


def _findings(lines: list[str]) -> Markup:
    return element("div", bullets(lines), class_="findings")


def _overview(study: Study) -> Markup:
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    words = (
        f"Energy above the best of all fronts at {level}, motions between points counted: one row "
        "for each task, one mark for each method. Bars: quartiles over the seeds."
    )
    overview = picture(gap_figure(study), words, words)
    return joined(
        [element("div", overview, class_="overview"), table_element(overview_table(study))]
    )


def _contents(study: Study) -> Markup:
    links = [
        element("li", element("a", title_of(found.case.task), href=f"#task-{i}"))
        for i, found in enumerate(study.cases, start=1)
    ]
    return element("nav", element("ul", *links), **{"aria-label": "tasks"})


def _section(found: CaseStudy, name: str) -> Markup:
    title = title_of(found.case.task)
    pictures = [
        picture(
            panel_figure(found.comparison, panel, found.paper),
            _ALTERNATIVES[panel].format(title),
            _CAPTIONS[panel],
        )
        for panel in PANELS
    ]
    shown = tables(found.comparison)
    return element(
        "section",
        element("h2", title),
        _findings(case_findings(found)),
        element("div", *pictures, class_="pictures"),
        *(table_element(shown[table]) for table in ("energies", "fronts", "coverage")),
        element("p", " ".join(units(found.comparison)), class_="soft"),
        id=name,
    )


def _reading(study: Study) -> Markup:
    settings = study.settings
    fronts = [run.front for found in study.cases for run in found.comparison.runs]
    versions = {name: version for front in fronts for name, version in front.versions.items()}
    asked = (
        f"Fronts of {settings.points} points by gradient, {settings.runs} seeds from "
        f"{settings.seed}, polynomials of {settings.terms} terms; {study.seconds:.0f} s in all. "
        f"Computed with {', '.join(f'{name} {version}' for name, version in versions.items())}."
    )
    return element(
        "section",
        element("h2", "Methods, and how to read it"),
        bullets(_METHODS),
        bullets(how_to_read(study.cases[0].comparison)),
        element("p", asked, class_="soft"),
    )


def overview_table(study: Study) -> Table:
    """Energy above the best at the residual of the summary, for each task and method."""
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    columns = [
        Column("task"),
        *(Column(title_of(f.case.task), "{:.2f}".format) for f in study.cases),
    ]
    rows: list[list[Cell]] = []
    for method in _methods(study):
        shares = [100 * gap(found.comparison, method) for found in study.cases]
        rows.append([method.label, *(s if isfinite(s) else None for s in shares)])
    best = [f"{found.comparison.best[STILL_LEVEL]:.4g} J" for found in study.cases]
    floors = [found.floor.energy if found.floor else nan for found in study.cases]
    ratios = [at_rest(found) / floor for found, floor in zip(study.cases, floors, strict=True)]
    rows.append([f"best at {level}", *best])
    rows.append(["best at rest, times the floor", *(r if isfinite(r) else None for r in ratios)])
    return Table(
        f"Energy above the best at {level} [%], motions between points counted",
        columns,
        rows,
    )


def _methods(study: Study) -> list[Method]:
    """The methods of all cases, in order."""
    found = [group.method for found in study.cases for group in found.comparison.groups]
    return list(dict.fromkeys(found))


def gap_figure(study: Study) -> Figure:
    """Draw the energy above the best: one row for each task, one mark for each method."""
    figure = Figure(figsize=(4.8, 1.6 + 0.45 * len(study.cases)), layout="constrained")
    FigureCanvasAgg(figure)
    axis = figure.subplots()
    marks = dict(zip(_methods(study), "osD^vX*P<>", strict=False))
    seen: set[Method] = set()
    for i, found in enumerate(study.cases):
        for group in found.comparison.groups:
            look = looks(found.comparison)[group.label]
            spread, method = group.spread("gaps_between", STILL_LEVEL), group.method
            if len(group.runs) > 1:
                axis.plot([100 * spread.lower, 100 * spread.upper], [i, i], color=look.colour,
                          linewidth=4, alpha=0.35, solid_capstyle="round")  # fmt: skip
            label = "_" if method in seen else method.label
            seen.add(method)
            axis.plot(100 * spread.median, i, marks.get(method, "o"), color=look.colour,
                      markersize=7, markeredgecolor="white", label=label)  # fmt: skip
    titles = [title_of(found.case.task).replace(", ", "\n", 1) for found in study.cases]
    axis.set_yticks(range(len(study.cases)), titles, fontsize=8)
    axis.set_ylim(len(study.cases) - 0.5, -0.5)
    axis.set_xscale("symlog", linthresh=0.1, linscale=0.5)
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_xlim(-0.02, None)
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    axis.set_xlabel(f"energy above the best at {level} [%]")
    axis.grid(alpha=0.25)
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=8.5)
    return figure
