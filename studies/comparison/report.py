"""What `quietarm compare` shows and writes: tables, their meaning, a picture."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from rich.console import Console

from ocp import Front, QuietarmError
from ocp.base.files import check_writable, write_whole
from ocp.floor.search import energy_floor
from studies.comparison.measures import Comparison
from studies.comparison.tables import how_to_read, runs_table, tables, units
from studies.display.tables import print_table
from studies.paper.points import paper_points
from studies.paper.tasks import title_of

FILES = ("report.md", "runs.csv", "coverage.csv", "fronts.png")
"""What `write_comparison` writes to a folder."""


def load_fronts(paths: list[Path]) -> tuple[list[Front], list[str]]:
    """The fronts of files and what to call them; FileFormatError where one is no front."""
    fronts = [Front.load(path) for path in paths]
    return fronts, [str(path) for path in paths]


def with_floor(comparison: Comparison, console: Console) -> Comparison:
    """The comparison with the floor of its task; the console says so if it is not found."""
    try:
        floor = energy_floor(comparison.task)
    except QuietarmError as error:
        console.print(f"no floor: {error}", highlight=False, soft_wrap=True)
        return comparison
    return replace(comparison, floor=floor.energy)


def terms_of(comparison: Comparison) -> set[int]:
    """Numbers of coefficients that the fronts have."""
    return {run.front.profile.size for run in comparison.runs}


def print_comparison(console: Console, comparison: Comparison) -> None:
    """Print the tables and how to read them."""
    console.print(title_of(comparison.task), style="bold", highlight=False)
    for table in tables(comparison).values():
        print_table(console, table)
    for line in (*how_to_read(comparison), *units(comparison)):
        console.print(f"- {line}", highlight=False, style="dim")


def write_comparison(folder: Path, comparison: Comparison) -> list[Path]:
    """Write `FILES` to a folder, each whole or not at all; return what was written."""
    from studies.comparison.figure import comparison_figure
    from studies.display.pictures import save_figure

    paths = [check_writable(folder / name) for name in FILES]
    report, runs, coverage, picture = paths
    shown = tables(comparison)
    title = title_of(comparison.task)
    paper = paper_points(comparison.task, terms_of(comparison))
    lines = (*how_to_read(comparison), *units(comparison))
    parts = [f"# Fronts compared: {title}\n", *(table.markdown() for table in shown.values())]
    parts += ["**How to read it**\n", *(f"- {line}" for line in lines)]
    save_figure(comparison_figure(comparison, paper, title), picture)
    write_whole(runs, runs_table(comparison).csv())
    write_whole(coverage, shown["coverage"].csv())
    write_whole(report, "\n".join([*parts, f"\n![Fronts]({picture.name})\n"]))
    return paths
