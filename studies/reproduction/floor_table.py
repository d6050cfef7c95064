"""Every energy of the paper's conditions as a multiple of the floor at rest on arrival."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from quietarm.metaheuristics.ensemble import Spread
from quietarm.ocp import Floor
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.printed import CONDITIONS
from quietarm.studies.report.table import Cell, Column, Table
from quietarm.studies.reproduction.pieces import SEARCHES, TERMS
from quietarm.studies.reproduction.recompute import Reproduction

PAPER, IN_BOX, FREE = "paper", "gradient, in the box", "gradient, no box"
SERIES = (PAPER, *(method.label for method in SEARCHES), IN_BOX, FREE)
_PRINTED_TERMS = (2, 4, 6)
LEGEND = (
    "Floor: the least energy over all joint motions that start and end at rest, joint and "
    "structure, without limits; it starts and stops with jolts. Left: an estimate of what finer "
    "grids would still lower it. Starts that agree: how many of the solver's starts end within "
    "0.5 % of the best. The paper's energies are the printed ones, with the paper's residual; "
    "VEPSO and NSGA-II are judged at that residual, the gradient and the floor at rest."
)


@dataclass(frozen=True)
class Multiple:
    """An energy over the floor: its series, number of terms, and quartiles over seeds."""

    series: str
    terms: int
    median: float
    lower: float
    upper: float


def multiples(result: Reproduction, condition: Case) -> list[Multiple]:
    """All energies of a condition as multiples of its floor, by series and then terms."""
    floor = result.floors[condition].energy
    rows = {r.row.terms: r for r in result.rows if r.row.condition == condition}
    found = [_exact(PAPER, terms, r.row.energy / floor) for terms, r in sorted(rows.items())]
    for method in SEARCHES:
        for terms, row in sorted(rows.items()):
            spread = row.searched_by(method)
            if isfinite(spread.median):
                found.append(_of_spread(method.label, terms, spread, floor))
    for series, boxed in ((IN_BOX, True), (FREE, False)):
        for terms in TERMS:
            energy = result.more_terms[condition, terms, boxed].energy
            found.append(_exact(series, terms, energy / floor))
    return found


def _exact(series: str, terms: int, value: float) -> Multiple:
    return Multiple(series, terms, value, value, value)


def _of_spread(series: str, terms: int, spread: Spread, floor: float) -> Multiple:
    return Multiple(
        series, terms, *(q / floor for q in (spread.median, spread.lower, spread.upper))
    )


def floor_table(result: Reproduction, plant: str | None = None) -> Table:
    """The multiples as a table, one row for each condition: all, or those of one plant."""
    columns = [
        Column("plant", key="plant"),
        Column("move", key="move"),
        Column("floor F2 [J]", "{:.4g}".format, "floor_J"),
        Column("  left [J], about", "{:.1g}".format, "left_J"),
        Column("  starts that agree", key="starts_that_agree"),
    ]
    places = [
        (series, terms)
        for series in SERIES
        for terms in (TERMS if series in (IN_BOX, FREE) else _PRINTED_TERMS)
    ]
    for series, terms in places:
        heading = f"{series}, N = {terms}"
        columns.append(Column(heading, "{:.3f}".format, _key(series, terms)))
    rows = [_row(result, c, places) for c in CONDITIONS if plant in (None, c.task.plant.name)]
    title = "Energies as multiples of the floor, at rest on arrival"
    if plant is not None:
        title, rows = f"{title}, {plant}", [[None, *row[1:]] for row in rows]
    return Table(title, columns, rows)


def _key(series: str, terms: int) -> str:
    name = series.lower().replace(", ", "_").replace(" ", "_").replace("-", "_")
    return f"{name}_{terms}_terms_over_floor"


def _row(result: Reproduction, condition: Case, places: Sequence[tuple[str, int]]) -> list[Cell]:
    floor = result.floors[condition]
    values = {(m.series, m.terms): m.median for m in multiples(result, condition)}
    head: list[Cell] = [
        condition.task.plant.name, condition.label, floor.energy, floor.left, _agreement(floor)
    ]  # fmt: skip
    return [*head, *(values.get(place) for place in places)]


def _agreement(floor: Floor) -> str:
    return f"{floor.agreeing()} of {len(floor.starts)}"


def floor_tables(result: Reproduction) -> list[Table]:
    """The same, one table for each plant, narrow enough for a terminal."""
    plants = dict.fromkeys(condition.task.plant.name for condition in CONDITIONS)
    return [floor_table(result, plant) for plant in plants]


def finding(result: Reproduction) -> str:
    """In a sentence, how far from the floor the paper and the gradient are."""

    def span(series: str, terms: int | None = None) -> str:
        values = [
            m.median
            for condition in CONDITIONS
            for m in multiples(result, condition)
            if m.series == series and terms in (None, m.terms)
        ]
        return f"{min(values):.2f} to {max(values):.2f}"

    return (
        f"The paper's plans need {span(PAPER)} times the least energy of any joint motion. The "
        f"gradient's plans need {span(IN_BOX, 6)} times that energy with six terms in the paper's "
        f"box, and {span(FREE, 10)} times with ten terms and no box."
    )
