"""The gradient's fronts: whether they repeat themselves, and where another run is below them."""

from __future__ import annotations

from typing import Any

import numpy as np

from .gaps import Results
from .runs import Problem


def repeats(results: Results) -> dict[str, int]:
    """On how many problems the gradient's fronts of two seeds are the same."""
    same = 0
    several = 0
    for problem in results.problems():
        runs = results.control(problem)
        if len(runs) < 2:
            continue
        several += 1
        first = runs[0].points
        same += all(
            len(first) == len(run.points) and np.abs(first - run.points).max() < 1e-5
            for run in runs[1:]
        )
    return {"problems": several, "same": same}


def beaten(results: Results) -> dict[str, Any]:
    """Where another run has less energy within 1 mm than the gradient's front of 50 points."""
    share = 0.1  # per cent: more than rounding and tolerances of the points
    excess = {
        name: results.excess(runs[0])
        for name in results.whole
        if not Problem(name).kind.endswith("objectives")
        and np.isfinite(results.least_energy[name])
        and (runs := results.control(name))
    }
    worse = {name: value for name, value in excess.items() if value > share}
    return {"problems": len(excess), "share": share, "excess": dict(sorted(worse.items()))}
