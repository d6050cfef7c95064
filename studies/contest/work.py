"""Run what a contest lacks, a run a piece of work, and keep each as it ends; import the others'."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from hashlib import sha256
from pathlib import Path

from quietarm.metaheuristics import NamedProblem
from quietarm.metaheuristics.budget.record import Scale
from quietarm.metaheuristics.budget.run import number_of_evaluations, search_within
from quietarm.metaheuristics.sharing.pieces import Done, Listener, Piece, Say
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import QuietarmError, SolverFailedError
from quietarm.ocp.files import read_bytes
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.record import Setting
from quietarm.studies.contest.asked import Contest, Planned, check_alike
from quietarm.studies.contest.landscape import Landscape, landscape_of
from quietarm.studies.contest.names import name_given
from quietarm.studies.contest.store import Run, Store, Yardstick
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
    """Evaluate a file."""
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
        digest=sha256(read_bytes(path)).hexdigest(),
        claims=tuple(claim.line() for claim in claims if claim.differ),
    )


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
    problem, *others = contest.problems
    if imports and others:
        raise ValueError(
            f"results are imported for one problem, and {len(contest.problems)} are named; give "
            "one PROBLEM with --import, then the next into the same folder"
        )
    known = store.yardsticks
    exact = [known.get(one.name) or Yardstick.of(one) for one in contest.problems]
    there = [run for run in store.of(Run) if run.problem == problem.name]
    given = [
        imported_run(problem, exact[0], method, path, evaluations)
        for method, paths in imports.items()
        for path in paths
    ]
    for place, run in enumerate(given):
        _check_new(run, [*there, *given[:place]], store)
    for what in (*exact, *given):
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
    """The work that is still to be done, by the place of what it gives."""
    pieces, known = list[Piece](), store.yardsticks
    for problem in contest.problems if contest.explain else ():
        place, work = f"landscape/{problem.name}.json", partial(_landscape, problem, contest.seed)
        pieces.append(Piece(place, f"{problem.name}: local minima", work))
    for place, run in contest.planned.items():
        name = f"{run.problem.name}: {run.entry.name}, seed {run.seed}"
        work = partial(_run, run, contest.evaluations, known[run.problem.name].scale)
        pieces.append(Piece(place, name, work))
    return [piece for piece in pieces if piece.key not in store.kept]


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


def _landscape(problem: NamedProblem, seed: int, earlier: Done, say: Say) -> Landscape:
    return landscape_of(problem, seed)


def _run(planned: Planned, evaluations: int, scale: Scale, earlier: Done, say: Say) -> Run:
    problem, entry, seed = planned
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
