"""What `quietarm reproduce` shows and writes: tables, systems, the floor, claims, figures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import isfinite
from pathlib import Path

from matplotlib.figure import Figure
from quietarm.ocp import Plan
from quietarm.ocp.base.files import write_whole
from quietarm.studies.display.saving import File, drawing, inside
from quietarm.studies.display.words import title_of
from quietarm.studies.figures import BLUE, GREEN, PAPER_PANELS, RED, Line, motion_figure
from quietarm.studies.figures.looks import ORANGE
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.printed import ARM_HALF, EARLIER, SINGLE_LINK_SIXTH
from quietarm.studies.report.markdown import table_in_markdown
from quietarm.studies.report.table import Cell, Column, Table
from quietarm.studies.report.terminal import show_table
from quietarm.studies.reproduction.claims import Claim
from quietarm.studies.reproduction.floor_dots import floor_dots
from quietarm.studies.reproduction.floor_table import LEGEND as FLOOR_LEGEND
from quietarm.studies.reproduction.floor_table import finding, floor_table, floor_tables
from quietarm.studies.reproduction.recompute import Reproduction, RowResult
from quietarm.studies.reproduction.side_by_side.picture import systems_figure
from quietarm.studies.reproduction.side_by_side.table import (
    all_systems,
    print_systems,
    systems_in_markdown,
)
from rich.console import Console
from rich.padding import Padding
from rich.text import Text

_MILLIMETRES = "{:.3g}".format
_SECONDS = "{:.2f}".format
_ENERGY = "{:.4g}".format
_COLUMNS = (
    Column("move", key="move"),
    Column("terms N", key="terms"),
    Column("F2 [J] earlier study", _ENERGY, "earlier_study_J"),
    Column("F2 [J] {earlier} by gradient", _ENERGY, "earlier_study_as_read_here_J"),
    Column("  residual [mm]", _MILLIMETRES, "earlier_study_as_read_here_residual_mm"),
    Column("  time [s]", _SECONDS, "earlier_study_as_read_here_s"),
    Column("F2 [J] printed", _ENERGY, "printed_J"),
    Column("F2 [J] printed coefficients", _ENERGY, "printed_coefficients_J"),
    Column("  residual [mm]", _MILLIMETRES, "printed_coefficients_residual_mm"),
    Column("F2 [J] gradient, in the box", _ENERGY, "gradient_in_box_J"),
    Column("  residual [mm]", _MILLIMETRES, "gradient_in_box_residual_mm"),
    Column("  time [s]", _SECONDS, "gradient_in_box_s"),
    Column("F2 [J] gradient, no box", _ENERGY, "gradient_no_box_J"),
    Column("  residual [mm]", _MILLIMETRES, "gradient_no_box_residual_mm"),
    Column("  time [s]", _SECONDS, "gradient_no_box_s"),
    Column("F2 [J] {method}, in the box", _ENERGY, "{method}_in_box_J"),
    Column("  quartiles over seeds", key="{method}_quartiles_J"),
    Column("  residual limit [mm]", _MILLIMETRES, "{method}_residual_limit_mm"),
    Column("  time of a run [s]", _SECONDS, "{method}_run_s"),
)
_TITLES = {
    2: "Table 2: number of terms, single-link manipulator",
    3: "Table 3: against ref. [23], single-link manipulator",
    5: "Table 5: number of terms, arm on a flexible link",
    6: "Table 6: against ref. [24], arm on a flexible link",
}
_STYLES = {2: (GREEN, "-."), 4: (RED, "--"), 6: (BLUE, "-")}  # hues of the paper's Figs 2 and 5
LEGEND = (
    "Printed: as in the paper; printed coefficients: the same recomputed here. Gradient: the least "
    "energy at rest on arrival, within the paper's bound on the coefficients or without one; "
    "arriving at rest may cost a little more than the paper's small residual does. VEPSO, NSGA-II: "
    "the cheapest point of a front found with the paper's settings whose residual is no larger "
    "than that of the paper's own coefficients (where none are printed, of its N = 6 row for the "
    "same plant). Energies F2 and residuals F1 (at the tip) of coefficients and gradient are by "
    "CVODES. Network, Gaussians: what refs [23] and [24] move the joint with, as this project "
    "reads these references, with 16 parameters; the least energy at rest on arrival, in this "
    "project's box. They are no recomputation of the references' own figures, whose parameters are "
    "not published."
)


CHECKS = (
    "Both ends and five points between them of the front by sequential quadratic programs, solved "
    "again by IPOPT from the plain cycloid: by which share the energies differ at most."
)


def tables(result: Reproduction) -> list[Table]:
    """The paper's Tables 2, 3, 5 and 6 with the recomputed figures beside the printed ones."""
    found: list[Table] = []
    for number, title in _TITLES.items():
        chosen = [row for row in result.rows if row.row.table == number]
        method = chosen[0].own_search.label
        reference, name = EARLIER[chosen[0].row.condition.task.plant.name]
        earlier = f"{name}, ref. [{reference}] as read here,"
        columns = [
            replace(
                c,
                heading=c.heading.format(method=method, earlier=earlier),
                key=c.key.format(method=method),
            )
            for c in _COLUMNS
        ]
        found.append(Table(title, columns, [cells for r in chosen for cells in _with_mended(r)]))
    return found


def _with_mended(result: RowResult) -> list[list[Cell]]:
    row = result.row
    gradient = [*_figures(result.in_box, timed=True), *_figures(result.free, timed=True)]
    spread = result.searched_by(result.own_search)
    several = len(result.fronts[result.own_search]) > 1
    searched: list[Cell] = [
        spread.median if isfinite(spread.median) else "none",
        f"{spread.lower:.4f}-{spread.upper:.4f}" if several else None,
        result.residual_level * 1e3,
        result.search_seconds,
    ]
    earlier = _figures(result.earlier, timed=True)
    head: list[Cell] = [row.condition.label, str(row.terms), row.earlier_energy, *earlier]
    head.append(row.energy)
    lines = [[*head, *_figures(result.printed), *gradient, *searched]]
    if result.mended:
        head[1] = f"{row.terms}, a_5 mended"
        nothing: list[Cell] = [None] * len([*gradient, *searched])
        lines.append([*head, *_figures(result.mended), *nothing])
    return lines


def _figures(plan: Plan | None, timed: bool = False) -> list[Cell]:
    if plan is None:
        return [None] * (3 if timed else 2)
    figures: list[Cell] = [plan.energy, plan.residual * 1e3]
    return [*figures, plan.provenance.seconds] if timed else figures


def checks_table(result: Reproduction) -> Table:
    """How far the two solvers of the gradient differ along the exact fronts."""
    columns = [
        Column("move", key="move"),
        Column("points", key="points"),
        Column("largest difference", "{:.0e}".format, "largest_difference"),
    ]
    rows: list[list[Cell]] = [
        [case.name, str(len(check.points)), check.largest] for case, check in result.checks.items()
    ]
    return Table("Exact fronts by both solvers", columns, rows)


def redrawn(result: Reproduction, condition: Case, title: str) -> Figure:
    """Fig. 2 or Fig. 5 from the printed coefficients, with the gradient's N = 6 over it."""
    lines = [Line(result.cycloids[condition], "cycloid", "black")]
    for terms, (colour, style) in _STYLES.items():
        row = result.result(condition, terms)
        plan = row.mended_or_printed
        if plan is not None:
            mended = ", a_5 mended" if row.mended else ""
            lines.append(Line(plan, f"paper, N = {terms}{mended}", colour, style))
    gradient = result.more_terms[condition, 6, True]
    lines.append(Line(gradient, "gradient, N = 6, same box", ORANGE, (0, (7, 2))))
    return motion_figure(lines, title, PAPER_PANELS)


def against_earlier(result: Reproduction, condition: Case, title: str) -> Figure:
    """Fig. 3 or Fig. 6: the paper's coefficients over the earlier study's profile as read here."""
    reference, name = EARLIER[condition.task.plant.name]
    row = next(r for r in result.rows if r.row.condition == condition and r.earlier)
    lines: list[Line] = []
    if row.earlier is not None:
        label = f"{name}, ref. [{reference}] as read here, by gradient"
        lines.append(Line(row.earlier, label, ORANGE))
    if row.mended_or_printed is not None:
        mended = ", a_5 mended" if row.mended else ""
        lines.append(Line(row.mended_or_printed, f"paper, N = {row.row.terms}{mended}", BLUE))
    lines.append(Line(row.in_box, "gradient, N = 6, the paper's box", GREEN, (0, (7, 2))))
    return motion_figure(lines, title, PAPER_PANELS)


def print_reproduction(console: Console, result: Reproduction, verdicts: Sequence[Claim]) -> None:
    """Print the tables and the claims."""
    for table in tables(result):
        show_table(console, table)
    console.print(LEGEND, highlight=False, style="dim")
    print_systems(console, result.systems)
    for table in floor_tables(result):
        show_table(console, table)
    console.print(FLOOR_LEGEND, highlight=False, style="dim")
    console.print(f"\n{finding(result)}", highlight=False)
    show_table(console, checks_table(result))
    console.print(CHECKS, highlight=False, style="dim")
    console.print("\nWhat the paper claims", style="bold")
    for claim in verdicts:
        style = "green" if claim.holds else "red"
        console.print(Text.assemble((claim.verdict, f"bold {style}"), f"  {claim.text}"))
        for line in claim.evidence:
            console.print(Padding(Text(line), (0, 0, 0, 11 if console.width >= 60 else 2)))


_FIGURES = (
    (2, redrawn, SINGLE_LINK_SIXTH),
    (3, against_earlier, SINGLE_LINK_SIXTH),
    (5, redrawn, ARM_HALF),
    (6, against_earlier, ARM_HALF),
)


def reproduction_files(folder: Path, result: Reproduction, verdicts: Sequence[Claim]) -> list[File]:
    """What writes report.md, a CSV for every table, and the pictures to a folder."""
    writes: dict[str, Callable[[Path], object]] = {}
    for number, draw, condition in _FIGURES:
        title = f"Fig. {number} redrawn: {title_of(condition.task)}"
        writes[f"figure_{number}.png"] = drawing(partial(draw, result, condition, title))
    paper_tables = tables(result)
    for number, table in zip(_TITLES, paper_tables, strict=True):
        writes[f"table_{number}.csv"] = table.save_csv
    writes["systems.png"] = drawing(partial(systems_figure, result.systems))
    writes["systems.csv"] = all_systems(result.systems).save_csv
    writes["floor.png"] = drawing(partial(floor_dots, result))
    writes["floor.csv"] = floor_table(result).save_csv
    report = _markdown(result, paper_tables, verdicts)
    writes["report.md"] = lambda path: write_whole(path, report)
    return inside(folder, writes)


def _markdown(
    result: Reproduction, paper_tables: Sequence[Table], verdicts: Sequence[Claim]
) -> str:
    parts = ["# The paper, recomputed\n", LEGEND + "\n"]
    parts += [table_in_markdown(table) + "\n" for table in paper_tables]
    parts += ["## Side by side\n", "![Side by side](systems.png)\n"]
    parts += systems_in_markdown(result.systems)
    parts += ["## How far from the floor\n", finding(result) + "\n", FLOOR_LEGEND + "\n"]
    parts += [table_in_markdown(table) + "\n" for table in floor_tables(result)]
    parts.append("![Multiples of the floor](floor.png)\n")
    parts += [table_in_markdown(checks_table(result)) + "\n", CHECKS + "\n"]
    parts.append("## What the paper claims\n")
    for claim in verdicts:
        evidence = "\n".join(f"- {line}" for line in claim.evidence)
        parts.append(f"### {claim.text} **{claim.verdict.capitalize()}.**\n\n{evidence}\n")
    parts.append("## Figures\n")
    parts += [f"![Fig. {number}](figure_{number}.png)\n" for number, _, _ in _FIGURES]
    return "\n".join(parts)
