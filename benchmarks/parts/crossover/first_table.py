"""The first table of the report: what to take, from the rows that fresh seeds have judged."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from .words import p_value, short_label, two_digits, without_noise

LEVEL = 0.05
TITLES = {
    "model": "a model that you trust",
    "smooth": "only values, smooth, no limits",
    "limits": "only values, limits on torque or jerk",
    "limits-1000": "the same, 1,000 candidates",
    "limits-200": "the same, 200 candidates",
    "jumps": "only values that jump",
    "noise": "only values, 1 % of noise",
    "few-200": "only values, 200 candidates",
    "few-200-noise": "the same, 1 % of noise",
    "few-1000": "only values, 1,000 candidates",
    "few-1000-noise": "the same, 1 % of noise",
    "three": "a model, three objectives",
    "four": "a model, four objectives",
}
"""Rows as the report names them; a row that says 'the same' stands below the one that it means."""
INDICATORS = {
    "points": "hypervolume of 50 points",
    "between": "hypervolume with interpolated motions",
    "igd+": "IGD+",
    "epsilon": "additive epsilon",
    "energy": "energy within 1 mm",
}
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
    better = sum(test_of(row, one)["better"] for one in comparisons)
    problems = sum(one["moves"] for one in comparisons)
    slsqp = range_of(one["control"] for one in comparisons)
    if row["rival"] == "epsilon":  # it sees what SLSQP cannot; of the same moves SLSQP's gap
        slsqp = of_values if row["row"] == "model" else "-"
    return {
        "title": TITLES[row["row"]],
        "take": take_words(row, winner, is_sure),
        "search": f"{range_of(one['missing'] for one in comparisons)} ({label_of(row)})",
        "slsqp": slsqp,
        "gradient": range_of(one["gradient"] for one in comparisons),
        "better": f"{better if winner == 'search' else problems - better} of {problems}",
        "equal": str(sum(one["equal"] for one in comparisons)),
        "p": p_words(row),
    }


def test_of(row: Row, comparison: Row, indicator: str = "") -> Row:
    """The test of a comparison by an indicator, by that of the row without one."""
    return comparison["by"][indicator or row["measure"]]


def verdict_of(row: Row, indicator: str = "") -> tuple[str, bool]:
    """Return who is better, 'search' or 'rival', and whether that is sure.

    Sure is a winner with a significant difference on at least half of the kinds of problem, where
    the other has none. Without any, the one with the smaller gap on most kinds is named.
    """
    tests = [test_of(row, one, indicator) for one in row["comparisons"]]
    clear = [test for test in tests if (test["holm"] or 1.0) <= LEVEL]
    wins = sum(test["difference"] < 0 for test in clear)
    losses = len(clear) - wins
    if wins and not losses:
        return "search", 2 * wins >= len(tests)
    if losses and not wins:
        return "rival", 2 * losses >= len(tests)
    return "search" if 2 * sum(t["difference"] < 0 for t in tests) > len(tests) else "rival", False


def take_words(row: Row, winner: str, is_sure: bool) -> str:
    """Return what to take, with the words for what is not sure."""
    search = f"`quietarm search --method {row['search'].partition(' ')[0]}`"
    gradient = row["rival"] == "epsilon"
    rival = "the gradient: `quietarm front`" if gradient else "`quietarm search --method slsqp`"
    taken = search if winner == "search" else rival
    if is_sure:
        return taken
    if any((test_of(row, one)["holm"] or 1.0) <= LEVEL for one in row["comparisons"]):
        return f"tentative: {taken}"
    return f"not significant: {taken}"


def p_words(row: Row) -> str:
    """Return the adjusted p, or of several kinds of problem those with a significant difference."""
    comparisons = row["comparisons"]
    if len(comparisons) == 1:
        return p_value(test_of(row, comparisons[0])["holm"])
    clear = [
        one["kind"].replace("-", ", ")
        for one in comparisons
        if (test_of(row, one)["holm"] or 1.0) <= LEVEL
    ]
    if len(clear) == len(comparisons):
        return f"< {LEVEL} for all {len(clear)} kinds"
    return f"< {LEVEL} for {'; '.join(clear)}" if clear else f"> {LEVEL}"


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


def indicator_words(row: Row, comparison: Row, indicator: str) -> str:
    """Return on how many problems the search is better, and who is with a verdict."""
    if indicator not in comparison["by"]:
        return "-"
    test = comparison["by"][indicator]
    rival = "gradient" if row["rival"] == "epsilon" else "SLSQP"
    sure = (test["holm"] or 1.0) <= LEVEL
    who = ("search" if test["difference"] < 0 else rival) if sure else "not significant"
    return f"{test['better']} of {comparison['moves']}: {who}"


def by_indicators(rows: Sequence[Row]) -> dict[str, Any]:
    """Count what other indicators say of the comparisons that have a verdict.

    Kept by all, lost by some, and turned round by some; and by which these are.
    """
    counts = {"verdicts": 0, "kept": 0, "lost": 0}
    turned = list[str]()
    for row in rows:
        for one in row["comparisons"]:
            test = test_of(row, one)
            if (test["holm"] or 1.0) > LEVEL:
                continue
            counts["verdicts"] += 1
            others = {name: by for name, by in one["by"].items() if name != row["measure"]}
            same = {
                name: by["difference"] * test["difference"] > 0 and (by["holm"] or 1.0) <= LEVEL
                for name, by in others.items()
            }
            against = [
                name
                for name, by in others.items()
                if by["difference"] * test["difference"] < 0 and (by["holm"] or 1.0) <= LEVEL
            ]
            kind = f", {one['kind'].replace('-', ', ')}" if len(row["comparisons"]) > 1 else ""
            turned += [f"{TITLES[row['row']]}{kind}, by {INDICATORS[name]}" for name in against]
            counts["kept"] += all(same.values())
            counts["lost"] += not all(same.values()) and not against
    return {**counts, "turned": turned}
