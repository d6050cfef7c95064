"""The figures of a contest as tables, each a CSV file as well."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from metaheuristics.budget.run import MULTISTART, Help, parts_of
from studies.contest.measures import TARGETS, Arena, Field, quartiles, spread
from studies.contest.statistics import ALPHA, Pair, Ranking
from studies.display.tables import Cell, Column, Table
from studies.display.words import millimetres
from studies.registry.methods import LEVELS, method_of

_PERCENT = "{:.3g} %".format


_HELPED = {Help.NONE: "", Help.POLISH: ", then polished", Help.SEEDS: " from gradient seeds"}


def label_of(method: str) -> str:
    """What a method is called in tables and pictures."""
    search, helped = parts_of(method)
    label = "gradient, random starts" if search == MULTISTART else method_of(search).label
    return f"{label}{_HELPED[helped]}"


def runs_table(arenas: Sequence[Arena]) -> Table:
    """One row a run, with every figure that statistics are made of."""
    columns = [
        *map(Column, ("problem", "method", "seed", "evaluations")),
        Column("processor time [s]", key="seconds"), Column("missing"), Column("points"),
        *(Column(f"ERT {t:g}", key=f"evaluations_to_{t:g}") for t in TARGETS),
        *(Column(f"{level}", key=f"energy_above_exact_at_{level:g}_m") for level in LEVELS),
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for arena in arenas:
        for field in arena.fields:
            hits = [field.hits(target) for target in TARGETS]
            for i, run in enumerate(field.runs):
                rows.append([
                    arena.problem, field.method, run.key.seed, run.front.evaluations,
                    run.front.seconds, float(field.final[i]), len(run.front.points),
                    *(_finite(float(hit[i])) for hit in hits),
                    *(_finite(float(share)) for share in field.energies[i]),
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
        Column("method"), Column("runs"),
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
    return Table("What the methods ended with", columns, [_summary(f) for f in arena.fields])


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
    methods = [field.method for field in arena.fields]
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
    for field in arena.fields:
        shares = quartiles(field.visited)[1]
        missing = quartiles(field.missing_by_thirds)[1]
        percent = [100 * float(share) for share in [*shares, *missing]]
        rows.append([label_of(field.method), *percent])
    return Table("Where the candidates lie, by the residual", columns, rows)


def _summary(field: Field) -> list[Cell]:
    lower, median, upper = (100 * float(q) for q in quartiles(field.final[:, None])[:, 0])
    row: list[Cell] = [label_of(field.method), len(field.runs), median, lower, upper]
    row.append(float(quartiles(field.seconds[:, -1:])[1, 0]))
    for target in TARGETS:
        reached = int((field.final <= target).sum())
        row += [f"{reached} of {len(field.runs)}", _finite(field.expected_running_time(target))]
    for level in range(len(LEVELS)):
        found = spread(field.energies[:, level])
        row += [
            100 * found.median if found.count else None,
            f"{found.count} of {len(field.runs)}",
        ]
    return row


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None
