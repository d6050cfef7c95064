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
    return pd.DataFrame({"method": [], "budget": [], "trial": [], "score": [], "settings": []})


def best_settings(path: Path, budget: int) -> dict[str, tuple[tuple[str, Any], ...]]:
    """The best trial's settings by method, as a plan takes them.

    A method with fewer trials is being tuned still, and left out.
    """
    fewest = 20
    table = read_trials(path)
    table = table[table["budget"] == budget]
    table = table[table.groupby("method")["trial"].transform("size") >= fewest]
    best = {
        method: json.loads(rows.loc[rows["score"].idxmin(), "settings"])
        for method, rows in table.groupby("method")
    }
    return {method: tuple(sorted(settings.items())) for method, settings in best.items()}
