"""The runs of the files: a row of runs/AXIS.csv.xz, and what the name of its problem says."""

from __future__ import annotations

import csv
import lzma
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
UNIT = 1e-4
"""Motions between are kept in whole multiples of this share of the scale."""


@dataclass(frozen=True)
class Run:
    """A row of a table of runs, with its points in the scale of its problem."""

    axis: str
    problem: str
    method: str
    settings: str
    budget: int
    seed: int
    seconds: float
    energy: float
    points: Array
    between: Array
    marks: Array

    @property
    def label(self) -> str:
        """The method with its settings."""
        return f"{self.method} {self.settings}".strip()


@dataclass(frozen=True)
class Problem:
    """What a problem's name says."""

    name: str

    @cached_property
    def move(self) -> str:
        """Its plant and number."""
        return re.split(r"(?<=-m\d)-", self.name)[0]

    @cached_property
    def plant(self) -> str:
        """Of its move."""
        return self.move.rpartition("-")[0]

    @cached_property
    def terms(self) -> int:
        """Coefficients."""
        return int(self.name.removeprefix(f"{self.move}-").partition("-")[0])

    @cached_property
    def kind(self) -> str:
        """Of its energy."""
        return self.name.removeprefix(f"{self.move}-").partition("-")[2]


def numbers(text: str) -> Array:
    """The numbers of a cell."""
    return np.array(text.split(), dtype=float)


def rows_of(path: Path) -> list[dict[str, str]]:
    """The rows of a table, which may be packed; none where it is missing."""
    if not path.exists():
        return []
    opened = lzma.open if path.suffix == ".xz" else open
    with opened(path, "rt", newline="") as file:
        return list(csv.DictReader(file))


def read_runs(folder: Path) -> list[Run]:
    """All runs of the tables of a folder."""
    scales = {row["problem"]: row for row in rows_of(folder / "scales.csv")}
    return [
        run_of(row, scales[row["problem"]], path.name.partition(".")[0])
        for path in sorted((folder / "runs").glob("*.csv.xz"))
        for row in rows_of(path)
    ]


def run_of(row: Mapping[str, str], scale: Mapping[str, str], axis: str) -> Run:
    """A row as a run."""
    least = np.append(
        np.array([scale["least_residual_m"], scale["least_energy_J"]], dtype=float),
        numbers(scale.get("least_peaks") or ""),
    )
    largest = np.append(
        np.array([scale["largest_residual_m"], scale["largest_energy_J"]], dtype=float),
        numbers(scale.get("largest_peaks") or ""),
    )
    points = np.column_stack([numbers(row["residuals_mm"]), numbers(row["energies_mJ"])]) * 1e-3
    for peak in filter(None, (row.get("peaks") or "").split(";")):
        points = np.column_stack([points, numbers(peak)])
    between = np.column_stack([numbers(row["between_residuals"]), numbers(row["between_energies"])])
    marks = [numbers(row[name]) for name in ("marks_evaluations", "marks_seconds", "marks_area")]
    return Run(
        axis,
        row["problem"],
        row["method"],
        row["settings"],
        int(row["budget"] or 0),
        int(row["seed"]),
        float(row["seconds"]),
        float(row["energy_1mm_J"]),
        (points - least) / (largest - least),
        between * UNIT,
        np.column_stack(marks),
    )
