"""Expected running times, from what runs lacked mark by mark: of a bench, or of a file of marks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from quietarm.ocp.checks import quoted
from quietarm.ocp.escapes import csv_table
from quietarm.ocp.files import write_whole

Array = NDArray[np.float64]
TARGETS = (0.1, 0.03, 0.01, 0.003)
"""Shares of the reference front's hypervolume that may be missing for a target to count as
reached."""
COSTS = ("seconds", "evaluations")
"""What a running time counts."""


class History(NamedTuple):
    """The history of a run: what it lacked and had cost at each of its marks.

    Attributes
    ----------
    missing : ndarray, shape (marks,)
        Share of the reference front's hypervolume, or another indicator; NaN where it is not known.
    seconds, evaluations : ndarray, shape (marks,)
        Processor time [s] of the search; candidates simulated, NaN where they are not its cost.
    """

    missing: Array
    seconds: Array
    evaluations: Array

    def cost(self, by: str) -> Array:
        """Processor seconds or evaluations at each mark; ValueError by anything else."""
        if by not in COSTS:
            raise ValueError(f"by is {quoted(by)}; give {' or '.join(COSTS)}")
        return getattr(self, by)

    @property
    def improving(self) -> History:
        """The marks at which less is missing than at any before, and the last, where it ended."""
        best = np.fmin.accumulate(np.append(np.inf, self.missing))[:-1]
        improving = self.missing < best
        improving[-1] = True
        return History(*(column[improving] for column in self))


def hits(histories: Iterable[History], targets: Sequence[float], by: str = "seconds") -> Array:
    """Return where each run first missed no more than each target, shape (runs, targets).

    Infinite where it never did; a mark without a value reaches none.
    """
    rows = list[Array]()
    for history in histories:
        lowest = np.fmin.accumulate(np.append(np.inf, history.missing))[1:]
        first = np.searchsorted(-lowest, -np.array(targets))
        rows.append(np.append(history.cost(by), np.inf)[first])
    return np.array(rows)


def expected_running_time(
    histories: Sequence[History], target: float, by: str = "seconds"
) -> tuple[float, float, float]:
    """Effort of all runs until the target, or in all, divided by the number that reached it.

    As COCO defines it: runs that did not reach it are censored, not left out; infinite where none
    did.

    Returns
    -------
    time, low, high : float
        The expected running time, and the ends of its interval of 95 %: runs drawn again with
        replacement.
    """
    # the quantiles that are the ends of an interval
    interval = (0.025, 0.975)
    first = hits(histories, [target], by)[:, 0]
    ends = np.array([history.cost(by)[-1] for history in histories])
    reached = np.isfinite(first)
    if not reached.any():
        return np.inf, np.inf, np.inf
    drawn = _drawn_again(len(first))
    spent = np.where(reached, first, ends)[drawn].sum(axis=1)
    count = reached[drawn].sum(axis=1)
    times = np.where(count, spent / np.maximum(count, 1), np.inf)
    low, high = np.quantile(times[1:], interval, method="inverted_cdf").tolist()
    return float(times[0]), low, high


def _drawn_again(runs: int) -> NDArray[np.int64]:
    """Numbers of runs: all of them, then drawn again with replacement, a row each."""
    # how often runs are drawn again for an interval
    times_drawn = 1000
    again = np.random.default_rng(0).integers(0, runs, (times_drawn, runs))
    return np.vstack([np.arange(runs), again])


def running_times(groups: Mapping[tuple[str, str], Sequence[History]]) -> pd.DataFrame:
    """Expected running times to `TARGETS`, with intervals, and how many runs reached each.

    The histories are by problem and method. Evaluations are given where all marks count them.
    """
    rows = list[dict[str, Any]]()
    for (problem, method), histories in sorted(groups.items()):
        reached = np.isfinite(hits(histories, TARGETS)).sum(axis=0)
        counts_candidates = all(np.isfinite(history.evaluations).all() for history in histories)
        for target, count in zip(TARGETS, reached.tolist()):
            row = {
                "problem": problem,
                "method": method,
                "target": target,
                "reached": count,
                "runs": len(histories),
            }
            for by in COSTS if counts_candidates else COSTS[:1]:
                times = expected_running_time(histories, target, by)
                row |= zip((by, f"{by}_low", f"{by}_high"), times)
            rows.append(row)
    return pd.DataFrame(rows).replace(np.inf, np.nan)


def write_histories(
    histories: Iterable[tuple[str, str, int | None, History]], path: str | Path
) -> None:
    """Write the improving marks of runs, each with its problem, method and seed, as a table.

    A mark is a row of csv, compressed where the name ends in .gz.
    """
    tables = [
        pd.DataFrame(history.improving._asdict()).assign(
            problem=problem,
            method=method,
            seed=seed,
        )
        for problem, method, seed, history in histories
    ]
    columns = ["problem", "method", "seed", *History._fields]
    text = csv_table(pd.concat(tables)[columns], "%.9g")
    content = text.encode()
    if Path(path).suffix == ".gz":
        import gzip

        content = gzip.compress(content, mtime=0)  # the same content is the same file
    write_whole(path, content)


def read_histories(path: str | Path) -> dict[tuple[str, str], list[History]]:
    """The histories that `write_histories` wrote, by problem and method, for `running_times`."""
    table = pd.read_csv(path)
    groups: dict[tuple[str, str], list[History]] = {}
    by_run: Any = table.groupby(["problem", "method", "seed"], sort=False, dropna=False)
    for (problem, method, _), marks in by_run:
        columns = (marks[name].to_numpy(dtype=float) for name in History._fields)
        groups.setdefault((problem, method), []).append(History(*columns))
    return groups
