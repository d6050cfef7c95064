"""The figures of a contest as tables, each a CSV file as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from math import isfinite

import numpy as np
from quietarm.metaheuristics.ensemble import Spread
from quietarm.ocp.front.points import LEVELS
from quietarm.studies.contest.measures import (
    TARGETS,
    Arena,
    Array,
    Field,
    budgets_of,
    methods_in,
    quartiles,
)
from quietarm.studies.contest.names import label_of
from quietarm.studies.contest.statistics import ALPHA, Pair, Ranking
from quietarm.studies.display.words import millimetres
from quietarm.studies.document.table import Cell, Column, Line, Table, table_of

_PERCENT = "{:.3g} %"
_THIRDS = ("still", "middle", "cheap")


def runs_table(arenas: Sequence[Arena]) -> Table:
    """One row a run, with every figure that statistics are made of.

    Cells that results from elsewhere have nothing for are empty, as is the number of evaluations
    where it is not known.
    """
    names = ["problem", "method", "seed", "file", "evaluations", "seconds", "missing", "points"]
    names += [f"evaluations_to_{target:g}" for target in TARGETS]
    names += [f"energy_above_exact_at_{level:g}_m" for level in LEVELS]
    rows: list[list[Cell]] = []
    for field in (field for arena in arenas for field in arena.fields):
        hits = [field.hits(target) for target in TARGETS]
        for i, run in enumerate(field.runs):
            row: list[Cell] = [field.yardstick.problem, field.method]
            if field.own:
                row += [run.front.seed, None, run.front.evaluations, run.front.seconds]
            else:
                row += [None, run.file, run.evaluations, None]
            row += [float(field.final[i]), len(run.front.points), *(float(hit[i]) for hit in hits)]
            rows.append([*row, *field.energies[i].tolist()])
    columns = zip(names, zip(*rows, strict=True), strict=True)
    return table_of("Runs", [(name, "", cells) for name, cells in columns])


def over_table(arenas: Sequence[Arena]) -> Table:
    """What the middle run of each method misses over several problems, and the mean ranks.

    After parts of the evaluations and after all; mean ranks of those that ran on every problem.
    """
    budgets, methods = budgets_of(arenas), methods_in(arenas)
    known = {
        method: np.array([
            [quartiles(field.missing_after(budget))[1] for budget in budgets]
            for arena in arenas for field in arena.fields
            if field.method == method
        ])
        for method in methods
    }  # fmt: skip
    whole = [method for method in methods if len(known[method]) == len(arenas)]
    middles = np.array([known[method] for method in whole])
    above, level = (compare(middles[:, None], middles).sum(1) for compare in (np.greater, np.equal))
    placed = above + (level + 1) / 2  # those that are equal share their places
    ranks = dict(zip(whole, placed.mean(axis=1).tolist(), strict=True)) if whole else {}
    columns = [Column("method"), Column("problems")]
    for budget in budgets:
        columns += [Column(f"after {budget} [%]"), Column("  mean rank")]
    rows: list[list[Cell]] = []
    for method, ends in known.items():
        places = [f"{rank:.2f}" for rank in ranks.get(method, [])] or [None] * len(budgets)
        pairs = zip(map(_spread, ends.T), places, strict=True)
        rows.append([label_of(method), len(ends), *(cell for pair in pairs for cell in pair)])
    title = "Hypervolume missing in the middle run: median and quartiles over problems"
    return Table(title, columns, rows)


def _spread(shares: Array) -> str:
    """Median and quartiles [%] of what is missing."""
    lower, median, upper = 100 * quartiles(shares)
    return f"{median:.3g} ({lower:.3g} to {upper:.3g})"


def budgets_table(arena: Arena) -> Table:
    """What each method misses on a problem after parts of its evaluations and after all."""
    budgets = budgets_of([arena])
    columns = [Column("method"), *(Column(f"after {budget} [%]") for budget in budgets)]
    rows = [
        [field.label, *(_spread(field.missing_after(budget)) for budget in budgets)]
        for field in arena.own
    ]
    return Table("Hypervolume missing: median and quartiles over the runs", columns, rows)


def anytime_table(arenas: Sequence[Arena]) -> Table:
    """Quartiles of what is missing, by problem, method and evaluations."""
    names = "problem method evaluations missing_lower missing_median missing_upper seconds_median"
    rows: list[list[Cell]] = []
    for field in (field for arena in arenas for field in arena.own):
        shares, seconds = quartiles(field.missing).T.tolist(), quartiles(field.seconds)[1].tolist()
        for place, evaluations in enumerate(field.evaluations.tolist()):
            row = [field.yardstick.problem, field.method, evaluations]
            rows.append([*row, *shares[place], seconds[place]])
    return Table("Hypervolume missing on the way", list(map(Column, names.split())), rows)


def summary_table(arena: Arena) -> Table:
    """What each method ended with on a problem: one column a method."""
    fields = arena.fields
    ends = [(100 * quartiles(field.final)).tolist() for field in fields]
    columns: list[Line] = [
        ("method", "", [field.label for field in fields]),
        ("runs", "", [len(field.runs) for field in fields]),
        ("evaluations of a run", "", [evaluations_words(field) for field in fields]),
        ("hypervolume missing, median", _PERCENT, [end[1] for end in ends]),
        ("  lower quartile", _PERCENT, [end[0] for end in ends]),
        ("  upper quartile", _PERCENT, [end[2] for end in ends]),
        ("processor time [s], median", "{:.2g}", [_seconds(f) for f in fields]),
    ]
    for target in TARGETS:
        share = f"{100 * target:g} %"
        reached = [_of_runs((field.final <= target).sum(), field) for field in fields]
        times = [field.expected_running_time(target) for field in fields]
        columns += [
            (f"runs with at most {share} missing", "", reached),
            (f"  expected evaluations to {share}", "{:.0f}", times),
        ]
    for place, level in enumerate(LEVELS):
        where = f"at {millimetres(level)}"
        above = [Spread.of(field.energies[:, place].tolist()) for field in fields]
        reached = [_of_runs(one.count, field) for one, field in zip(above, fields, strict=True)]
        medians: list[Cell] = [
            100 * one.median if isfinite(one.median) else "not reached" for one in above
        ]
        columns += [
            (f"energy above the exact {where}, median", _PERCENT, medians),
            (f"  runs that have a motion {where}", "", reached),
        ]
    return table_of("What the methods ended with", columns)


def _seconds(field: Field) -> float | None:
    return float(quartiles(field.seconds[:, -1])[1]) if field.own else None


def _of_runs(count: int, field: Field) -> str:
    return f"{count} of {len(field.runs)}"


def ranks_table(rankings: Sequence[Ranking]) -> Table:
    """Mean ranks of every method, by what was ranked on: one row a method and ranking."""
    names = "on over method mean_rank test statistic p critical_difference"
    rows: list[list[Cell]] = [
        [
            found.on,
            found.over,
            method,
            rank,
            found.test,
            found.statistic,
            found.p_value,
            found.critical,
        ]
        for found in rankings
        for method, rank in zip(found.methods, found.ranks, strict=True)
    ]
    return Table("Mean ranks", list(map(Column, names.split())), rows)


def pairs_table(pairs: Sequence[Pair]) -> Table:
    """Every pair of methods: how likely the first misses less, and whether by chance."""
    names = "problem method other probability_that_it_misses_less mann_whitney_p p_after_holm"
    return Table("Pairs", list(map(Column, names.split())), [astuple(pair) for pair in pairs])


def effects_table(arena: Arena, pairs: Sequence[Pair]) -> Table:
    """The pairs on a problem as a square: how likely the line's method misses less."""
    known = {(pair.one, pair.other): (pair.effect, pair.adjusted) for pair in pairs}
    known |= {(pair.other, pair.one): (1 - pair.effect, pair.adjusted) for pair in pairs}

    def less(one: Field, other: Field) -> Cell:
        effect, p_value = known.get((one.method, other.method), (None, 1.0))
        return None if effect is None else f"{effect:.2f}{'*' * (p_value < ALPHA)}"

    fields = arena.alike
    columns: list[Line] = [
        ("misses less", "", [f"than {other.label}" for other in fields]),
        *((one.label, "", [less(one, other) for other in fields]) for one in fields),
    ]
    return table_of("How likely a run misses less (* after Holm, at 5 %)", columns)


def visits_table(arena: Arena) -> Table:
    """Where the candidates of the methods lie: one column a method, medians over the seeds."""
    names = [
        *(f"candidates in the {third} third" for third in _THIRDS),
        "  beyond the exact front's extent",
        *(f"hypervolume missing in the {third} third" for third in _THIRDS),
    ]
    rows: list[list[Cell]] = []
    for field in arena.fields:
        visited = (100 * quartiles(field.visited)[1]).tolist() if field.own else [None] * 4
        missing = (100 * quartiles(field.missing_by_thirds)[1]).tolist()
        rows.append([field.label, *visited, *missing])
    columns = [Column("method"), *(Column(name, _PERCENT.format) for name in names)]
    return Table("Where the candidates lie, by the residual", columns, rows)


def evaluations_words(field: Field) -> str:
    """How many evaluations its runs had, as far as that is known."""
    known = sorted(budget for budget in field.budgets if budget is not None)
    return ", ".join([*map(str, known), *(["not known"] if None in field.budgets else [])])
