"""Black boxes that are no model: gaps of the runs in black_box.csv."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from .areas import gaps_to_best
from .runs import numbers, rows_of


def black_box_figures(folder: Path) -> list[dict[str, Any]]:
    """Gaps on black boxes, of the points alone, to the best points of all runs [%]."""
    rows = rows_of(folder / "black_box.csv")
    figures = list[dict[str, Any]]()
    for problem in dict.fromkeys(row["problem"] for row in rows):
        of_problem = [row for row in rows if row["problem"] == problem]
        fronts = [
            np.column_stack([numbers(row["residuals_mm"]), numbers(row["energies_mJ"])])
            for row in of_problem
        ]
        gaps = defaultdict[tuple[str, int], list[float]](list)
        seconds = defaultdict[tuple[str, int], list[float]](list)
        for row, gap in zip(of_problem, gaps_to_best(fronts), strict=True):
            key = row["method"], int(row["candidates"])
            gaps[key].append(gap)
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
