"""Whether the runs in a contest's folder found what their files say."""

from __future__ import annotations

from pathlib import Path

from metaheuristics.objective.claims import check_figures
from studies.comparison.staircase import objectives
from studies.contest.imported import Imported
from studies.contest.problems import Yardstick
from studies.contest.runs import Run

_AGREEMENT = 2e-3
"""Hypervolumes of a front and of its search differ by less: the front's figures are of finer
steps."""
_REMEDY = "remove it to have it made again"


def check_run(run: Run | Imported, yardstick: Yardstick, path: Path) -> None:
    """Refuse a run whose figures, or whose last mark, are not those of its motions.

    Parameters
    ----------
    run : Run or Imported
        What a file holds.
    yardstick : Yardstick
        The exact front of its problem, in whose extent the run was measured.
    path : Path
        The file, for the message.

    Raises
    ------
    ValueError
        When motions of the front have other figures, or the last mark is neither the hypervolume
        of the front nor possible at all.
    """
    check_figures(run.front, str(path), _REMEDY)
    if isinstance(run, Run):
        _check_end(run, yardstick, path)


def _check_end(run: Run, yardstick: Yardstick, path: Path) -> None:
    end, own = run.marks[-1], run.scale.hypervolume(objectives(run.front))
    states = (
        f"{path}: its mark after {end.evaluations} evaluations states hypervolume "
        f"{end.hypervolume:.6g}"
    )
    if end.hypervolume > yardstick.hypervolume + _AGREEMENT:
        best = yardstick.hypervolume
        raise ValueError(f"{states}, and the exact front has {best:.6g}; {_REMEDY}")
    # with limits, motions that break one a little on the finer steps are not in the front
    beyond = own - end.hypervolume if run.front.task.limits else abs(own - end.hypervolume)
    if not beyond <= _AGREEMENT:
        raise ValueError(f"{states}, but its front dominates {own:.6g}; {_REMEDY}")
