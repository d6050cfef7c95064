"""How much was run: runs, hours and seeds by axis, beside the plan."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import Any

from .gaps import Results
from .runs import Run, rows_of


def efforts(results: Results, folder: Path) -> dict[str, Any]:
    """Runs, hours and seeds by axis, beside the runs of the plan."""
    planned = rows_of(folder / "plan.csv")
    runs = defaultdict[str, list[Run]](list)
    for run in results.runs:
        runs[run.axis].append(run)
    return {
        "plan": {row["axis"]: int(row["jobs"]) for row in planned},
        "plan_hours": {row["axis"]: float(row["hours"]) for row in planned},
        "runs": {axis: len(rows) for axis, rows in runs.items()},
        "hours": {axis: sum(run.seconds for run in rows) / 3600 for axis, rows in runs.items()},
        "seeds": {axis: 1 + max(run.seed for run in rows) for axis, rows in runs.items()},
        "problems": len(results.whole),
    }
