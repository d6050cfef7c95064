"""The first table of the report: searches chosen on the first seeds, judged on fresh ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .comparing import medians_by_plant, searches_in
from .experiment import CONTROL, DIFFERENCES, LIMITS, takes_slopes
from .gaps import INDICATORS, Results
from .runs import Problem, Run
from .significance import add_holm, holm, interval, signed_ranks

FIRST_SEEDS = 3
EQUAL = 0.5
"""Two gaps that differ by less [percentage points] are equal for practice; set beforehand."""
OF_LIMITS = tuple(f"absolute-{limits}" for limits in LIMITS)


@dataclass(frozen=True)
class Row:
    """A row of the report's first table: a search against one rival, on one or more kinds.

    The search, and the settings of SLSQP, are those of the least median gap on the first seeds; of
    several kinds of problem, those whose largest median is least. Fresh seeds judge them.
    """

    name: str
    axes: tuple[str, ...]
    budget: int
    kinds: tuple[str, ...] = ("absolute",)
    noise: str = ""
    rival: str = DIFFERENCES
    measure: str = "between"


ROWS = (
    Row("model", ("centre",), 10_000, rival=CONTROL),
    Row("smooth", ("centre",), 10_000),
    Row("limits", ("limits",), 10_000, OF_LIMITS),
    Row("limits-1000", ("limits",), 1_000, OF_LIMITS),
    Row("limits-200", ("limits",), 200, OF_LIMITS),
    Row("jumps", ("energy",), 10_000, ("motor-map",)),
    Row("noise", ("noise",), 10_000, noise="noise=0.01"),
    Row("few-200", ("few",), 200),
    Row("few-200-noise", ("few",), 200, noise="noise=0.01"),
    Row("few-1000", ("few", "crossing"), 1_000),
    Row("few-1000-noise", ("few",), 1_000, noise="noise=0.01"),
    Row("three", ("objectives",), 10_000, ("absolute-3-objectives",), "", CONTROL, "points"),
    Row("four", ("objectives",), 10_000, ("absolute-4-objectives",), "", CONTROL, "points"),
)


def judged_rows(results: Results) -> list[dict[str, Any]]:
    """Every row's search, chosen on the first seeds and judged on fresh ones.

    Holm's p is over all comparisons by the same indicator.
    """
    rows = [judged(results, row) for row in ROWS]
    comparisons = [comparison for row in rows for comparison in row["comparisons"]]
    for name in INDICATORS:
        add_holm([one["by"][name] for one in comparisons if name in one["by"]])
    return rows


def add_holm_of_table(
    rows: Sequence[dict[str, Any]], arms: Mapping[str, Any], basins: Mapping[str, Any]
) -> None:
    """Add Holm's p over all comparisons of the table: its rows, the arms and several basins.

    Each is by the indicator of its row. Several basins have no fresh seeds: their search is the
    best of those that were run, and the p that counts here is Holm's over methods.
    """
    tests = [one["by"][row["measure"]] for row in rows for one in row["comparisons"]]
    if arms.get("judged"):
        tests.append(arms["judged"])
    cells = basins.get("posts", {}).get("cells")
    chosen = cells[-1]["search_against_slsqp"] if cells else {}
    *adjusted, of_basins = holm([*(test["p"] for test in tests), chosen.get("holm", np.nan)])
    for test, p in zip(tests, adjusted, strict=True):
        test["holm"] = p
    if chosen:
        chosen["holm_of_table"] = of_basins


def judged(results: Results, row: Row) -> dict[str, Any]:
    """A row with its search, the rival's settings and a comparison for each kind of problem."""
    by_kind = problems_of(results, row)
    every = [name for problems in by_kind.values() for name in problems]
    labels = [
        label
        for label, _ in searches_in(results, row.axes, row.budget, every, 5)
        if (f" {label}".partition(" noise=")[1] != "") == bool(row.noise)
        and "continuation" not in label
        and (not row.noise or label.endswith(row.noise))
    ]
    searches = [label for label in labels if not takes_slopes(label)]
    steps = [label for label in labels if label.partition(" ")[0] == DIFFERENCES]
    search = chosen_on_first(results, row, searches, by_kind)
    rival = CONTROL if row.rival == CONTROL else chosen_on_first(results, row, steps, by_kind)
    return {
        "row": row.name,
        "budget": row.budget,
        "measure": row.measure,
        "search": search,
        "rival": rival,
        "comparisons": [
            comparison
            for kind, problems in by_kind.items()
            if (comparison := judged_on(results, row, (search, rival), kind, problems))
        ],
    }


def problems_of(results: Results, row: Row) -> dict[str, list[str]]:
    """The problems of a row, by kind."""
    return {kind: results.problems(kind=kind) for kind in row.kinds}


def seeds_of(results: Results, row: Row, label: str, name: str, fresh: bool) -> list[Run]:
    """The runs of a method on a problem, of the first seeds or of fresh ones."""
    runs = results.of(label, row.budget, name)
    return [run for run in runs if (run.seed >= FIRST_SEEDS) == fresh]


def chosen_on_first(
    results: Results, row: Row, labels: Sequence[str], by_kind: Mapping[str, Sequence[str]]
) -> str:
    """The method of the least median gap on the first seeds, on problems that all have.

    Of those alone that were run on most problems of every kind that any was run on.
    """

    def known(label: str, problems: Sequence[str]) -> set[str]:
        return {name for name in problems if seeds_of(results, row, label, name, False)}

    def is_on_most(label: str, problems: Sequence[str]) -> bool:
        most = max(len(known(other, problems)) for other in labels)
        return 2 * len(known(label, problems)) > max(most, 1)

    of_all = [
        label
        for label in labels
        if all(is_on_most(label, problems) for problems in by_kind.values())
    ]
    worst = dict[str, float]()
    for label in of_all:
        medians = list[float]()
        for problems in by_kind.values():
            shared = set.intersection(*(known(other, problems) for other in of_all))
            runs = [seeds_of(results, row, label, name, False) for name in sorted(shared)]
            medians.append(float(np.median(results.median_gaps(runs, row.measure))))
        worst[label] = max(medians)
    return min(worst, key=lambda label: worst[label], default="")


def judged_on(
    results: Results, row: Row, pair: tuple[str, str], kind: str, problems: Sequence[str]
) -> dict[str, Any]:
    """A search and its rival on fresh seeds, by every indicator; nothing where there are none."""
    search, rival = pair
    ours = dict[str, list[Run]]()
    theirs = dict[str, list[Run]]()
    for name in problems:
        of_search = seeds_of(results, row, search, name, True)
        of_rival = seeds_of(results, row, rival, name, True)
        of_rival = results.control(name) if rival == CONTROL else of_rival
        if of_search and of_rival and results.control(name):
            ours[name], theirs[name] = of_search, of_rival
    if len(ours) < 5:
        return {}
    seeds = [len(runs) for runs in ours.values()]
    if rival != CONTROL:
        seeds = [min(pair) for pair in zip(seeds, map(len, theirs.values()), strict=True)]
    gaps = results.median_gaps(ours.values(), row.measure)
    gaps_of_rival = results.median_gaps(theirs.values(), row.measure)
    gaps_of_gradient = results.median_gaps(map(results.control, ours), row.measure)
    difference = gaps - gaps_of_rival
    plants = [Problem(name).plant for name in ours]
    by_plant = medians_by_plant(difference, plants)
    indicators = list(INDICATORS)
    if row.measure == "points":  # of three and four objectives there are no motions between
        indicators.remove("between")
    return {
        "kind": kind.removeprefix("absolute").removeprefix("-"),
        "moves": len(ours),
        "seeds": min(seeds),
        "missing": float(np.median(gaps)),
        "control": float(np.median(gaps_of_rival)),
        "gradient": float(np.median(gaps_of_gradient)),
        "equal": int((np.abs(difference) < EQUAL).sum()),
        "interval": interval(difference, plants),
        "without_motion": {"search": without_motion(ours), "rival": without_motion(theirs)},
        "plants": len(by_plant),
        "plants_better": int(sum(value < 0 for value in by_plant)),
        "by": {
            indicator: by_one_indicator(results, ours, theirs, indicator)
            for indicator in indicators
        },
    }


def without_motion(of_problems: Mapping[str, Sequence[Run]]) -> float:
    """Share of runs that have no motion within 1 mm."""
    runs = [run for of_problem in of_problems.values() for run in of_problem]
    return sum(not np.isfinite(run.energy) for run in runs) / len(runs)


def by_one_indicator(
    results: Results,
    ours: Mapping[str, list[Run]],
    theirs: Mapping[str, list[Run]],
    indicator: str,
) -> dict[str, Any]:
    """A search and its rival on the same problems, by an indicator, without Holm's p."""
    gaps = results.median_gaps(ours.values(), indicator)
    difference = gaps - results.median_gaps(theirs.values(), indicator)
    return {
        "better": int((difference < 0).sum()),
        "difference": float(np.median(difference)),
        "p": signed_ranks(difference),
    }
