"""Run what a contest lacks, a run a piece of work, and keep each as it ends."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path

from quietarm.metaheuristics import NamedProblem
from quietarm.metaheuristics.budget.run import number_of_evaluations, search_within
from quietarm.metaheuristics.sharing.pieces import Done, Listener, Piece, Say
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import QuietarmError
from quietarm.ocp.base.interrupts import note_interrupts
from quietarm.studies.contest.asked import Contest, check_alike
from quietarm.studies.contest.imported import Imported, imported_run
from quietarm.studies.contest.landscape import Landscape, landscape_of
from quietarm.studies.contest.problems import Yardstick
from quietarm.studies.contest.runs import Key, Run
from quietarm.studies.contest.store import Store


def set_up(
    contest: Contest,
    store: Store,
    imports: Mapping[str, Sequence[Path]],
    evaluations: int | None = None,
) -> None:
    """Put exact fronts and results of other tools into the folder, where they are not yet."""
    check_alike(store, contest)
    if evaluations is not None:
        number_of_evaluations(evaluations)
    if imports and len(contest.problems) != 1:
        raise ValueError(
            f"results are imported for one problem, and {len(contest.problems)} are named; give "
            "one PROBLEM with --import, then the next into the same folder"
        )
    yardsticks = {
        problem.name: store.yardsticks.get(problem.name) or Yardstick.of(problem)
        for problem in contest.problems
    }
    imported = list[Imported]()
    for method, files in imports.items():
        (problem,) = contest.problems
        for path in files:
            run = imported_run(problem, yardsticks[problem.name], method, path, evaluations)
            known = store.imports.get(run.key)
            if known is None:
                _refuse_twice(run, [*store.imports.values(), *imported])
                imported.append(run)
            elif (known.digest, known.evaluations) != (run.digest, run.evaluations):
                raise ValueError(
                    f"{store.path} has another run of {method} from a file {path.name}; "
                    "rename one of them, or remove the folder's "
                    f"{store.place(Imported, known.key).relative_to(store.path)}"
                )
    for yardstick in yardsticks.values():
        if yardstick.problem not in store.yardsticks:
            store.keep(yardstick)
    for run in imported:
        store.keep(run)


def _refuse_twice(run: Imported, others: Iterable[Imported]) -> None:
    """Refuse a run that is counted already: it would pass for a second seed."""
    for other in others:
        if (other.problem, other.digest) == (run.problem, run.digest):
            raise ValueError(
                f"{run.file} of {run.method} holds the same as {other.file} of {other.method}; "
                "give every run once"
            )


def pieces_of(contest: Contest, store: Store) -> list[Piece]:
    """The work that is still to be done."""
    pieces = list[Piece]()
    problems = {problem.name: problem for problem in contest.problems}
    for problem in contest.problems if contest.explain else ():
        if problem.name not in store.landscapes:
            name = f"{problem.name}: local minima"
            work = partial(_landscape, problem, contest.seed)
            pieces.append(Piece((problem.name, "landscape"), name, work))
    for key in contest.keys:
        if key not in store.runs:
            name = f"{key.problem}: {key.method}, seed {key.seed}"
            yardstick = store.yardsticks[key.problem]
            work = partial(_run, contest, problems[key.problem], key, yardstick)
            pieces.append(Piece(key, name, work))
    return pieces


def run_contest(
    pieces: Sequence[Piece], store: Store, workers: Workers, begin: Callable[[str], None]
) -> Done:
    """Do the work; every run is in the folder as soon as it is done."""
    kept = set[Hashable]()

    def keep(key: Hashable, answer: Run | Landscape) -> None:
        with note_interrupts() as came:
            store.keep(answer)
            kept.add(key)
        if came:
            raise KeyboardInterrupt

    done = run_pieces(pieces, Listener(begin, ended=keep), workers=workers, note=QuietarmError)
    with note_interrupts():
        for key, answer in done.answers.items():
            if key not in kept:  # it was on its way when Ctrl-C came
                store.keep(answer)
    return done


def _landscape(problem: NamedProblem, seed: int, earlier: Done, say: Say) -> Landscape:
    return landscape_of(problem, seed)


def _run(
    contest: Contest, problem: NamedProblem, key: Key, yardstick: Yardstick, earlier: Done, say: Say
) -> Run:
    entry = contest.entries[key.method]
    found = search_within(
        problem.task,
        entry.method,
        contest.evaluations,
        yardstick.scale,
        profile=problem.profile,
        bound=problem.bound,
        population=entry.population,
        settings=entry.settings,
        seed=key.seed,
    )
    return Run.of(yardstick, key.method, contest.evaluations, entry.population, found)
