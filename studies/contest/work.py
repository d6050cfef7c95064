"""Run what a contest lacks, a run a piece of work, and keep each as it ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from metaheuristics import PRESETS
from metaheuristics.budget.run import number_of_evaluations, parts_of, search_within
from metaheuristics.ensemble import seeds_of
from metaheuristics.runs.settings import number_of_individuals
from metaheuristics.sharing.pieces import Done, Listener, NotTriedError, Piece, Say, to_the_end
from metaheuristics.sharing.running import run_pieces
from metaheuristics.sharing.workers import HERE, Workers
from ocp import QuietarmError
from ocp.base.interrupts import note_interrupts
from studies.contest.landscape import Landscape, landscape_of
from studies.contest.problems import Problem, Yardstick, exact_front
from studies.contest.runs import Folder, Key, Run, check_alike


@dataclass(frozen=True)
class Contest:
    """What is asked of a contest.

    Parameters
    ----------
    problems : tuple of Problem
        What the methods are run on.
    methods : tuple of str
        Names of methods.
    runs : int
        Seeds of each method.
    evaluations : int
        Evaluations of each run.
    seed : int
        First seed.
    population : int, optional
        Individuals of every method; each method's own by default.
    explain : bool
        Whether the local minima of the problems are looked for as well.
    workers : Workers
        Where the runs are done.

    Raises
    ------
    ValueError
        When a method is unknown or a number out of range.
    """

    problems: tuple[Problem, ...]
    methods: tuple[str, ...]
    runs: int = 31
    evaluations: int = 20_000
    seed: int = 0
    population: int | None = None
    explain: bool = False
    workers: Workers = HERE

    def __post_init__(self) -> None:
        for name in self.methods:
            search, _ = parts_of(name)
            limited = [problem.name for problem in self.problems if problem.task.limits]
            if limited and search in PRESETS and not PRESETS[search].keeps_limits:
                raise ValueError(
                    f"{name} cannot search {limited[0]}, which has limits; leave one of them out"
                )
        object.__setattr__(self, "methods", tuple(dict.fromkeys(self.methods)))
        seeds_of(self.seed, self.runs)
        number_of_evaluations(self.evaluations)
        if self.population is not None:
            number_of_individuals(self.population)

    @property
    def keys(self) -> list[Key]:
        """All runs: every method from one seed, then from the next, on one problem after another.

        So a contest that is stopped has as many runs of one method as of another.
        """
        return [
            Key(problem.name, method, seed)
            for problem in self.problems
            for seed in seeds_of(self.seed, self.runs)
            for method in self.methods
        ]


def pieces_of(contest: Contest, folder: Folder) -> list[Piece]:
    """The work that is still to be done.

    Parameters
    ----------
    contest : Contest
        What is asked.
    folder : Folder
        What is there.

    Returns
    -------
    list of Piece
        Exact fronts, local minima and runs that are not in the folder.

    Raises
    ------
    ValueError
        As `check_alike`.
    FileFormatError
        When a file in the folder is broken.
    """
    there, yardsticks, landscapes = folder.runs(), folder.yardsticks(), folder.landscapes()
    check_alike(there.values(), yardsticks, contest.evaluations, contest.population, folder.path)
    pieces = list[Piece]()
    for problem in contest.problems:
        wanted = [key for key in contest.keys if key.problem == problem.name and key not in there]
        known = yardsticks.get(problem.name)
        if known is None:
            name = f"{problem.name}: exact front"
            pieces.append(Piece(problem.name, name, partial(_yardstick, problem)))
        if contest.explain and problem.name not in landscapes:
            name = f"{problem.name}: local minima"
            work = partial(_landscape, problem, contest.seed)
            pieces.append(Piece((problem.name, "landscape"), name, work))
        for key in wanted:
            name = f"{problem.name}: {key.method}, seed {key.seed}"
            work = partial(_run, contest, problem, key, known)
            pieces.append(Piece(key, name, work, () if known else (problem.name,)))
    return pieces


def run_contest(
    pieces: Sequence[Piece], folder: Folder, workers: Workers, begin: Callable[[str], None]
) -> Done:
    """Do the work; every run is in the folder as soon as it is done.

    Parameters
    ----------
    pieces : sequence of Piece
        What `pieces_of` gave.
    folder : Folder
        Where the runs are kept.
    workers : Workers
        Where they are done.
    begin : callable
        Called with the name of every piece when it begins.

    Returns
    -------
    Done
        What became of the pieces.
    """

    def keep(key: object, answer: Run | Yardstick | Landscape) -> None:
        with note_interrupts():
            if isinstance(answer, Run):
                folder.save_run(answer)
            elif isinstance(answer, Landscape):
                folder.save_landscape(answer)
            else:
                folder.save_yardstick(answer)

    return run_pieces(pieces, Listener(begin, ended=keep), workers=workers, note=QuietarmError)


def _yardstick(problem: Problem, earlier: Done, say: Say) -> Yardstick:
    return Yardstick.of(problem, to_the_end(exact_front(problem)))


def _landscape(problem: Problem, seed: int, earlier: Done, say: Say) -> Landscape:
    return landscape_of(problem, seed)


def _run(
    contest: Contest, problem: Problem, key: Key, known: Yardstick | None, earlier: Done, say: Say
) -> Run:
    yardstick = earlier.answers.get(problem.name) if known is None else known
    if yardstick is None:
        raise NotTriedError("not tried, as there is no exact front to measure it against")
    found = search_within(
        problem.task,
        key.method,
        contest.evaluations,
        yardstick.scale,
        profile=problem.profile,
        bound=problem.bound,
        population=contest.population,
        seed=key.seed,
    )
    return Run.of(yardstick, key.method, contest.evaluations, contest.population, found)
