"""What a contest writes beside its runs: tables, pictures, the page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ocp.base.files import write_whole
from studies.contest.figures import anytime_figure, looks_of
from studies.contest.measures import Arena, methods_in
from studies.contest.page import contest_page
from studies.contest.tables import anytime_table, runs_table
from studies.display.saving import File, drawing, inside

PAGE = "contest.html"


def report_files(arenas: Sequence[Arena], folder: Path) -> list[File]:
    """Every table as CSV, every picture as PNG and PDF, and the page; and what writes each."""
    page: File = folder / PAGE, lambda path: write_whole(path, contest_page(arenas))
    return [page, *_tables(arenas, folder / "tables"), *_pictures(arenas, folder / "figures")]


def _tables(arenas: Sequence[Arena], folder: Path) -> list[File]:
    tables = {"runs": runs_table(arenas), "anytime": anytime_table(arenas)}
    return inside(folder, {f"{name}.csv": table.save_csv for name, table in tables.items()})


def _pictures(arenas: Sequence[Arena], folder: Path) -> list[File]:
    looks = looks_of(methods_in(arenas))
    pictures = {
        f"anytime-{arena.problem}": (lambda arena=arena: anytime_figure(arena, looks))
        for arena in arenas
    }
    return inside(folder, {
        f"{name}.{kind}": drawing(draw)
        for name, draw in pictures.items() for kind in ("png", "pdf")
    })  # fmt: skip
