"""The paper's tables with what is computed here beside them, and its experiment like for like."""

from __future__ import annotations

from math import isfinite

from quietarm.ocp import Floor, Plan
from quietarm.studies.document.table import Cell, Column, Table
from quietarm.studies.paper import CONDITIONS, EARLIER, ROWS, Case
from quietarm.studies.reproduction.recompute import Reproduction, RowResult
from quietarm.studies.reproduction.searches import (
    COMPARED_TERMS,
    STUDIED,
    Searched,
    earlier_input,
    own_search,
)

_J, _MM, _S = "{:.4g}".format, "{:.3g}".format, "{:.2f}".format
_MENDED = ", a_5 mended"
TITLES = {
    2: "Table 2: number of terms, single-link manipulator",
    3: "Table 3: against ref. [23], single-link manipulator",
    5: "Table 5: number of terms, arm on a flexible link",
    6: "Table 6: against ref. [24], arm on a flexible link",
}
COEFFICIENT_TABLES: dict[int, Case] = dict(zip((1, 4), STUDIED, strict=True))
"""The moves whose coefficients the paper prints, by the table's number."""


def paper_table(result: Reproduction, number: int) -> Table:
    """One of the paper's tables with the recomputed figures beside the printed ones.

    A misprint mended has a row of its own, which holds what it changes.
    """
    rows = [found for found in result.rows if found.row.table == number]
    name = own_search(rows[0].row.condition).label
    reference, profile = EARLIER[rows[0].row.condition.task.plant.name]
    read_here = f"{profile}, ref. [{reference}] as read here, by gradient"
    columns = [
        Column("move"),
        Column("terms N", key="terms"),
        Column("F2 [J] earlier study", _J, "earlier_study_J"),
        *_of_plan(read_here, "earlier_study_as_read_here"),
        Column("F2 [J] printed", _J, "printed_J"),
        *_of_plan("printed coefficients", "printed_coefficients")[:2],
        *_of_plan("gradient, in the box", "gradient_in_box"),
        *_of_plan("gradient, no box", "gradient_no_box"),
        *_of_seeds(f"{name}, in the box", f"{name}_in_box"),
        Column("  residual limit [mm]", _MM, f"{name}_residual_limit_mm"),
        Column("  time of a run [s]", _S, f"{name}_run_s"),
    ]
    cells = [
        _row(found, mended)
        for found in rows
        for mended in (False, True)
        if found.mended or not mended
    ]
    return Table(TITLES[number], columns, cells)


def _row(found: RowResult, mended: bool) -> list[Cell]:
    row = found.row
    search = found.searched[own_search(row.condition)]
    paper = [
        *(row.condition.label, f"{row.terms}{_MENDED * mended}", row.earlier_energy),
        *(*figures_of(found.earlier), row.energy),
        *figures_of(found.mended if mended else found.printed)[:2],
    ]
    here = [
        *(*figures_of(found.in_box), *figures_of(found.free)),
        *_seeds(search),
        search.level * 1e3,
        search.seconds,
    ]
    return [*paper, *(None if mended else cell for cell in here)]


def _of_plan(words: str, key: str) -> list[Column]:
    """Columns of a plan's `figures_of`."""
    return [
        Column(f"F2 [J] {words}", _J, f"{key}_J"),
        Column("  residual [mm]", _MM, f"{key}_residual_mm"),
        Column("  time [s]", _S, f"{key}_s"),
    ]


def figures_of(answer: Plan | Floor | None) -> list[float | None]:
    """Energy [J], residual [mm] and time [s]; empty where there is no answer."""
    if answer is None:
        return [None] * 3
    return [answer.energy, answer.residual * 1e3, answer.provenance.seconds]


def _of_seeds(words: str, key: str) -> list[Column]:
    """Columns of a search's `_seeds`."""
    return [
        Column(f"F2 [J] {words}: median", _J, f"{key}_J"),
        Column("  quartiles over seeds", key=f"{key}_quartiles_J"),
        Column("  seeds within the residual limit", key=f"{key}_seeds"),
    ]


def _seeds(found: Searched) -> list[Cell]:
    """Median of the energies [J], quartiles where there are several seeds, how many arrive."""
    spread = found.energies
    several = spread.seeds > 1 and isfinite(spread.lower)
    return [
        _or_none(spread.median),
        f"{spread.lower:.4f}-{_or_none(spread.upper, '.4f')}" if several else None,
        f"{spread.count} of {spread.seeds}",
    ]


def _or_none(energy: float, form: str = "") -> Cell:
    """An energy; `none` where so many seeds did not come within the limit."""
    if not isfinite(energy):
        return "none"
    return format(energy, form) if form else energy


def like_for_like(result: Reproduction) -> Table:
    """The polynomial and the earlier studies' inputs, each by the paper's own search."""
    columns = [
        *map(Column, ("plant", "move", "search")),
        Column("residual limit [mm]", _MM, "residual_limit_mm"),
        Column("earlier study's input", key="earlier_input"),
        Column("  F2 [J] printed", _J, "earlier_printed_J"),
        *_of_seeds("by the search", "earlier_searched"),
        Column("  time of a seed [s]", _S, "earlier_seed_s"),
        Column("  F2 [J] by gradient, at rest", _J, "earlier_gradient_J"),
        Column("polynomial, terms N", key="terms"),
        Column("  F2 [J] printed", _J, "polynomial_printed_J"),
        *_of_seeds("by the search", "polynomial_searched"),
        Column("  time of a seed [s]", _S, "polynomial_seed_s"),
        Column("  F2 [J] by gradient, at rest", _J, "polynomial_gradient_J"),
    ]
    rows = [_compared(result, case) for case in CONDITIONS]
    return Table("Like for like: every input by the paper's own search", columns, rows)


def _compared(result: Reproduction, case: Case) -> list[Cell]:
    name, terms = earlier_input(case), COMPARED_TERMS
    (row,) = (r for r in result.rows if r.row.condition == case and r.row.earlier_energy)
    earlier, polynomial = result.experiment[case, name], result.experiment[case, terms]
    assert row.earlier is not None  # as its energy is printed
    return [
        *(case.task.plant.name, case.label, own_search(case).label, 1e3 * polynomial.level),
        *(name, row.row.earlier_energy, *_seeds(earlier), earlier.seconds, row.earlier.energy),
        *(terms, row.row.energy, *_seeds(polynomial), polynomial.seconds, row.in_box.energy),
    ]


def coefficients_table(result: Reproduction, number: int) -> Table:
    """Table 1 or 4: the printed coefficients beside those that search and gradient find."""
    case = COEFFICIENT_TABLES[number]
    rows: list[list[Cell]] = []
    for terms in (row.terms for row in ROWS if row.table == number + 1):
        found = {
            "printed": result.result(case, terms).printed,
            "printed, a_5 mended": result.result(case, terms).mended,
            f"{own_search(case).label}, middle seed": result.experiment[case, terms].middle,
            "gradient, in the box": result.more_terms[case, terms, True],
        }
        for name, plan in found.items():
            if plan is not None:
                rest = [None] * (COMPARED_TERMS - terms)
                figures = figures_of(plan)[:2]
                rows.append([f"N = {terms}, {name}", *plan.coefficients, *rest, *figures])
    columns = [
        Column("coefficients"),
        *(Column(f"a_{n}", "{:.4f}".format) for n in range(1, COMPARED_TERMS + 1)),
        Column("F2 [J]", _J, "energy_J"),
        Column("F1 [mm]", _MM, "residual_mm"),
    ]
    return Table(f"Table {number}: coefficients, {case.name}", columns, rows)
