"""Features of problems: which of them tells whether a search wins, and by how much.

The outcome of a problem is the decimal logarithm of what the nearest search lacks over what the
gradient lacks. Features are columns of landscapes.csv. A rule is made from all plants but one, and
tried on that one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata, spearmanr

from .comparing import LEAST_GAP
from .experiment import takes_slopes
from .gaps import MEASURES, Results
from .runs import Array, Problem, rows_of

FEATURES = ("coefficients", "best_basin", "condition", "walk_residual", "walk_energy",
            "within_1mm", "within_5mm", "opposed")  # fmt: skip


@dataclass(frozen=True)
class Outcomes:
    """Problems with their features, a column each, and who wins by how much."""

    problems: list[str]
    features: Array
    outcome: Array

    @property
    def plants(self) -> NDArray[np.str_]:
        """The plant of each problem."""
        return np.array([Problem(name).plant for name in self.problems])

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for each problem, as figures.json has it."""
        return [
            {"problem": name, "plant": Problem(name).plant, "outcome": float(outcome)}
            | {feature: float(value) for feature, value in zip(FEATURES, values, strict=True)}
            for name, values, outcome in zip(
                self.problems, self.features, self.outcome, strict=True
            )
        ]


def prediction_figures(
    results: Results, folder: Path, crossed: Sequence[str]
) -> dict[str, dict[str, Any]]:
    """What tells the winner with 10,000 candidates, by measure; nothing without landscapes.csv."""
    landscapes = {row["problem"]: row for row in rows_of(folder / "landscapes.csv")}
    if not landscapes:
        return {}
    searches = [(label, 10_000) for label in crossed if not takes_slopes(label)]
    return {
        measure: prediction(outcomes_of(results, landscapes, searches, measure))
        for measure in MEASURES
    }


def outcomes_of(
    results: Results,
    landscapes: Mapping[str, Mapping[str, str]],
    searches: Sequence[tuple[str, int]],
    measure: str,
) -> Outcomes:
    """The problems on which all searches, and the gradient, were run."""
    problems = list[str]()
    features = list[list[float]]()
    outcome = list[float]()
    for name, row in sorted(landscapes.items()):
        runs = [results.of(*search, name) for search in searches]
        if not (all(runs) and results.control(name)):
            continue
        lacks = min(results.median_gaps(runs, measure))
        theirs = results.median_gap(results.control(name), measure)
        problems.append(name)
        features.append([float(row[feature] or "nan") for feature in FEATURES])
        outcome.append(float(np.log10(max(lacks, LEAST_GAP) / max(theirs, LEAST_GAP))))
    return Outcomes(problems, np.array(features), np.array(outcome))


def prediction(data: Outcomes) -> dict[str, Any]:
    """How far features go together with the outcome, and what rules of them tell.

    A rule is a feature and a threshold that tell the outcome's sign best. Beside it stands the rule
    that always says what is more frequent.
    """
    if not data.problems:
        return {"problems": 0}
    basins = data.features[:, FEATURES.index("best_basin")]
    correlations = correlations_of(data)
    tested = rules_on_plants_left_out(data)
    return {
        **how_far(data),
        "problems": len(data.problems),
        "search_nearer": int((data.outcome < 0).sum()),
        "correlations": correlations,
        "within": {
            feature: within_equal(data.features[:, 0], column, data.outcome)
            for feature, column in zip(FEATURES[1:], data.features.T[1:], strict=True)
        },
        **tested,
        "holds": tested["right"] > tested["usual"],
        "one_basin": int((basins >= 1.0).sum()),
        "with_basins": int(np.isfinite(basins).sum()),
        "strongest": strongest_of(correlations),
        "least_basin": float(np.nanmin(basins)),
        "table": data.rows,
    }


def correlations_of(data: Outcomes) -> dict[str, float | None]:
    """Rank correlations of features with the outcome; None for one that is the same everywhere."""
    correlations = dict[str, float | None]()
    for feature, column in zip(FEATURES, data.features.T, strict=True):
        known = np.isfinite(column)
        varied = known.sum() > 2 and np.ptp(column[known]) > 0
        correlations[feature] = (
            float(spearmanr(column[known], data.outcome[known]).statistic) if varied else None
        )
    return correlations


def strongest_of(correlations: Mapping[str, float | None]) -> list[str | float]:
    """The two features with the largest rank correlations, each with its own."""
    known = [(name, value) for name, value in correlations.items() if value is not None]
    known.sort(key=lambda pair: -abs(pair[1]))
    return [entry for pair in known[:2] for entry in pair]


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


def rules_on_plants_left_out(data: Outcomes) -> dict[str, Any]:
    """On how many problems rules of other plants, and the usual winner there, tell the winner."""
    wins = data.outcome < 0
    right = 0
    usual = 0
    rules = list[str]()
    for plant in sorted(set(data.plants)):
        out = data.plants == plant
        column, threshold, side = stump(data.features[~out], wins[~out])
        rules.append(FEATURES[column])
        guess = (data.features[out, column] > threshold) == side
        right += int((guess == wins[out]).sum())
        usual += int((wins[out] == (wins[~out].mean() > 0.5)).sum())
    return {"right": right, "usual": usual, "rules": rules}


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


def how_far(data: Outcomes) -> dict[str, Any]:
    """How well one feature predicts the outcome itself on plants that were left out.

    The feature with the largest rank correlation on the other plants, a straight line over its
    logarithm; explained is the share of the squared distances from the others' mean.
    """
    outcome = data.outcome
    logarithms = np.log10(np.maximum(data.features, 1e-4))
    missed = 0.0
    total = 0.0
    chosen = list[str]()
    for plant in sorted(set(data.plants)):
        out = data.plants == plant
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
