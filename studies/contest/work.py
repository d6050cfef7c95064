"""Run what a contest lacks, a run a piece of work, and keep each as it ends; import the others'."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import partial
from hashlib import sha256
from pathlib import Path

from quietarm.metaheuristics import NamedProblem, RecordedRun
from quietarm.metaheuristics.budget.run import number_of_evaluations, search_within
from quietarm.metaheuristics.objective.claims import check_figures
from quietarm.metaheuristics.sharing.pieces import Done, Listener, NotTriedError, Piece, Say
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import QuietarmError, SolverFailedError
from quietarm.ocp.files import read_bytes
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.record import Setting
from quietarm.studies.contest.asked import Contest, Planned, check_alike
from quietarm.studies.contest.landscape import Landscape, landscape_of
from quietarm.studies.contest.names import name_given
from quietarm.studies.contest.store import Run, Store, Yardstick, exact_of
from quietarm.studies.reading.foreign import read_found
from quietarm.studies.reading.importing import import_front


def named_files(texts: Sequence[str]) -> dict[str, list[Path]]:
    """Files of runs by the name of their method, of texts as ``name=path``."""
    found: dict[str, list[Path]] = {}
    for text in texts:
        name, equals, rest = text.partition("=")
        path = Path(text)
        if equals and rest and not path.exists():
            path = Path(rest)
        else:
            whole = path.resolve() if path.name in ("", "..") else path  # as . and /
            name = whole.name if whole.is_dir() else whole.stem
        if not path.exists():
            raise ValueError(f"there is no file or folder {path}; give one to --import")
        inside = [path]
        if path.is_dir():
            inside = sorted(p for p in path.iterdir() if p.is_file() and p.name[0] != ".")
        if not inside:
            raise ValueError(f"{path} has no files; give a folder with a file of each run")
        files = found.setdefault(name_given(name.strip()), [])
        for file in inside:
            if any(other.name == file.name for other in files):
                raise ValueError(f"{name} has two files {file.name}; rename one: each is a run")
            files.append(file)
    return found


def imported_run(
    problem: NamedProblem, yardstick: Yardstick, method: str, path: Path, evaluations: int | None
) -> Run:
    """Evaluate a file of coefficients, or take a recorded run as it is."""
    digest = sha256(read_bytes(path)).hexdigest()
    if path.suffix == ".json":
        return _recorded_run(problem, yardstick, method, path, digest)
    found = read_found(path)
    settings: dict[str, Setting] = {"imported": path.name, "bound": problem.bound}
    try:
        front, claims = import_front(problem.task, problem.profile, found, method, settings)
    except (ValueError, SolverFailedError) as error:
        raise type(error)(f"{path}: {error}") from None
    return Run(
        problem=problem.name,
        method=method,
        evaluations=evaluations,
        scale=yardstick.scale,
        front=front,
        file=path.name,
        digest=digest,
        claims=tuple(claim.words for claim in claims if claim.differs),
    )


def _recorded_run(
    problem: NamedProblem, yardstick: Yardstick, method: str, path: Path, digest: str
) -> Run:
    found = RecordedRun.load(path)
    front, its = found.front, yardstick.front
    of = found.scale, front.settings.get("bound"), front.task, front.profile
    if of != (yardstick.scale, problem.bound, its.task, its.profile):
        raise ValueError(
            f"{path} was recorded on {found.problem}, another move, box or exact front than "
            f"{problem.name}; give that problem"
        )
    check_figures(front, str(path), "record it again")
    return Run(
        problem.name, method, front.evaluations, found.scale, front,
        marks=found.marks, visits=found.visits, file=path.name, digest=digest,
    )  # fmt: skip


def set_up(
    contest: Contest,
    store: Store,
    imports: Mapping[str, Sequence[Path]],
    evaluations: int | None = None,
) -> None:
    """Put exact fronts that are at hand, and results of other tools, into the folder."""
    check_alike(store, contest)
    if evaluations is not None:
        number_of_evaluations(evaluations)
    problem, *others = contest.problems
    if imports and others:
        raise ValueError(
            f"results are imported for one problem, and {len(contest.problems)} are named; give "
            "one PROBLEM with --import, then the next into the same folder"
        )
    known = store.yardsticks
    exact = {
        one.name: known.get(one.name) or Yardstick.of(one)
        for one in contest.problems
        if one.named or imports
    }
    there = [run for run in store.of(Run) if run.problem == problem.name]
    given = [
        imported_run(problem, exact[problem.name], method, path, evaluations)
        for method, paths in imports.items()
        for path in paths
    ]
    for place, run in enumerate(given):
        _check_new(run, [*there, *given[:place]], store)
    for what in (*exact.values(), *given):
        if what.place not in store.kept:
            store.keep(what)


def _check_new(run: Run, others: Sequence[Run], store: Store) -> None:
    """Refuse a run in the place of another one, or that stands elsewhere: it would count twice."""
    for other in others:
        alike = other.digest == run.digest
        if other.place == run.place and not (alike and other.evaluations == run.evaluations):
            raise ValueError(
                f"{store.path} has another run of {run.method} from a file {run.file}; rename one "
                f"of them, or remove the folder's {run.place}"
            )
        if other.place != run.place and alike:
            raise ValueError(
                f"{run.file} of {run.method} holds the same as {other.file} of {other.method}; "
                "give every run once"
            )


def pieces_of(contest: Contest, store: Store) -> list[Piece]:
    """The work that is still to be done, by the place of what it gives.

    Runs on a problem without an exact front in the folder come after that.
    """
    pieces, known = list[Piece](), store.yardsticks
    left = {place: run for place, run in contest.mine.items() if place not in store.kept}
    asked = {run.problem.name for run in left.values()}
    for problem in contest.problems:
        if problem.name in asked and problem.name not in known:
            work = partial(_yardstick, problem)
            pieces.append(Piece(exact_of(problem), f"{problem.name}: exact front", work))
    for problem in contest.problems if contest.explain else ():
        if problem.name in known and not known[problem.name].within_level:
            continue  # its page says so
        place, work = f"landscape/{problem.name}.json", partial(_landscape, problem, contest.seed)
        if place not in store.kept:
            pieces.append(Piece(place, f"{problem.name}: local minima", work))
    for place, run in left.items():
        name = f"{run.problem.name}: {run.entry.name}, seed {run.seed}"
        exact = known.get(run.problem.name)
        after = () if exact else (exact_of(run.problem),)
        pieces.append(Piece(place, name, partial(_run, run, contest.evaluations, exact), after))
    return pieces


def run_contest(
    pieces: Sequence[Piece], store: Store, workers: Workers, begin: Callable[[str], None]
) -> Done:
    """Do the work; every run is in the folder as soon as it is done."""
    listener = Listener(begin, ended=lambda place, answer: store.keep(answer))
    done = run_pieces(pieces, listener, workers=workers, note=QuietarmError)
    with note_interrupts():
        for place, answer in done.answers.items():
            if place not in store.kept:  # it was on its way when Ctrl-C came
                store.keep(answer)
    return done


def without_front(done: Done) -> list[str]:
    """Problems that are left out, as the gradient finds no exact front, and why."""
    return [
        f"{Path(str(place)).stem} is left out: {error}"
        for place, error in done.failures.items()
        if _is_without_front(place, error)
    ]


def failures_of(done: Done) -> dict[str, QuietarmError]:
    """What failed of work that can be done, by its place."""
    return {
        str(place): error
        for place, error in done.failures.items()
        if not isinstance(error, NotTriedError) and not _is_without_front(place, error)
    }


def _is_without_front(place: Hashable, error: QuietarmError) -> bool:
    # a worker that died says nothing of the problem
    return str(place).startswith("exact/") and isinstance(error, SolverFailedError)


def _yardstick(problem: NamedProblem, earlier: Done, say: Say) -> Yardstick:
    try:
        return Yardstick.of(problem)
    except ValueError as error:  # a single motion
        raise SolverFailedError(str(error)) from None


def _landscape(problem: NamedProblem, seed: int, earlier: Done, say: Say) -> Landscape:
    return landscape_of(problem, seed)


def _run(
    planned: Planned, evaluations: int, exact: Yardstick | None, earlier: Done, say: Say
) -> Run:
    problem, entry, seed = planned
    exact = exact or earlier.answers.get(exact_of(problem))
    if exact is None:
        raise NotTriedError(f"{problem.name} has no exact front to be held against")
    scale = exact.scale
    found = search_within(
        problem.task,
        entry.method,
        evaluations,
        scale,
        profile=problem.profile,
        bound=problem.bound,
        population=entry.population,
        settings=entry.settings,
        seed=seed,
    )
    return Run(
        problem=problem.name,
        method=entry.name,
        evaluations=evaluations,
        scale=scale,
        front=found.front,
        population=entry.population,
        marks=found.marks,
        visits=found.visits,
    )
