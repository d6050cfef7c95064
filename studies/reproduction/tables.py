"""What is recomputed as tables: the paper's, all systems, multiples of the floor, both solvers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from operator import attrgetter
from typing import Any

from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL, Spread
from quietarm.metaheuristics.sharing.pieces import Done, Piece
from quietarm.ocp import Floor, Front, Plan
from quietarm.studies.paper.printed import CONDITIONS, EARLIER, Case
from quietarm.studies.report.table import Cell, Column, Table
from quietarm.studies.reproduction.recompute import TERMS, Reproduction, RowResult
from quietarm.studies.reproduction.systems import FREQUENCY_ERROR, SEARCHES, System, Systems

_Columns = list[tuple[Column, Callable[[Any], Cell]]]
"""Columns, each with how its cell is read off what a row is of."""

_J, _MM, _S = "{:.4g}".format, "{:.3g}".format, "{:.2f}".format
_MENDED = ", a_5 mended"
TITLES = {
    2: "Table 2: number of terms, single-link manipulator",
    3: "Table 3: against ref. [23], single-link manipulator",
    5: "Table 5: number of terms, arm on a flexible link",
    6: "Table 6: against ref. [24], arm on a flexible link",
}
_ERROR = f"{100 * FREQUENCY_ERROR:g} %"
_IN_BOX, _FREE, _PAPER = "gradient, in the box", "gradient, no box", "paper"
SERIES = (_PAPER, *(method.label for method in SEARCHES), _IN_BOX, _FREE)


def _table(title: str, rows: Sequence[Any], columns: _Columns) -> Table:
    cells = [[read(row) for _, read in columns] for row in rows]
    return Table(title, [column for column, _ in columns], cells)


# The paper's tables


def paper_table(result: Reproduction, number: int) -> Table:
    """One of the paper's tables with the recomputed figures beside the printed ones.

    A misprint mended has a row of its own, which holds what it changes.
    """
    rows = [
        (row, mended)
        for row in result.rows
        if row.row.table == number
        for mended in (False, True)
        if row.mended or not mended
    ]
    first, _ = rows[0]
    method, several = first.own_search, len(first.fronts[first.own_search]) > 1
    name = method.label
    reference, profile = EARLIER[first.row.condition.task.plant.name]

    def quartiles(row: RowResult) -> str | None:
        spread = row.searched_by(method)
        return f"{spread.lower:.4f}-{spread.upper:.4f}" if several else None

    def median(row: RowResult) -> Cell:
        energy = row.searched_by(method).median
        return energy if isfinite(energy) else "none"

    def seconds(row: RowResult) -> float:
        return Spread.of([front.seconds for front in row.fronts[method]]).median

    def once(read: Callable[[RowResult], Any]) -> Callable[[tuple[RowResult, bool]], Any]:
        return lambda row: None if row[1] else read(row[0])

    read_here = f"{profile}, ref. [{reference}] as read here, by gradient"
    energy, residual, _ = _of_plan(
        "printed coefficients",
        "printed_coefficients",
        lambda row: row[0].mended if row[1] else row[0].printed,
    )
    columns: _Columns = [
        (Column("move"), lambda row: row[0].row.condition.label),
        (Column("terms N", key="terms"), lambda row: f"{row[0].row.terms}{_MENDED * row[1]}"),
        (Column("F2 [J] earlier study", _J, "earlier_study_J"),
         lambda row: row[0].row.earlier_energy),
        *_of_plan(read_here, "earlier_study_as_read_here", lambda row: row[0].earlier),
        (Column("F2 [J] printed", _J, "printed_J"), lambda row: row[0].row.energy),
        energy,
        residual,
        *_of_plan(_IN_BOX, "gradient_in_box", once(lambda row: row.in_box)),
        *_of_plan(_FREE, "gradient_no_box", once(lambda row: row.free)),
        (Column(f"F2 [J] {name}, in the box", _J, f"{name}_in_box_J"), once(median)),
        (Column("  quartiles over seeds", key=f"{name}_quartiles_J"), once(quartiles)),
        (Column("  residual limit [mm]", _MM, f"{name}_residual_limit_mm"),
         once(lambda row: row.residual_level * 1e3)),
        (Column("  time of a run [s]", _S, f"{name}_run_s"), once(seconds)),
    ]  # fmt: skip
    return _table(TITLES[number], rows, columns)


def _of_plan(words: str, key: str, plan_of: Callable[[Any], Plan | None]) -> _Columns:
    """Energy, residual and time of a plan."""

    def read(figure: Callable[[Plan], float]) -> Callable[[Any], Cell]:
        return lambda row: None if (plan := plan_of(row)) is None else figure(plan)

    return [
        (Column(f"F2 [J] {words}", _J, f"{key}_J"), read(lambda plan: plan.energy)),
        (Column("  residual [mm]", _MM, f"{key}_residual_mm"),
         read(lambda plan: plan.residual * 1e3)),
        (Column("  time [s]", _S, f"{key}_s"), read(lambda plan: plan.provenance.seconds)),
    ]  # fmt: skip


# Side by side


def seconds_in_words(seconds: float) -> str:
    """Four characters at most: in a terminal of 80 there is room for no more."""
    decimals = 2 if seconds < 0.995 else 1 if seconds < 9.95 else 0
    return f"{seconds:.{decimals}f}"


def _three_digits(value: float) -> str:
    """Three digits at least, never a power of ten: the floor's jolts are as large as 1e5."""
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def _mm(name: str) -> Callable[[System], Cell]:
    """A length of a system in millimetres."""
    return lambda found: None if (length := getattr(found, name)) is None else 1e3 * length


_OF_SYSTEM: _Columns = [
    (Column("size", str, "parameters"), attrgetter("parameters")),
    (Column("energy [J]", "{:.4f}".format, "energy_J"), attrgetter("energy")),
    (Column("residual [mm]", "{:.2f}".format, "residual_mm"), _mm("residual")),
    (Column(f"{_ERROR} off [mm]", "{:.2f}".format, "residual_frequency_wrong_mm"),
     _mm("wrong_residual")),
    (Column("peak torque [N m]", _three_digits, "peak_torque_Nm"), attrgetter("peak_torque")),
    (Column("peak accel. [1/s^2]", _three_digits, "peak_acceleration_rad_s2"),
     attrgetter("peak_acceleration")),
    (Column("time [s]", seconds_in_words, "seconds"), attrgetter("seconds")),
]  # fmt: skip


def systems_table(case: Case, systems: Sequence[System]) -> Table:
    """All systems on one move, a line each where it is shown."""
    columns = [Column("system"), *(column for column, _ in _OF_SYSTEM)]
    rows = [[found.name, *(c.text(read(found)) for c, read in _OF_SYSTEM)] for found in systems]
    return Table(f"Side by side: {case.name}", columns, rows).turned()


def all_systems(systems: Systems) -> Table:
    """Every system on every move, for CSV."""
    columns: _Columns = [
        (Column("plant"), lambda row: row[0].task.plant.name),
        (Column("move"), lambda row: row[0].label),
        (Column("system"), lambda row: row[1].name),
        *((column, lambda row, read=read: read(row[1])) for column, read in _OF_SYSTEM),
        (Column("why"), lambda row: row[1].why or None),
    ]
    rows = [(case, found) for case, every in systems.items() for found in every]
    return _table("Side by side", rows, columns)


# The floor

Multiples = dict[tuple[str, int], tuple[float, float, float]]
"""Energies over the floor, by series and number of terms: median and quartiles over the seeds."""


def multiples(result: Reproduction, condition: Case) -> Multiples:
    """All energies of a condition as multiples of its floor, by series and then terms."""
    floor = result.floors[condition].energy
    rows = {r.row.terms: r for r in result.rows if r.row.condition == condition}
    spreads = {(_PAPER, n): Spread.of([row.row.energy]) for n, row in sorted(rows.items())}
    for method in SEARCHES:
        spreads |= {(method.label, n): row.searched_by(method) for n, row in sorted(rows.items())}
    for series, boxed in ((_IN_BOX, True), (_FREE, False)):
        for terms in TERMS:
            energy = result.more_terms[condition, terms, boxed].energy
            spreads[series, terms] = Spread.of([energy])
    return {
        place: (spread.median / floor, spread.lower / floor, spread.upper / floor)
        for place, spread in spreads.items()
        if isfinite(spread.median)
    }


def floor_table(result: Reproduction) -> Table:
    """The multiples as a table, one row for each condition."""
    found = {case: multiples(result, case) for case in CONDITIONS}
    floors = result.floors

    def agreement(case: Case) -> str:
        return f"{floors[case].agreeing()} of {len(floors[case].starts)}"

    columns: _Columns = [
        (Column("plant"), lambda case: case.task.plant.name),
        (Column("move"), lambda case: case.label),
        (Column("floor F2 [J]", _J, "floor_J"), lambda case: floors[case].energy),
        (Column("  left [J], about", "{:.1g}".format, "left_J"), lambda case: floors[case].left),
        (Column("  starts that agree", key="starts_that_agree"), agreement),
    ]
    columns += [
        (Column(f"{series}, N = {terms}", "{:.3f}".format, _key(series, terms)),
         lambda case, place=(series, terms): found[case].get(place, (None,))[0])
        for series in SERIES
        for terms in (TERMS if series in (_IN_BOX, _FREE) else (2, 4, 6))
    ]  # fmt: skip
    return _table("Energies as multiples of the floor, at rest on arrival", CONDITIONS, columns)


def of_plants(table: Table) -> list[Table]:
    """A table with the plant in its first column, as one table for each: narrower on a screen."""
    return [
        Table(
            f"{table.title}, {plant}",
            table.columns[1:],
            [row[1:] for row in table.rows if row[0] == plant],
        )
        for plant in dict.fromkeys(row[0] for row in table.rows)
    ]


def _key(series: str, terms: int) -> str:
    name = series.lower().replace(", ", "_").replace(" ", "_").replace("-", "_")
    return f"{name}_{terms}_terms_over_floor"


def finding(result: Reproduction) -> str:
    """In a sentence, how far from the floor the paper and the gradient are."""
    every = [multiples(result, condition) for condition in CONDITIONS]

    def span(series: str, numbers: Sequence[int]) -> str:
        values = [of[series, n][0] for of in every for n in numbers if (series, n) in of]
        return f"{min(values):.2f} to {max(values):.2f}"

    return (
        f"The paper's plans need {span(_PAPER, TERMS)} times the least energy of any joint motion. "
        f"The gradient's plans need {span(_IN_BOX, [6])} times that energy with six terms in the "
        f"paper's box, and {span(_FREE, [10])} times with ten terms and no box."
    )


# Both solvers, and what an interruption left


def checks_table(result: Reproduction) -> Table:
    """How far the two solvers of the gradient differ along the exact fronts."""
    difference = Column("largest difference", "{:.0e}".format, "largest_difference")
    columns: _Columns = [
        (Column("move"), lambda row: row[0].name),
        (Column("points"), lambda row: str(len(row[1].points))),
        (difference, lambda row: row[1].largest),
    ]
    return _table("Exact fronts by both solvers", list(result.checks.items()), columns)


def unfinished_table(pieces: Sequence[Piece], done: Done) -> Table:
    """Energy and residual of every piece of work that came to its end, one row for each."""
    columns: _Columns = [
        (Column("piece of work", key="piece"), lambda row: row[0]),
        (Column("F2 [J]", key="energy_J"), lambda row: row[1]),
        (Column("residual [mm]", _MM, "residual_mm"), lambda row: row[2]),
    ]
    rows = [(p.name, *_figures(done.answers[p.key])) for p in pieces if p.key in done.answers]
    return _table("What was done before the interruption", rows, columns)


def _figures(answer: Any) -> tuple[float | None, float | None]:
    """Energy [J] and residual [mm] of a plan, a floor or a front; of all else there are none."""
    if isinstance(answer, Front):
        still = [point for point in answer.points if point.residual <= SEARCH_RESIDUAL]
        return (still[-1].energy, 1e3 * still[-1].residual) if still else (None, None)
    if isinstance(answer, Plan | Floor):
        return answer.energy, 1e3 * answer.residual
    return None, None
