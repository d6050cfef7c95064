"""Tables beside the runs: how they are written, and the trials by which settings were tuned."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pandas as pd


def write_table(table: pd.DataFrame, path: Path, digits: int) -> None:
    """A table in the place of the one that is there, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".tmp")
    table.to_csv(temporary, index=False, float_format=f"%.{digits}g")
    os.replace(temporary, path)


def read_trials(path: Path) -> pd.DataFrame:
    """The table of trials."""
    if path.exists():
        return pd.read_csv(path)
    names = ("cell", "method", "budget", "trial", "score", "settings")
    return pd.DataFrame({name: [] for name in names})


def best_settings(path: Path) -> dict[tuple[str, str], tuple[tuple[str, Any], ...]]:
    """The best trial's settings by cell and method, as a plan takes them.

    A method with fewer trials is being tuned still, and left out.
    """
    fewest = 8
    table = read_trials(path)
    table = table[table.groupby(["cell", "method"])["trial"].transform("size") >= fewest]
    best = {
        (str(cell), str(method)): json.loads(rows.loc[rows["score"].idxmin(), "settings"])
        for (cell, method), rows in table.groupby(["cell", "method"])
    }
    return {place: tuple(sorted(settings.items())) for place, settings in best.items()}
