"""What a contest writes beside its runs: tables, pictures, the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from quietarm.ocp.base.files import check_inside, write_whole
from quietarm.studies.contest.measures import Arena, methods_in
from quietarm.studies.contest.report.citations import bibtex
from quietarm.studies.contest.report.figures import (
    anytime_figure,
    attainment_figure,
    looks_of,
    ranks_figure,
)
from quietarm.studies.contest.report.page import contest_document
from quietarm.studies.contest.report.tables import (
    anytime_table,
    pairs_table,
    ranks_table,
    runs_table,
)
from quietarm.studies.contest.statistics import (
    Ranking,
    pairs_on,
    ranking_on,
    ranking_over,
    why_none,
)
from quietarm.studies.display.saving import File, drawing, inside
from quietarm.studies.report.page import page

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE = "contest.html"
_REFERENCES, _TABLES, _FIGURES = "references.bib", "tables", "figures"
_OVERALL = "all problems"
_KINDS = ("png", "pdf")


def check_places(folder: Path) -> None:
    """Make sure, before the work, that a report can be written; ValueError says why not."""
    inner = [folder / name / "any" for name in (_TABLES, _FIGURES)]
    check_inside(folder, [folder / PAGE, folder / _REFERENCES, *inner])


def report_files(arenas: Sequence[Arena], folder: Path, notes: Sequence[str] = ()) -> list[File]:
    """Every table as CSV, every picture as PNG and PDF, and the page; and what writes each."""
    whole: File = (
        folder / PAGE,
        lambda path: write_whole(path, page(contest_document(arenas, notes))),
    )
    tests = not why_none(arenas)
    references = bibtex(methods_in(arenas), statistics=tests)
    return [
        whole,
        (folder / _REFERENCES, lambda path: write_whole(path, references)),
        *inside(folder / _TABLES, _tables(arenas, tests)),
        *inside(folder / _FIGURES, _pictures(arenas, tests)),
    ]


def _tables(arenas: Sequence[Arena], tests: bool) -> dict[str, Callable[[Path], object]]:
    tables = {"runs": runs_table(arenas), "anytime": anytime_table(arenas)}
    if tests:
        tables["pairs"] = pairs_table([pair for arena in arenas for pair in pairs_on(arena)])
        tables["ranks"] = ranks_table(_rankings(arenas))
    return {f"{name}.csv": table.save_csv for name, table in tables.items()}


def _rankings(arenas: Sequence[Arena]) -> list[tuple[str, Ranking]]:
    found = [*((arena.problem, ranking_on(arena)) for arena in arenas),
             (_OVERALL, ranking_over(arenas))]  # fmt: skip
    return [(where, one) for where, one in found if one is not None]


def _pictures(arenas: Sequence[Arena], tests: bool) -> dict[str, Callable[[Path], object]]:
    looks = looks_of(methods_in(arenas))
    draws: dict[str, Callable[[], Figure]] = {}
    for arena in arenas:
        draws[f"anytime-{arena.problem}"] = partial(anytime_figure, arena, looks)
        draws[f"attainment-{arena.problem}"] = partial(attainment_figure, arena, looks)
    for where, found in _rankings(arenas) if tests else ():
        draws[f"ranks-{where.replace(' ', '-')}"] = partial(ranks_figure, found, where)
    return {f"{name}.{kind}": drawing(draw) for name, draw in draws.items() for kind in _KINDS}
