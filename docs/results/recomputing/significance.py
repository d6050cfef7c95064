"""Whether a difference over moves is luck: signed ranks, Holm's correction, intervals."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import wilcoxon

from .runs import Array

LEVEL = 0.05
"""A difference with a smaller p is a verdict."""


def holm(values: Sequence[float]) -> list[float]:
    """Adjusted p values; those that are missing stay so and do not count."""
    order = sorted((p, i) for i, p in enumerate(values) if np.isfinite(p))
    adjusted = [float("nan")] * len(values)
    largest = 0.0
    for rank, (p, i) in enumerate(order):
        largest = max(largest, min(1.0, p * (len(order) - rank)))
        adjusted[i] = largest
    return adjusted


def add_holm(rows: Sequence[dict[str, Any]]) -> None:
    """Add to rows that were tested together, each with its p, Holm's p; a row may have no p."""
    for row, adjusted in zip(rows, holm([row.get("p", np.nan) for row in rows]), strict=True):
        row["holm"] = adjusted


def median_or_nan(values: Array) -> float:
    """The median; NaN where there are no values."""
    return float(np.median(values)) if len(values) else float("nan")


def least_p(moves: int) -> float:
    """The smallest p that signed ranks of so many moves can give."""
    return 2 / 2**moves


def signed_ranks(differences: Array) -> float:
    """Wilcoxon's p, two-sided; NaN where nothing differs."""
    differences = differences[differences != 0]
    return float(wilcoxon(differences).pvalue) if len(differences) else float("nan")


def interval(values: Array, plants: Sequence[str], draws: int = 2000) -> tuple[float, float]:
    """Of the median over moves, 95 %: plants are drawn again, then moves of each."""
    places, counts = drawn_again(tuple(plants), draws)
    drawn = np.sort(np.append(values, np.inf)[places], axis=1)  # what is beyond a count is last
    rows = np.arange(draws)
    medians = (drawn[rows, (counts - 1) // 2] + drawn[rows, counts // 2]) / 2
    low, high = np.quantile(medians, [0.025, 0.975])
    return float(low), float(high)


@cache
def drawn_again(plants: tuple[str, ...], draws: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Places of moves in each draw of plants and moves, -1 beyond their count; and the counts."""
    random = np.random.default_rng(52)
    blocks = [np.flatnonzero(np.array(plants) == plant) for plant in sorted(set(plants))]
    places = np.full((draws, len(blocks) * max(map(len, blocks))), -1)
    counts = np.empty(draws, dtype=np.intp)
    for draw in range(draws):
        chosen = random.integers(len(blocks), size=len(blocks))
        moves = np.concatenate([random.choice(blocks[i], len(blocks[i])) for i in chosen])
        counts[draw] = len(moves)
        places[draw, : len(moves)] = moves
    return places, counts
