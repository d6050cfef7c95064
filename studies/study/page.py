"""What a study writes: its fronts, and its page of findings and a section for each task."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from quietarm.metaheuristics import PRESETS
from quietarm.ocp import Front
from quietarm.ocp.base.files import write_whole
from quietarm.ocp.front.points import LEVELS
from quietarm.studies.comparison.tables import how_to_read, tables, units
from quietarm.studies.display.saving import File, inside
from quietarm.studies.display.words import counted, millimetres, title_of
from quietarm.studies.figures.comparison import BANDS, PANELS, panel_figure
from quietarm.studies.registry.methods import PAPERS, Method
from quietarm.studies.report.document import (
    Block,
    Bullets,
    Contents,
    Document,
    Grid,
    Picture,
    Section,
    Text,
)
from quietarm.studies.report.page import page
from quietarm.studies.study.findings import STILL_LEVEL, case_findings, findings
from quietarm.studies.study.overview import gap_figure, overview_table
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
    if len(study.cases) == 1:
        title = "Residual vibration against energy: every method on one task"
        return Document(title, [_section(study.cases[0]), _reading(study)])
    title = f"Residual vibration against energy: every method on {len(study.cases)} tasks"
    blocks = [
        Bullets(findings(study), card=True),
        *_overview(study),
        Contents([title_of(found.case.task) for found in study.cases]),
        *map(_section, study.cases),
        _reading(study),
    ]
    return Document(title, blocks)


def _overview(study: Study) -> list[Block]:
    level = millimetres(study.cases[0].comparison.levels[STILL_LEVEL])
    words = (
        f"Energy above the best of all fronts at {level}, motions between points counted: one row "
        "for each task, one mark for each method. Bars: quartiles over the seeds."
    )
    overview = Picture("overview.png", partial(gap_figure, study), words, narrow=True)
    return [overview, overview_table(study)]


def _section(found: CaseStudy) -> Section:
    title = title_of(found.case.task)
    pictures = [
        Picture(
            f"{panel}.png",
            partial(panel_figure, found.comparison, panel, found.paper),
            _CAPTIONS[panel],
            _ALTERNATIVES[panel].format(title),
        )
        for panel in PANELS
    ]
    shown = tables(found.comparison)
    return Section(
        title,
        [
            Bullets(case_findings(found), card=True),
            Grid(pictures),
            *(shown[table] for table in ("energies", "fronts", "coverage")),
            Text(" ".join(units(found.comparison)), soft=True),
        ],
    )


def _reading(study: Study) -> Section:
    settings = study.settings
    fronts = [run.front for found in study.cases for run in found.comparison.runs]
    asked = (
        f"Fronts of {settings.points} points by gradient, {settings.runs} seeds from "
        f"{settings.seed}, polynomials of {settings.terms} terms; {study.seconds:.0f} s in all. "
        f"Computed with {_versions(fronts)}."
    )
    return Section(
        "Methods, and how to read it",
        [
            Bullets(method_lines(settings)),
            Bullets(how_to_read(study.cases[0].comparison)),
            Text(asked, soft=True),
        ],
    )


def _versions(fronts: Sequence[Front]) -> str:
    """What the fronts were computed with: every version, as a front from a file may have others."""
    versions: dict[str, dict[str, None]] = {}
    for front in fronts:
        for name, version in front.versions.items():
            versions.setdefault(name, {})[version] = None
    return ", ".join(f"{name} {' and '.join(several)}" for name, several in versions.items())


def method_lines(settings: StudySettings) -> list[str]:
    """What the methods are, and the settings that they ran with."""
    levels = ", ".join(millimetres(level) for level in LEVELS)
    of_seeds = f"from {counted(settings.runs, 'seed')}"
    searches = [_search_line(method, settings, of_seeds) for method in settings.searches]
    return [
        "epsilon constraint: the least energy at each of a series of residual limits, "
        f"{levels} among them, by the gradient.",
        "weighted sum: the least weighted sum of residual and energy, by the gradient, for a "
        "series of weights.",
        *searches,
        "polished: each point of the first seed's front improved by the gradient at its own "
        "residual.",
        "floor: the least energy of any joint motion at all that arrives at rest, on a grid "
        "refined until its energy no longer changes.",
    ]


def _search_line(method: Method, settings: StudySettings, of_seeds: str) -> str:
    preset = PRESETS[method.name]
    used = (
        settings.population or preset.population, settings.generations or preset.generations,
    )  # fmt: skip
    given = settings.settings.get(method.name, {})
    others = "".join(f", {name} {value}" for name, value in given.items())
    asked = f"with a population of {used[0]} and {counted(used[1], 'generation')}{others}"
    if method not in PAPERS:
        return f"{method.label} ({preset.source}): {of_seeds}, {asked}."
    papers = (preset.population, preset.generations)
    beside = (
        "as in the paper"
        if used == papers and not given
        else "where the paper has {} and {}".format(*papers)
    )
    return f"{method.label}: the paper's search, {of_seeds}, {asked}, {beside}."


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
