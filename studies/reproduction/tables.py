"""What is recomputed as tables: all systems, multiples of the floor, both solvers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from operator import attrgetter

from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL, Spread
from quietarm.metaheuristics.sharing.pieces import Done, Piece
from quietarm.ocp import Floor, Front, Plan
from quietarm.studies.document.table import Cell, Column, Line, Table, table_of
from quietarm.studies.paper import CONDITIONS, Case
from quietarm.studies.reproduction.paper_tables import figures_of
from quietarm.studies.reproduction.recompute import TERMS, Reproduction
from quietarm.studies.reproduction.searches import SEARCHES
from quietarm.studies.reproduction.systems import FREQUENCY_ERROR, System, Systems

_J, _MM = "{:.4g}".format, "{:.3g}".format
_ERROR = f"{100 * FREQUENCY_ERROR:g} %"
_IN_BOX, _FREE, _PAPER = "gradient, in the box", "gradient, no box", "paper"
SERIES = (_PAPER, *(method.label for method in SEARCHES), _IN_BOX, _FREE)


# Side by side

_TURNED = 1e-4
"""From so many radians on a joint is said to turn back."""


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


_OF_SYSTEM = {
    Column("size", str, "parameters"): attrgetter("parameters"),
    Column("energy [J]", "{:.4f}".format, "energy_J"): attrgetter("energy"),
    Column("residual [mm]", "{:.2f}".format, "residual_mm"): _mm("residual"),
    Column(f"{_ERROR} off [mm]", "{:.2f}".format, "residual_frequency_wrong_mm"): _mm(
        "wrong_residual"
    ),
    Column("peak torque [N m]", _three_digits, "peak_torque_Nm"): attrgetter("peak_torque"),
    Column("peak accel. [1/s^2]", _three_digits, "peak_acceleration_rad_s2"): attrgetter(
        "peak_acceleration"
    ),
    Column("time [s]", seconds_in_words, "seconds"): attrgetter("seconds"),
}
"""Columns of a system, each with what reads its cell."""
_OF_SEEDS = {
    Column(key): attrgetter(f"energies.{name}")
    for key, name in {
        "energy_lower_quartile_J": "lower",
        "energy_upper_quartile_J": "upper",
        "seeds_near_enough": "count",
        "seeds": "seeds",
    }.items()
}


def systems_table(case: Case, systems: Sequence[System]) -> Table:
    """All systems on one move, a line each where it is shown."""
    rows = [
        [found.name, *(column.text(read(found)) for column, read in _OF_SYSTEM.items())]
        for found in systems
    ]
    for row, found in zip(rows, systems, strict=True):
        if found.printed_energy is not None:
            row[2] += " printed"
    return Table(f"Side by side: {case.name}", [Column("system"), *_OF_SYSTEM], rows).turned()


def all_systems(systems: Systems) -> Table:
    """Every system on every move, for CSV."""
    columns = [*map(Column, ("plant", "move", "system")), *_OF_SYSTEM, Column("turns_back_rad")]
    columns += [*_OF_SEEDS, Column("why")]
    rows = [
        [
            *(case.task.plant.name, case.label, found.name),
            *(read(found) for read in _OF_SYSTEM.values()),
            found.turns_back,
            *(read(found) if found.energies else None for read in _OF_SEEDS.values()),
            found.why or None,
        ]
        for case, every in systems.items()
        for found in every
    ]
    return Table("Side by side", columns, rows)


def remarks(every: Sequence[System]) -> list[str]:
    """What the table of a move cannot say: what is missing, several seeds, a joint turning back."""
    lines = list[str]()
    for found in every:
        if found.why:
            lines.append(f"{found.name}: {found.why}")
        if (spread := found.energies) and spread.seeds > 1 and spread.count:
            middle, low, high = (
                f"{each:.4f} J" if isfinite(each) else "none"
                for each in (spread.median, spread.lower, spread.upper)
            )
            lines.append(
                f"{found.name}: the middle one of {spread.seeds} seeds, {spread.count} of which "
                f"come near enough; median {middle}, quartiles {low} and {high}"
            )
    back = [f"{s.name} by {s.turns_back:.2g} rad" for s in every if (s.turns_back or 0) > _TURNED]
    return [*lines, *([f"On its way the joint turns back: {', '.join(back)}"] if back else [])]


# The floor

Multiples = dict[tuple[str, int], tuple[float, float, float]]
"""Energies over the floor, by series and number of terms: median and quartiles over the seeds."""


def multiples(result: Reproduction, condition: Case) -> Multiples:
    """All energies of a condition as multiples of its floor, by series and then terms."""
    floor = result.floors[condition].energy
    rows = {r.row.terms: r for r in result.rows if r.row.condition == condition}
    spreads = {(_PAPER, n): Spread.of([row.row.energy]) for n, row in sorted(rows.items())}
    for method in SEARCHES:
        spreads |= {
            (method.label, n): row.searched[method].energies for n, row in sorted(rows.items())
        }
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
    places = [
        (series, terms)
        for series in SERIES
        for terms in (TERMS if series in (_IN_BOX, _FREE) else (2, 4, 6))
    ]
    columns = [
        *map(Column, ("plant", "move")),
        Column("floor F2 [J]", _J, "floor_J"),
        Column("  left [J], about", "{:.1g}".format, "left_J"),
        Column("  starts that agree", key="starts_that_agree"),
        *(Column(f"{s}, N = {n}", "{:.3f}".format, _key(s, n)) for s, n in places),
    ]
    rows: list[list[Cell]] = []
    for case in CONDITIONS:
        floor, found = result.floors[case], multiples(result, case)
        row = [case.task.plant.name, case.label, floor.energy, floor.left]
        row.append(f"{floor.agreeing()} of {len(floor.starts)}")
        rows.append([*row, *(found.get(place, (None,))[0] for place in places)])
    return Table("Energies as multiples of the floor, at rest on arrival", columns, rows)


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
    columns: list[Line] = [
        ("move", "", [case.name for case in result.checks]),
        ("points", "", [str(len(check.points)) for check in result.checks.values()]),
        ("largest difference", "{:.0e}", [check.largest for check in result.checks.values()]),
    ]
    return table_of("Exact fronts by both solvers", columns)


def unfinished_table(pieces: Sequence[Piece], done: Done) -> Table:
    """Energy and residual of every piece of work that came to its end, one row for each."""
    columns = [
        Column("piece of work", key="piece"),
        Column("F2 [J]", key="energy_J"),
        Column("residual [mm]", _MM, "residual_mm"),
    ]
    rows = [[p.name, *_ended(done.answers[p.key])] for p in pieces if p.key in done.answers]
    return Table("What was done before the interruption", columns, rows)


def _ended(answer: object) -> list[float | None]:
    """Energy [J] and residual [mm] of a plan, a floor or a front; of all else there are none."""
    if isinstance(answer, Front):
        still = [point for point in answer.points if point.residual <= SEARCH_RESIDUAL]
        return [still[-1].energy, 1e3 * still[-1].residual] if still else [None, None]
    return figures_of(answer if isinstance(answer, Plan | Floor) else None)[:2]
