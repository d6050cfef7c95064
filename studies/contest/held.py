"""A contest from Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from quietarm.metaheuristics import NamedProblem
from quietarm.metaheuristics.algorithms.settings import Value
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import SolverFailedError
from quietarm.studies.contest.asked import Contest
from quietarm.studies.contest.measures import Arena, arenas_of
from quietarm.studies.contest.store import Store, problems_of
from quietarm.studies.contest.work import (
    failures_of,
    named_files,
    pieces_of,
    run_contest,
    set_up,
    without_front,
)


def contest(
    problems: Sequence[NamedProblem | str],
    methods: Sequence[str],
    folder: str | Path,
    *,
    runs: int = 31,
    evaluations: int = 20_000,
    seed: int = 0,
    population: int | None = None,
    settings: Mapping[str, Mapping[str, Value]] | None = None,
    imports: Sequence[str] = (),
    part: tuple[int, int] = (1, 1),
    workers: int = 1,
    scheduler: str | None = None,
) -> tuple[Arena, ...]:
    """Hold methods with equal evaluations against the exact front of each problem.

    Parameters
    ----------
    problems : sequence of NamedProblem or str
        Named problems, or problems of your own.
    methods : sequence of str
        As of ``quietarm contest``: ``"nsga2"``, ``"vepso+polish"``, ``"multistart"``.
    folder : str or Path
        Where every run is a file as soon as it is done; those that are there are not done again.
    runs, evaluations, seed, population
        Seeds of each method, evaluations of each run, first seed, population of every method.
    settings : mapping, optional
        Of methods by their names.
    imports : sequence of str
        Files or folders of other tools' results on the one problem, as ``"my swarm=results"``.
    part : (int, int)
        Which of how many parts of the runs: every n-th.
    workers, scheduler : int, str, optional
        Processes of this machine, or the address of a dask scheduler.

    Returns
    -------
    tuple of Arena
        A problem each, with the runs of all methods in the folder: `Field.final`, `Field.missing`,
        `Field.expected_running_time` and others measure them. After Ctrl-C what was done. A problem
        without an exact front is left out.

    Raises
    ------
    ValueError
        When something is out of range, or does not fit what the folder holds.
    QuietarmError
        When a run failed, the others being in the folder; or no problem has an exact front.
    """
    chosen = tuple(
        one if isinstance(one, NamedProblem) else problems_of([one])[0] for one in problems
    )
    asked = Contest(
        chosen, tuple(methods), runs, evaluations, seed, population, settings or {},
        part=part, workers=Workers(workers, scheduler),
    )  # fmt: skip
    store = Store(Path(folder))
    set_up(asked, store, named_files(imports))
    done = run_contest(pieces_of(asked, store), store, asked.workers, lambda name: None)
    for failure in failures_of(done).values():
        raise failure
    arenas = arenas_of(Store(Path(folder)))  # to which other parts may have added
    if not arenas and (reasons := without_front(done)):
        raise SolverFailedError(reasons[0])
    return arenas
