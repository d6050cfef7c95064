"""What a study writes: its fronts, and its page of findings and a section for each task."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from math import nan
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from quietarm.metaheuristics import PRESETS
from quietarm.ocp.files import write_whole
from quietarm.ocp.front.points import LEVELS
from quietarm.studies.comparison.tables import how_to_read, tables, units
from quietarm.studies.display.saving import File, inside
from quietarm.studies.display.words import counted, millimetres, title_of, versions_of
from quietarm.studies.document.blocks import (
    Bullets,
    Contents,
    Document,
    Grid,
    Picture,
    Section,
    Text,
)
from quietarm.studies.document.files import page
from quietarm.studies.document.prose import told
from quietarm.studies.document.table import Line, Table, table_of
from quietarm.studies.figures.axes import legend_below, new_figure
from quietarm.studies.figures.comparison import BANDS, PANELS, looks, panel_figure
from quietarm.studies.registry.methods import PAPERS, Method
from quietarm.studies.study.findings import STILL_LEVEL, at_rest, case_findings, findings, gap
from quietarm.studies.study.work import CaseStudy, Study, StudySettings

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


def study_document(study: Study) -> Document:
    """The study: over all tasks, for each task, and how to read it."""
    count, sections = len(study.cases), [*map(_section, study.cases), _reading(study)]
    tasks = "one task" if count == 1 else f"{count} tasks"
    title = f"Residual vibration against energy: every method on {tasks}"
    if count == 1:
        return Document(title, sections)
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    words = (
        f"Energy above the best of all fronts at {level}, motions between points counted: one row "
        "for each task, one mark for each method. Bars: quartiles over the seeds."
    )
    blocks = [
        Bullets(findings(study), card=True),
        Picture("overview.png", partial(gap_figure, study), words, narrow=True),
        overview_table(study),
        Contents([title_of(found.case.task) for found in study.cases]),
        *sections,
    ]
    return Document(title, blocks)


def _section(found: CaseStudy) -> Section:
    title, shown = title_of(found.case.task), tables(found.comparison)
    pictures = [
        Picture(
            f"{panel}.png",
            partial(panel_figure, found.comparison, panel, found.paper),
            _CAPTIONS[panel],
            _ALTERNATIVES[panel].format(title),
        )
        for panel in PANELS
    ]
    blocks = [
        Bullets(case_findings(found), card=True),
        Grid(pictures),
        *(shown[table] for table in ("energies", "fronts", "coverage")),
        Text(" ".join(units(found.comparison)), soft=True),
    ]
    return Section(title, blocks)


def _reading(study: Study) -> Section:
    settings = study.settings
    fronts = [run.front for found in study.cases for run in found.comparison.runs]
    asked = (
        f"Fronts of {settings.points} points by gradient, {settings.runs} seeds from "
        f"{settings.seed}, polynomials of {settings.terms} terms; {study.seconds:.0f} s in all. "
        f"Computed with {', '.join(versions_of(fronts))}."
    )
    how = Bullets(how_to_read(study.cases[0].comparison))
    blocks = [Bullets(method_lines(settings)), how, Text(asked, soft=True)]
    return Section("Methods, and how to read it", blocks)


def method_lines(settings: StudySettings) -> list[str]:
    """What the methods are, and the settings that they ran with."""
    levels = ", ".join(millimetres(level) for level in LEVELS)
    searches = [_search_line(method, settings) for method in settings.searches]
    return told("study/methods.txt", levels=levels, searches=searches)


def _search_line(method: Method, settings: StudySettings) -> str:
    preset, given = PRESETS[method.name], settings.settings.get(method.name, {})
    papers = preset.population, preset.generations
    used = settings.population or papers[0], settings.generations or papers[1]
    asked = (
        f"from {counted(settings.runs, 'seed')}, with a population of {used[0]} and "
        f"{counted(used[1], 'generation')}"
    )
    asked += "".join(f", {name} {value}" for name, value in given.items())
    if method not in PAPERS:
        return f"{method.label} ({preset.source}): {asked}."
    as_there = "as in the paper"
    if used != papers or given:
        as_there = f"where the paper has {papers[0]} and {papers[1]}"
    return f"{method.label}: the paper's search, {asked}, {as_there}."


def page_file(study: Study, output: Path) -> File:
    """The page of a study, and what writes it."""
    return output, lambda path: write_whole(path, page(study_document(study)))


def front_files(study: Study, folder: Path) -> list[File]:
    """Every front of a study, which `quietarm compare` reads, in a folder, and what writes it."""
    writes: dict[str, Callable[[Path], object]] = {}
    for found in study.cases:
        for run in found.comparison.runs:
            seed = "" if run.front.seed is None else f"-seed{run.front.seed}"
            name = f"{title_of(found.case.task)}-{run.front.method}{seed}"
            writes[f"{_file_name(name)}.json"] = run.front.save
    return inside(folder, writes)


def _file_name(words: str) -> str:
    signed = re.sub(r"(?<!\w)-", "minus-", words)
    return re.sub(r"[^A-Za-z0-9.]+", "-", signed)


def overview_table(study: Study) -> Table:
    """Energy above the best at the residual of the summary, for each task and method."""
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    comparisons = [found.comparison for found in study.cases]
    methods = dict.fromkeys(group.method for one in comparisons for group in one.groups)
    names = [*(method.label for method in methods), f"best at {level}"]
    columns: list[Line] = [("task", "", [*names, "best at rest, times the floor"])]
    for found in study.cases:
        gaps = [100 * gap(found.comparison, method) for method in methods]
        ratio = at_rest(found) / found.floor.energy if found.floor else nan
        best = f"{found.comparison.best[STILL_LEVEL]:.4g} J"
        columns.append((title_of(found.case.task), "{:.2f}", [*gaps, best, ratio]))
    title = f"Energy above the best at {level} [%], motions between points counted"
    return table_of(title, columns)


def gap_figure(study: Study) -> Figure:
    """The energy above the best: one row for each task, one mark for each method."""
    figure = new_figure(4.8, 1.6 + 0.45 * len(study.cases))
    ax = figure.subplots()
    ax.grid(alpha=0.25)
    seen = set[Method]()
    for row, comparison in enumerate(found.comparison for found in study.cases):
        for group in comparison.groups:
            own, method = looks(comparison)[group.label], group.method
            spread = group.spread("gaps_between", STILL_LEVEL)
            if len(group.runs) > 1:
                ax.plot(
                    [100 * spread.lower, 100 * spread.upper], [row, row], color=own.colour,
                    linewidth=4, alpha=0.35, solid_capstyle="round",
                )  # fmt: skip
            ax.plot(
                100 * spread.median, row, own.mark, color=own.colour, markersize=7,
                markeredgecolor="white", label="_" if method in seen else method.label,
            )  # fmt: skip
            seen.add(method)
    titles = [title_of(found.case.task).replace(", ", "\n", 1) for found in study.cases]
    ax.set_yticks(range(len(study.cases)), titles, fontsize=8)
    ax.set_ylim(len(study.cases) - 0.5, -0.5)
    ax.set_xscale("symlog", linthresh=0.1, linscale=0.5)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.set_xlim(-0.02, None)
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    ax.set_xlabel(f"energy above the best at {level} [%]")
    legend_below(figure, [ax], 3, 8.5)
    return figure
