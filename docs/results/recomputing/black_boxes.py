"""Black boxes that are no model: gaps of the runs in black_box.csv."""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path
from typing import Any

import moocore
import numpy as np

from .areas import area
from .runs import numbers


def black_box_figures(folder: Path) -> list[dict[str, Any]]:
    """Gaps on black boxes, of the points alone, to the best points of all runs [%].

    The scale goes from the least to the largest values of those points.
    """
    path = folder / "black_box.csv"
    if not path.exists():
        return []
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    figures = list[dict[str, Any]]()
    for problem in dict.fromkeys(row["problem"] for row in rows):
        of_problem = [row for row in rows if row["problem"] == problem]
        points = [
            np.column_stack([numbers(row["residuals_mm"]), numbers(row["energies_mJ"])])
            for row in of_problem
        ]
        best = moocore.filter_dominated(np.vstack(points))
        least = best.min(axis=0)
        extent = np.ptp(best, axis=0)
        whole = area((best - least) / extent)
        gaps = defaultdict[tuple[str, int], list[float]](list)
        seconds = defaultdict[tuple[str, int], list[float]](list)
        for row, found in zip(of_problem, points, strict=True):
            key = row["method"], int(row["candidates"])
            gaps[key].append(100 * (1 - area((found - least) / extent) / whole))
            seconds[key].append(float(row["seconds"]))
        figures += [
            {
                "problem": problem,
                "method": method,
                "candidates": candidates,
                "runs": len(values),
                "missing": float(np.median(values)),
                "least": min(values),
                "most": max(values),
                "seconds": float(np.median(seconds[method, candidates])),
            }
            for (method, candidates), values in gaps.items()
        ]
    return figures
