"""What `quietarm compare` shows and writes: tables, their meaning, a picture."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from quietarm.ocp import QuietarmError
from quietarm.ocp.base.files import write_whole
from quietarm.ocp.floor.search import energy_floor
from quietarm.ocp.robustness.uncertain import on_assumed
from quietarm.studies.comparison.measures import Comparison
from quietarm.studies.comparison.tables import how_to_read, runs_table, tables, units
from quietarm.studies.display.saving import File, drawing, inside
from quietarm.studies.display.tables import print_table
from quietarm.studies.display.words import title_of
from quietarm.studies.paper.points import paper_points
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REPORT, PICTURE = "report.md", "fronts.png"


def with_floor(comparison: Comparison, console: Console) -> Comparison:
    """The comparison with the floor of its task, of an uncertain plant that of the assumed one.

    The console says so if it is not found.
    """
    try:
        floor = energy_floor(on_assumed(comparison.task))
    except QuietarmError as error:
        console.print(f"no floor: {error}", highlight=False, soft_wrap=True)
        return comparison
    if not floor.complete:
        raise KeyboardInterrupt
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


def comparison_files(folder: Path, comparison: Comparison) -> list[File]:
    """What writes each file of a comparison to a folder."""
    shown, title = tables(comparison), title_of(comparison.task)

    def picture() -> Figure:
        from quietarm.studies.figures import comparison_figure

        return comparison_figure(comparison, paper_points(comparison.task, terms_of(comparison)))

    def report(path: Path) -> None:
        lines = (*how_to_read(comparison), *units(comparison))
        parts = [f"# Fronts compared: {title}\n", *(table.markdown() for table in shown.values())]
        parts += ["**How to read it**\n", *(f"- {line}" for line in lines)]
        write_whole(path, "\n".join([*parts, f"\n![Fronts]({PICTURE})\n"]))

    writes = {
        REPORT: report,
        "runs.csv": runs_table(comparison).save_csv,
        "coverage.csv": shown["coverage"].turned().save_csv,
        PICTURE: drawing(picture),
    }
    return inside(folder, writes)
