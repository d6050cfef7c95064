"""Runs as rows of tables, one table an axis: what a page is computed from, and what goes on.

A row has the run's effort, its 50 points of greatest hypervolume, of two objectives the 100 of
greatest hypervolume of the points with motions between them, and what was dominated at marks on the
way. Peaks are in SI units, a list for each, with a semicolon between. The scale of a
problem is that of its quick front (`problems.py`): 0 and 1 are the front's least and largest
value of each objective. Areas, or volumes, are dominated up to 1.1 in that scale.
"""

from __future__ import annotations

import csv
import io
import lzma
import os
from collections.abc import Iterable
from pathlib import Path

import moocore
import numpy as np
from numpy.typing import NDArray

import quietarm as qa
from quietarm.metaheuristics.score import CORNER, Reference, filled, objectives
from quietarm.metaheuristics.thinning import thinned

from .plan import Planned
from .subset import best_subset

Array = NDArray[np.float64]
POINTS = 50
BETWEEN = 100
UNIT = 1e-4
"""Motions between are kept in whole multiples of this share of the scale."""
KEY = ("problem", "method", "settings", "budget", "seed")
EFFORT = ("seconds", "evaluations", "gradients", "hessians")
POINTS_COLUMNS = ("residuals_mm", "energies_mJ", "peaks", "between_residuals", "between_energies")
MARKS_COLUMNS = ("marks_evaluations", "marks_seconds", "marks_area")
COLUMNS = (*KEY, *EFFORT, "energy_1mm_J", *POINTS_COLUMNS, *MARKS_COLUMNS)
Row = dict[str, str]


def row_of(planned: Planned, front: qa.Front, scale: Reference) -> Row:
    """A run as a row."""
    points = objectives(front)
    chosen = points[best_subset(scale.scaled(points), POINTS)]
    dense = np.empty((0, 2))
    if points.shape[1] == 2:
        dense = scale.scaled(filled(front))
        dense = dense[best_subset(dense, BETWEEN)]
    last = front.history[-1]
    on_the_way = list(front.history[:-1])[::2] if len(front.entries) else []
    marks = [*on_the_way, last]
    areas = [area(scale.scaled(front.entries.objectives(mark.evaluations))) for mark in on_the_way]
    areas.append(area(scale.scaled(chosen)))
    return {
        **dict(zip(KEY, map(str, planned.key), strict=True)),
        "seconds": f"{last.seconds:.4g}",
        "evaluations": str(last.evaluations),
        "gradients": str(last.gradients),
        "hessians": str(last.hessians),
        "energy_1mm_J": f"{front.least_energy(1e-3):.6g}",
        "residuals_mm": _words(chosen[:, 0] * 1e3, ".5g"),
        "energies_mJ": _words(chosen[:, 1] * 1e3, ".6g"),
        "peaks": ";".join(_words(peak, ".5g") for peak in chosen[:, 2:].T),
        "between_residuals": _words(np.round(dense[:, 0] / UNIT), ".0f"),
        "between_energies": _words(np.round(dense[:, 1] / UNIT), ".0f"),
        "marks_evaluations": _words([mark.evaluations for mark in marks], "d"),
        "marks_seconds": _words([mark.seconds for mark in marks], ".3g"),
        "marks_area": _words(areas, ".5g"),
    }


def area(scaled: Array) -> float:
    """Return what the 50 best points of many dominate, up to the corner."""
    if not len(scaled):
        return 0.0
    points = moocore.filter_dominated(scaled)
    points = points[thinned(points)] if len(points) > 100 else points
    points = points[best_subset(points, POINTS)]
    corner = [CORNER] * points.shape[1]
    return float(moocore.hypervolume(points, ref=corner)) if len(points) else 0.0


def _words(values: Iterable[float], form: str) -> str:
    return " ".join(format(value, form) for value in values)


def read_rows(path: Path) -> list[Row]:
    """The rows of a table; none where it is missing."""
    if not path.exists():
        return []
    with lzma.open(path, "rt", newline="") as file:
        return list(csv.DictReader(file))


def write_rows(rows: Iterable[Row], path: Path) -> None:
    """A table of rows in order of their keys, in the place of the one that is there.

    The same rows give the same bytes.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(sorted(rows, key=key_of))
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".tmp")
    temporary.write_bytes(lzma.compress(text.getvalue().encode(), preset=9 | lzma.PRESET_EXTREME))
    os.replace(temporary, path)


def key_of(row: Row) -> tuple[str, str, str, str, int]:
    """Return what tells a run from all others, as `Planned.key`."""
    return row["problem"], row["method"], row["settings"], row["budget"], int(row["seed"])
