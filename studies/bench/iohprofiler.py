"""Write runs of a bench in the format of IOHprofiler, for its analyser and for iohinspector.

A problem is a function of IOHprofiler, a method an algorithm. The value is the share of the
reference front's hypervolume that a run lacks so far, which is minimised; the seconds stand beside.
A value is of a front: the solution that a run states for its best value is the last candidate that
entered that front.

References
----------
.. [1] Doerr, Wang, Ye, van Rijn and Baeck, IOHprofiler, arXiv:1810.05281, 2018.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import quietarm
from quietarm.interrupts import interruptible
from quietarm.metaheuristics import NamedProblem
from quietarm.ocp.files import write_whole
from quietarm.studies.bench.results import Results, Run
from quietarm.studies.bench.running_times import History

FORMAT = "0.3.5"
"""Version of IOHprofiler's experimenter whose files these are like."""
COLUMNS = ("evaluations", "raw_y", "seconds")


@interruptible
def write_iohprofiler(results: Results, folder: str | Path) -> tuple[list[Path], tuple[str, ...]]:
    """Write every method's runs on every problem, and return what was written and left out.

    Methods that do not count candidates, such as the gradient, have no running time that the
    format could state, and are left out.

    Parameters
    ----------
    results : Results
        Runs of a bench.
    folder : path
        Folder of the files; each method has a folder of its own in it, to be given to the analyser.

    Returns
    -------
    written : list of Path
        The files of JSON, one for each method and problem; each names a file of numbers.
    left_out : tuple of str
        Methods without candidates.
    """
    numbers = {problem.name: number for number, problem in enumerate(results.problems, 1)}
    written = list[Path]()
    left_out = set[str]()
    for problem in results.problems:
        for method in results.methods:
            runs = results.of(problem.name, method)
            if not runs:
                continue
            if not _count_candidates(runs):
                left_out.add(method)
                continue
            place = Path(folder, _plain(method))
            written.append(_write(place, problem, numbers[problem.name], method, runs))
    return written, tuple(sorted(left_out))


def _count_candidates(runs: Sequence[Run]) -> bool:
    """Return whether every mark of every run counts candidates."""
    return all(np.isfinite(run.history.evaluations).all() for run in runs)


def _write(
    folder: Path, problem: NamedProblem, number: int, method: str, runs: Sequence[Run]
) -> Path:
    """Write the runs of a method on a problem, and return the file that describes them."""
    stem = f"f{number}_{_plain(problem.name)}"
    terms = problem.profile.size
    table = Path(f"data_{stem}", f"IOHprofiler_f{number}_DIM{terms}.dat")
    rows = [_rows_of(run.history) for run in runs]
    (folder / table.parent).mkdir(parents=True, exist_ok=True)
    write_whole(folder / table, "".join(map(_table_of, rows)).encode())
    described = {
        "version": FORMAT,
        "suite": f"quietarm {quietarm.__version__}",
        "function_id": number,
        "function_name": problem.name,
        "maximization": False,
        "algorithm": {"name": method, "info": "hypervolume gap, as a share"},
        "attributes": list(COLUMNS),
        "scenarios": [
            {
                "dimension": terms,
                "path": table.as_posix(),
                "runs": [_run_of(run, of_run, terms) for run, of_run in zip(runs, rows)],
            }
        ],
    }
    path = folder / f"IOHprofiler_{stem}.json"
    write_whole(path, json.dumps(described, indent=1).encode())
    return path


def _rows_of(history: History) -> np.ndarray:
    """Return the improving marks of a run, whose first one counts one candidate.

    A reader tells runs by that. Before its first mark a run lacks everything.
    """
    marks = np.column_stack([history.improving.evaluations, *history.improving[:2]])
    if not len(marks) or marks[0, 0] > 1:
        marks = np.vstack([[1.0, 1.0, 0.0], marks])
    return marks[~np.isnan(marks[:, 1])]


def _table_of(rows: np.ndarray) -> str:
    """The lines of a run, with their heading."""
    lines = [" ".join(COLUMNS)]
    lines += [f"{count:.0f} {gap:.10f} {seconds:.6f}" for count, gap, seconds in rows]
    return "\n".join(lines) + "\n"


def _run_of(run: Run, rows: np.ndarray, terms: int) -> Mapping[str, Any]:
    """Describe a run, with the candidate that completed its best front."""
    best = rows[rows[:, 1].argmin()]
    count = int(best[0])
    return {
        "instance": 1 if run.front.record.seed is None else run.front.record.seed + 1,
        "evals": int(rows[-1, 0]),
        "best": {"evals": count, "y": float(best[1]), "x": _last_entered(run, count, terms)},
    }


def _last_entered(run: Run, count: int, terms: int) -> list[float | None]:
    """The coefficients of the last of so many candidates that entered the front; null of none."""
    entries = run.front.entries
    entered = np.searchsorted(entries.candidates, count, side="right")
    return list(entries.coefficients[entered - 1]) if entered else [None] * terms


def _plain(name: str) -> str:
    """A name as a file's: other letters than those of names and numbers become dashes."""
    return re.sub(r"[^A-Za-z0-9.+-]+", "-", name).strip("-.") or "method"
