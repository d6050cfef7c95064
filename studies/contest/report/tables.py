"""The figures of a contest as tables, each a CSV file as well."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from quietarm.ocp.front.points import LEVELS
from quietarm.studies.contest.imported import Imported
from quietarm.studies.contest.measures import TARGETS, Arena, Field, Outcome, quartiles, spread
from quietarm.studies.contest.names import label_of
from quietarm.studies.contest.statistics import ALPHA, Pair, Ranking
from quietarm.studies.display.words import millimetres
from quietarm.studies.report.table import Cell, Column, Table

_PERCENT = "{:.3g} %".format


def runs_table(arenas: Sequence[Arena]) -> Table:
    """One row a run, with every figure that statistics are made of.

    Cells that results from elsewhere have nothing for are empty, as is the number of evaluations
    where it is not known.
    """
    columns = [
        *map(Column, ("problem", "method", "seed", "file", "evaluations")),
        Column("processor time [s]", key="seconds"), Column("missing"), Column("points"),
        *(Column(f"ERT {t:g}", key=f"evaluations_to_{t:g}") for t in TARGETS),
        *(Column(f"{level}", key=f"energy_above_exact_at_{level:g}_m") for level in LEVELS),
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for arena in arenas:
        for one in arena.outcomes:
            hits = [one.hits(target) for target in TARGETS] if isinstance(one, Field) else None
            for i, run in enumerate(one.runs):
                which = (
                    [None, run.file, run.evaluations, None] if isinstance(run, Imported)
                    else [run.key.seed, None, run.front.evaluations, run.front.seconds]
                )  # fmt: skip
                rows.append([
                    arena.problem, one.method, *which, float(one.final[i]), len(run.front.points),
                    *([_finite(float(hit[i])) for hit in hits] if hits else [None] * len(TARGETS)),
                    *(_finite(float(share)) for share in one.energies[i]),
                ])  # fmt: skip
    return Table("Runs", columns, rows)


def anytime_table(arenas: Sequence[Arena]) -> Table:
    """Quartiles of what is missing, by problem, method and evaluations."""
    names = ("problem", "method", "evaluations", "missing_lower", "missing_median",
             "missing_upper", "seconds_median")  # fmt: skip
    rows: list[list[Cell]] = []
    for arena in arenas:
        for field in arena.fields:
            missing, seconds = quartiles(field.missing), quartiles(field.seconds)[1]
            for i, evaluations in enumerate(field.evaluations):
                shares = [float(share) for share in missing[:, i]]
                rows.append([arena.problem, field.method, int(evaluations), *shares,
                             float(seconds[i])])  # fmt: skip
    return Table("Hypervolume missing on the way", [Column(name) for name in names], rows)


def summary_table(arena: Arena) -> Table:
    """What each method ended with on a problem: one column a method."""
    columns = [
        Column("method"), Column("runs"), Column("evaluations of a run"),
        Column("hypervolume missing, median", _PERCENT),
        Column("  lower quartile", _PERCENT), Column("  upper quartile", _PERCENT),
        Column("processor time [s], median", "{:.2g}".format),
        *(column for target in TARGETS for column in (
            Column(f"runs with at most {100 * target:g} % missing"),
            Column(f"  expected evaluations to {100 * target:g} %", "{:.0f}".format))),
        *(column for level in LEVELS for column in (
            Column(f"energy above the exact at {millimetres(level)}, median", _PERCENT),
            Column(f"  runs that have a motion at {millimetres(level)}"))),
    ]  # fmt: skip
    return Table("What the methods ended with", columns, [_summary(one) for one in arena.outcomes])


def ranks_table(rankings: Sequence[tuple[str, Ranking]]) -> Table:
    """Mean ranks of every method, by what was ranked on: one row a method and ranking."""
    names = ("on", "blocks", "method", "mean_rank", "friedman_statistic", "friedman_p",
             "critical_difference")  # fmt: skip
    rows: list[list[Cell]] = [
        [where, f"{found.blocks} {found.what}", method, rank, found.statistic, found.p_value,
         found.critical]
        for where, found in rankings
        for method, rank in zip(found.methods, found.ranks, strict=True)
    ]  # fmt: skip
    return Table("Mean ranks", [Column(name) for name in names], rows)


def pairs_table(pairs: Sequence[Pair]) -> Table:
    """Every pair of methods: how likely the first misses less, and whether by chance."""
    names = ("problem", "method", "other", "probability_that_it_misses_less", "mann_whitney_p",
             "p_after_holm")  # fmt: skip
    rows: list[list[Cell]] = [
        [pair.problem, pair.one, pair.other, pair.effect, pair.p_value, pair.adjusted]
        for pair in pairs
    ]
    return Table("Pairs", [Column(name) for name in names], rows)


def effects_table(arena: Arena, pairs: Sequence[Pair]) -> Table:
    """The pairs on a problem as a square: how likely the line's method misses less."""
    methods = [one.method for one in arena.alike]
    known = {(pair.one, pair.other): (pair.effect, pair.adjusted) for pair in pairs}
    known |= {(pair.other, pair.one): (1 - pair.effect, pair.adjusted) for pair in pairs}
    rows: list[list[Cell]] = []
    for other in methods:
        row: list[Cell] = [f"than {label_of(other)}"]
        for method in methods:
            effect, p_value = known.get((method, other), (None, 1.0))
            sure = "*" if p_value < ALPHA else ""
            row.append(None if effect is None else f"{effect:.2f}{sure}")
        rows.append(row)
    columns = [Column("misses less"), *(Column(label_of(method)) for method in methods)]
    return Table("How likely a run misses less (* after Holm, at 5 %)", columns, rows)


def visits_table(arena: Arena) -> Table:
    """Where the candidates of the methods lie: one column a method, medians over the seeds."""
    columns = [
        Column("method"),
        *(Column(f"candidates in the {third} third", _PERCENT)
          for third in ("still", "middle", "cheap")),
        Column("  beyond the exact front's extent", _PERCENT),
        *(Column(f"hypervolume missing in the {third} third", _PERCENT)
          for third in ("still", "middle", "cheap")),
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for one in arena.outcomes:
        visited = quartiles(one.visited)[1] if isinstance(one, Field) else None
        missing = quartiles(one.missing_by_thirds)[1]
        row: list[Cell] = [label_of(one.method)]
        row += [None] * 4 if visited is None else [100 * float(share) for share in visited]
        rows.append([*row, *(100 * float(share) for share in missing)])
    return Table("Where the candidates lie, by the residual", columns, rows)


def _summary(one: Outcome) -> list[Cell]:
    runs, own = len(one.runs), one if isinstance(one, Field) else None
    row: list[Cell] = [label_of(one.method), runs, evaluations_words(one)]
    lower, median, upper = quartiles(one.final)
    row += [100 * float(share) for share in (median, lower, upper)]
    row.append(float(quartiles(own.seconds[:, -1:])[1, 0]) if own else None)
    for target in TARGETS:
        row.append(f"{int((one.final <= target).sum())} of {runs}")
        row.append(_finite(own.expected_running_time(target)) if own else None)
    for level in range(len(LEVELS)):
        found = spread(one.energies[:, level])
        row += [100 * found.median if found.count else None, f"{found.count} of {runs}"]
    return row


def evaluations_words(one: Outcome) -> str:
    """How many evaluations its runs had, as far as that is known."""
    known = sorted(budget for budget in one.budgets if budget is not None)
    return ", ".join([*map(str, known), *(["not known"] if None in one.budgets else [])])


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None
