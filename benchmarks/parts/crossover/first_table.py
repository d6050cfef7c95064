"""The first table of the report: what to take, from the rows that fresh seeds have judged."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from .plan import AGAIN
from .words import bold, p_value, short_label, two_digits, without_noise

LEVEL = 0.05
TITLES = {
    "model": "a model that you trust",
    "smooth": "only values, smooth, no limits",
    "limits": "only values, limits on torque or jerk",
    "limits-1000": "limits, 1,000 candidates",
    "limits-200": "limits, 200 candidates",
    "jumps": "values that jump",
    "noise": "values with 1 % of noise",
    "few-200": "200 candidates, no limits",
    "few-200-noise": "200 candidates, 1 % of noise",
    "few-1000": "1,000 candidates, no limits",
    "few-1000-noise": "1,000 candidates, 1 % of noise",
    "three": "a model, three objectives†",
    "four": "a model, four objectives†",
}
"""Rows as the report names them; † has gaps of points alone."""
INDICATORS = {
    "points": "hypervolume of 50 points",
    "between": "hypervolume with interpolated motions",
    "igd+": "IGD+",
    "epsilon": "additive epsilon",
    "energy": "energy within 1 mm",
}
OF_RIVAL = {"epsilon": "gradient", "slsqp": "slsqp"}
"""The table's column of each rival."""
Row = Mapping[str, Any]


def first_table(rows: Sequence[Row]) -> list[dict[str, str]]:
    """Return the cells of the table's lines, of the rows that have fresh seeds."""
    smooth = next((row for row in rows if row["row"] == "smooth"), None)
    of_values = range_of(one["control"] for one in smooth["comparisons"]) if smooth else "-"
    return [line_of(row, of_values) for row in rows if row["comparisons"]]


def line_of(row: Row, of_values: str) -> dict[str, str]:
    """Return a row's cells: what to take, gaps, on how many problems it is better, and p."""
    comparisons = row["comparisons"]
    winner, is_sure = verdict_of(row)
    better = sum(by_test(row, one)["better"] for one in comparisons)
    problems = sum(one["moves"] for one in comparisons)
    slsqp = range_of(one["control"] for one in comparisons)
    if row["rival"] == "epsilon":  # it sees what SLSQP cannot; of the same moves SLSQP's gap
        slsqp = of_values if row["row"] == "model" else "-"
    cells = {
        "search": f"{range_of(one['missing'] for one in comparisons)} ({label_of(row)})",
        "slsqp": slsqp,
        "gradient": range_of(one["gradient"] for one in comparisons),
    }
    taken = "search" if winner == "search" else OF_RIVAL[row["rival"]]
    cells[taken] = bold(cells[taken])
    if row["row"] == "jumps":  # its front there has fewer
        cells["gradient"] += " (20 points)"
    equal = sum(one["equal"] for one in comparisons)
    return {
        "title": TITLES[row["row"]],
        "take": take_words(row, winner, is_sure) + " (half equal)" * (2 * equal >= problems),
        **cells,
        "better": f"{better if winner == 'search' else problems - better}/{problems}",
        "equal": str(equal),
        "p": p_words(row),
    }


def by_test(row: Row, comparison: Row, indicator: str = "") -> Row:
    """The test of a comparison by an indicator, by that of the row without one."""
    return comparison["by"][indicator or row["measure"]]


def verdict_of(row: Row, indicator: str = "") -> tuple[str, bool]:
    """Return who is better, 'search' or 'rival', and whether that is sure.

    Sure is a winner with a significant difference on more than half of the kinds of problem, where
    the other has none. Without any, the one with the smaller gap on most kinds is named.
    """
    tests = [by_test(row, one, indicator) for one in row["comparisons"]]
    clear = [test for test in tests if is_clear(test)]
    wins = sum(test["difference"] < 0 for test in clear)
    losses = len(clear) - wins
    if wins == losses:
        smaller = sum(test["difference"] < 0 for test in tests)
        return "search" if 2 * smaller > len(tests) else "rival", False
    is_sure = min(wins, losses) == 0 and 2 * max(wins, losses) > len(tests)
    return "search" if wins > losses else "rival", is_sure


def take_words(row: Row, winner: str, is_sure: bool) -> str:
    """Return what to take, with the words for what is not sure."""
    rival = "the gradient" if row["rival"] == "epsilon" else "`slsqp`"
    taken = f"`{row['search'].partition(' ')[0]}`" if winner == "search" else rival
    if winner == "search" and "reevaluate" in row["search"]:
        taken = f"`{row['search'].partition(' ')[0]} --reevaluate {AGAIN}`"
    if is_sure:
        return taken
    if any(is_clear(by_test(row, one)) for one in row["comparisons"]):
        return f"tentative: {taken}"
    return f"not significant: {taken}"


def p_words(row: Row) -> str:
    """Return the adjusted p, or of how many kinds of problem the difference is significant."""
    comparisons = row["comparisons"]
    if len(comparisons) == 1:
        return p_value(by_test(row, comparisons[0])["holm"])
    clear = [one for one in comparisons if is_clear(by_test(row, one))]
    if len(clear) == len(comparisons):
        return f"< {LEVEL} for all"
    return f"< {LEVEL} for {len(clear)} of {len(comparisons)}" if clear else f"> {LEVEL}"


def kind_of(row: Row, comparison: Row) -> str:
    """Return the kind of problem, of a row that has several; a dash else."""
    return comparison["kind"].replace("-", ", ") if row["row"].startswith("limits") else "-"


def label_of(row: Row) -> str:
    """Return the search as tables call it."""
    return short_label(without_noise(row["search"]))


def range_of(values: Iterable[float]) -> str:
    """The least and the largest value, with two digits; one where they are the same."""
    known = sorted(values)
    first, last = two_digits(known[0]), two_digits(known[-1])
    return first if first == last else f"{first} to {last}"


def seeds_of(rows: Sequence[Row]) -> str:
    """Return the least and the largest number of fresh seeds of the rows."""
    known = sorted(one["seeds"] for row in rows for one in row["comparisons"])
    return f"{known[0]} to {known[-1]}" if known[0] < known[-1] else str(known[0])


def least_p(rows: Sequence[Row], problems: int = 10) -> float:
    """Return the least adjusted p of the comparisons on so many problems."""
    return min(
        by_test(row, one)["holm"]
        for row in rows
        for one in row["comparisons"]
        if one["moves"] == problems
    )


def indicator_words(row: Row, comparison: Row, indicator: str) -> str:
    """Return on how many problems the search is better, and who is with a verdict."""
    if indicator not in comparison["by"]:
        return "-"
    test = comparison["by"][indicator]
    rival = "gradient" if row["rival"] == "epsilon" else "SLSQP"
    sure = is_clear(test)
    who = ("search" if test["difference"] < 0 else rival) if sure else "not significant"
    return f"{test['better']} of {comparison['moves']}: {who}"


def by_indicators(rows: Sequence[Row]) -> dict[str, int]:
    """Count what other indicators say of the table's comparisons.

    Of those that are significant: how many are not by some other indicator, and how many are
    reversed by one.
    """
    counts = {"verdicts": 0, "lost": 0, "turned": 0}
    for row in rows:
        for one in row["comparisons"]:
            side = side_of(one["by"][row["measure"]])
            if not side:
                continue
            others = {side_of(by) for name, by in one["by"].items() if name != row["measure"]}
            turned = -side in others
            counts["verdicts"] += 1
            counts["turned"] += turned
            counts["lost"] += 0 in others
    return counts


def side_of(test: Row) -> int:
    """Return -1 where the search is better with a verdict, 1 where its rival is, 0 else."""
    if not is_clear(test):
        return 0
    return -1 if test["difference"] < 0 else 1


def is_clear(test: Row) -> bool:
    """Return whether a difference is significant; one that has no p is not."""
    return test["holm"] is not None and test["holm"] <= LEVEL
