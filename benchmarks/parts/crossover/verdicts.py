"""For whom the cells of a map speak."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def verdicts(cells: Sequence[Mapping[str, Any]], way: str) -> dict[str, Any]:
    """Count the cells of a map that were run: how many have a verdict, and for whom."""
    rows = [(cell, cell["ways"][way]) for cell in cells if way in cell["ways"]]
    compared = [(cell, row) for cell, row in rows if not row["no_front"]]
    sure = [(cell, row) for cell, row in compared if row["verdict"]]
    could = [row for _, row in compared if row["enough"]]
    return {
        "run": len(rows),
        "search": [cell for cell, row in sure if row["log_ratio"] < 0],
        "gradient": [cell for cell, row in sure if row["log_ratio"] > 0],
        "alike": len(could) - len(sure),
        "too_few": len(compared) - len(could),
        "could": len(could),
        "no_front": [cell for cell, row in rows if row["no_front"]],
        "moves_nearer": sum(row["moves_nearer"] for _, row in compared),
        "moves": sum(row["compared"] for _, row in compared),
    }
