"""Features of problems: which of them tells whether a search wins, and by how much."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata, spearmanr

from .experiment import takes_slopes
from .gaps import MEASURES, Results
from .runs import Array, Problem

FEATURES = ("coefficients", "best_basin", "condition", "walk_residual", "walk_energy",
            "within_1mm", "within_5mm", "opposed")  # fmt: skip


def prediction_figures(results: Results, crossed: Sequence[str]) -> dict[str, Any]:
    """What tells the winner with 10,000 candidates, by measure; nothing without landscapes.csv."""
    if not (results.folder / "landscapes.csv").exists():
        return {}
    return {measure: prediction(results, 10_000, crossed, measure) for measure in MEASURES}


def prediction(
    results: Results, budget: int, crossed: Sequence[str], measure: str
) -> dict[str, Any]:
    """What tells the winner: features of problems, tested on plants that were left out.

    The outcome of a problem is the logarithm of what the nearest search lacks over what the
    gradient lacks. A rule is a feature and a threshold that tell the sign best; it is made from
    four plants and tried on the fifth, beside the rule that always says what is more frequent.
    """
    path = results.folder / "landscapes.csv"
    with path.open(newline="") as file:
        rows = {row["problem"]: row for row in csv.DictReader(file)}
    data = list[tuple[str, list[float], float]]()
    shown = list[dict[str, Any]]()
    for name, row in sorted(rows.items()):
        searches = [label for label in crossed if not takes_slopes(label)]
        runs = [r for label in searches if (r := results.of(label, budget, name))]
        if len(runs) < len(searches) or not results.control(name):
            continue
        lacks = min(results.median(r, results.gap, measure) for r in runs)
        theirs = results.median(results.control(name), results.gap, measure)
        values = [float(row[feature] or "nan") for feature in FEATURES]
        outcome = float(np.log10(max(lacks, 1e-3) / max(theirs, 1e-3)))
        data.append((Problem(name).plant, values, outcome))
        shown.append(
            {"problem": name, "plant": Problem(name).plant, "outcome": outcome}
            | dict(zip(FEATURES, values, strict=True))
        )
    if not data:
        return {"problems": 0}
    plants = np.array([plant for plant, _, _ in data])
    table = np.array([values for _, values, _ in data])
    outcome = np.array([value for _, _, value in data])
    correlations = {}
    for i, feature in enumerate(FEATURES):
        known = np.isfinite(table[:, i])
        varied = known.sum() > 2 and np.ptp(table[known, i]) > 0
        correlations[feature] = (
            float(spearmanr(table[known, i], outcome[known]).statistic) if varied else None
        )
    within = {
        feature: within_equal(table[:, 0], table[:, i], outcome)
        for i, feature in enumerate(FEATURES)
        if i > 0
    }
    right = 0
    usual = 0
    rules = list[str]()
    for plant in sorted(set(plants)):
        out = plants == plant
        rule = stump(table[~out], outcome[~out] < 0)
        rules.append(FEATURES[rule[0]])
        guess = (table[out, rule[0]] > rule[1]) == rule[2]
        right += int((guess == (outcome[out] < 0)).sum())
        usual += int(((outcome[out] < 0) == ((outcome[~out] < 0).mean() > 0.5)).sum())
    return {
        **how_far(table, outcome, plants),
        "problems": len(data),
        "search_nearer": int((outcome < 0).sum()),
        "correlations": correlations,
        "within": within,
        "right": right,
        "usual": usual,
        "rules": rules,
        "holds": right > usual,
        "one_basin": sum(row["best_basin"] >= 1.0 for row in shown),
        "with_basins": sum(bool(np.isfinite(row["best_basin"])) for row in shown),
        "strongest": strongest_of(correlations),
        "least_basin": float(np.nanmin([row["best_basin"] for row in shown])),
        "table": shown,
    }


def within_equal(groups: Array, feature: Array, outcome: Array) -> float | None:
    """Rank correlation among problems of one group, as of equal coefficients; of all groups.

    Ranks are those within a group, about its mean, as shares of its size.
    """
    pairs = list[Array]()
    for group in np.unique(groups):
        members = (groups == group) & np.isfinite(feature)
        size = int(members.sum())
        if size < 3:
            continue
        ranks = np.column_stack([rankdata(feature[members]), rankdata(outcome[members])])
        pairs.append((ranks - (size + 1) / 2) / size)
    if not pairs:
        return None
    first, second = np.vstack(pairs).T
    if not (first.any() and second.any()):
        return None
    return float(first @ second / np.sqrt((first @ first) * (second @ second)))


def strongest_of(correlations: Mapping[str, float | None]) -> list[str | float]:
    """The two features with the largest rank correlations, each with its own."""
    known = [(name, value) for name, value in correlations.items() if value is not None]
    known.sort(key=lambda pair: -abs(pair[1]))
    return [entry for pair in known[:2] for entry in pair]


def how_far(table: Array, outcome: Array, plants: NDArray[np.str_]) -> dict[str, Any]:
    """How well one feature predicts the outcome itself on plants that were left out.

    The feature with the largest rank correlation on the other plants, a straight line over its
    logarithm; explained is the share of the squared distances from the others' mean.
    """
    logarithms = np.log10(np.maximum(table, 1e-4))
    missed = 0.0
    total = 0.0
    chosen = list[str]()
    for plant in sorted(set(plants)):
        out = plants == plant
        strength = [
            abs(spearmanr(column[~out], outcome[~out]).statistic)
            if np.isfinite(column).all() and np.ptp(column[~out]) > 0
            else 0.0
            for column in logarithms.T
        ]
        best = int(np.argmax(strength))
        chosen.append(FEATURES[best])
        slope, level = np.polyfit(logarithms[~out, best], outcome[~out], 1)
        missed += float(np.sum((outcome[out] - level - slope * logarithms[out, best]) ** 2))
        total += float(np.sum((outcome[out] - outcome[~out].mean()) ** 2))
    return {"explained": 1 - missed / total, "by": chosen}


def stump(table: Array, wins: NDArray[np.bool_]) -> tuple[int, float, bool]:
    """The feature, threshold and side that tell wins most often."""
    best = (-1, 0, 0.0, True)
    for i in range(table.shape[1]):
        values = np.unique(table[np.isfinite(table[:, i]), i])
        for threshold in (values[1:] + values[:-1]) / 2:
            for side in (True, False):
                score = int((((table[:, i] > threshold) == side) == wins).sum())
                if score > best[0]:
                    best = (score, i, float(threshold), side)
    return best[1:]
