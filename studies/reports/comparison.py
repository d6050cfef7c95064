"""What `quietarm compare` shows and writes: tables, their meaning, a picture."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from quietarm.ocp import QuietarmError
from quietarm.ocp.floor.search import energy_floor
from quietarm.studies import figures
from quietarm.studies.comparison.measures import Comparison
from quietarm.studies.comparison.tables import how_to_read, runs_table, summary, tables, units
from quietarm.studies.display.words import title_of
from quietarm.studies.document.blocks import Bullets, Document, Picture, Section
from quietarm.studies.paper import paper_points
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def with_floor(comparison: Comparison, console: Console) -> Comparison:
    """The comparison with the floor of its task, of an uncertain plant that of the assumed one.

    The console says so if it is not found.
    """
    try:
        floor = energy_floor(comparison.task)
    except QuietarmError as error:
        console.print(f"no floor: {error}", highlight=False, soft_wrap=True)
        return comparison
    return replace(comparison, floor=floor.energy)


def comparison_document(comparison: Comparison) -> Document:
    """A row a method, tables, how to read them, the picture; every run with all of its figures."""
    shown = tables(comparison)
    lines = [*how_to_read(comparison), *units(comparison)]
    terms = {run.front.profile.size for run in comparison.runs}

    def picture() -> Figure:
        return figures.comparison_figure(comparison, paper_points(comparison.task, terms))

    return Document(
        f"Fronts compared: {title_of(comparison.task)}",
        [
            summary(comparison),
            *shown.values(),
            Section("How to read it", [Bullets(lines, soft=True)]),
            Picture("fronts.png", picture, "Fronts"),
        ],
        {"runs": runs_table(comparison), "coverage": shown["coverage"].turned()},
    )
