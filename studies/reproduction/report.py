"""What `quietarm reproduce` shows and writes: tables, systems, the floor, claims, figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import isfinite

from matplotlib.figure import Figure
from quietarm.ocp import Plan
from quietarm.studies.display.words import title_of
from quietarm.studies.figures import BLUE, GREEN, PAPER_PANELS, RED, Line, motion_figure
from quietarm.studies.figures.looks import ORANGE
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.printed import ARM_HALF, EARLIER, SINGLE_LINK_SIXTH
from quietarm.studies.report.document import Document, Picture, Section, Text, Verdict
from quietarm.studies.report.table import Cell, Column, Table
from quietarm.studies.reproduction.claims import Claim
from quietarm.studies.reproduction.floor_dots import floor_dots
from quietarm.studies.reproduction.floor_table import LEGEND as FLOOR_LEGEND
from quietarm.studies.reproduction.floor_table import finding, floor_table, floor_tables
from quietarm.studies.reproduction.recompute import Reproduction, RowResult
from quietarm.studies.reproduction.side_by_side.picture import systems_figure
from quietarm.studies.reproduction.side_by_side.table import all_systems, systems_blocks

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


_FIGURES = (
    (2, redrawn, SINGLE_LINK_SIXTH),
    (3, against_earlier, SINGLE_LINK_SIXTH),
    (5, redrawn, ARM_HALF),
    (6, against_earlier, ARM_HALF),
)


def reproduction_document(result: Reproduction, verdicts: Sequence[Claim]) -> Document:
    """The paper's tables and figures, all systems side by side, the floor, both solvers, claims."""
    paper_tables = tables(result)
    figures = [
        Picture(
            f"figure_{number}.png",
            partial(draw, result, case, f"Fig. {number} redrawn: {title_of(case.task)}"),
            f"Fig. {number}",
        )
        for number, draw, case in _FIGURES
    ]
    side_by_side = Picture("systems.png", partial(systems_figure, result.systems), "Side by side")
    multiples = Picture("floor.png", partial(floor_dots, result), "Multiples of the floor")
    return Document(
        "The paper, recomputed",
        [
            *paper_tables,
            Text(LEGEND, soft=True),
            Section("Side by side", [side_by_side, *systems_blocks(result.systems)]),
            Section(
                "How far from the floor",
                [
                    Text(finding(result)),
                    *floor_tables(result),
                    Text(FLOOR_LEGEND, soft=True),
                    multiples,
                    checks_table(result),
                    Text(CHECKS, soft=True),
                ],
            ),
            Section(
                "What the paper claims",
                [Verdict(one.text, one.verdict, one.holds, one.evidence) for one in verdicts],
            ),
            Section("Figures", figures, screen=False),
        ],
        {
            **{f"table_{n}": table for n, table in zip(_TITLES, paper_tables, strict=True)},
            "systems": all_systems(result.systems),
            "floor": floor_table(result),
        },
    )
