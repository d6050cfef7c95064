"""Limits of the moves: on torque, or on acceleration and jerk, each tight and loose.

The rule. A limit is a share of the peaks of the plan at rest with six coefficients and no limit.
The least share for which the gradient still finds a plan at rest is sought in steps of 0.05; a
tight limit lies a quarter of the way from there to 1, a loose one three quarters.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd

import quietarm as qa

from .moves import Move
from .tables import write_table

TABLE = Path(__file__).parents[3] / "docs" / "results" / "limits.csv"
OF_TUNING = TABLE.with_name("limits_of_tuning.csv")
"""Limits of the moves of tuning, written before the first of them is tuned."""
STEP = 0.05
WAY = {"tight": 0.25, "loose": 0.75}
"""How far a limit lies from the least share to 1."""
QUANTITIES = {"torque": ("torque",), "jerk": ("acceleration", "jerk")}
"""What a kind of limit bounds."""
LIMITS = tuple(f"{kind}-{way}" for kind in QUANTITIES for way in WAY)


def limits_of(move: str, name: str) -> dict[str, float]:
    """Return the limits of a move by their names in a task; none without a name."""
    if not name:
        return {}
    tested = _limits(TABLE)
    return tested[move, name] if (move, name) in tested else _limits(OF_TUNING)[move, name]


@cache
def _limits(path: Path) -> dict[tuple[str, str], dict[str, float]]:
    table = pd.read_csv(path)
    limits = dict[tuple[str, str], dict[str, float]]()
    for row in table.itertuples():
        of_move = limits.setdefault((row.move, row.limits), {})
        of_move[f"{row.quantity}_limit"] = row.value
    return limits


def write_limits(moves: list[Move], path: Path = TABLE) -> None:
    """Compute the limits of moves, and write them as a table."""
    rows = [row for move in moves for kind in QUANTITIES for row in _rows(move, kind)]
    write_table(pd.DataFrame(rows), path, 10)


def _rows(move: Move, kind: str) -> list[dict[str, object]]:
    task = qa.PointToPoint(move.plant, move.target, move.duration)
    free = _plan(move, task)
    if free is None:
        raise qa.InfeasibleTaskError(f"{move.name} has no plan at rest within its box")
    peaks = {name: getattr(free.motion, f"peak_{name}") for name in QUANTITIES[kind]}
    least = 1.0
    for share in np.arange(1 - STEP, STEP / 2, -STEP):
        limits = {f"{name}_limit": share * peak for name, peak in peaks.items()}
        limited = qa.PointToPoint(move.plant, move.target, move.duration, **limits)
        if _plan(move, limited) is None:
            break
        least = float(share)
    return [
        {
            "move": move.name,
            "limits": f"{kind}-{way}",
            "quantity": name,
            "value": (least + part * (1 - least)) * peak,
            "least_share": least,
        }
        for way, part in WAY.items()
        for name, peak in peaks.items()
    ]


def _plan(move: Move, task: qa.PointToPoint) -> qa.Plan | None:
    try:
        return qa.plan_move(task, qa.CycloidPolynomial(6), bound=move.bound)
    except qa.QuietarmError:
        return None
