"""The work of a study: every method on every case, compared with each other and the floor."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from metaheuristics.ensemble import seeds_of
from metaheuristics.runs.settings import number_of_generations, number_of_individuals
from ocp import (
    CycloidPolynomial,
    Floor,
    Front,
    InfeasibleTaskError,
    Polish,
    SolverFailedError,
    energy_floor,
    polish_front,
)
from ocp.answers.provenance import number_of_points
from ocp.base.checks import whole
from ocp.base.interrupts import note_interrupts
from ocp.base.workers import number_of_workers
from studies.comparison.measures import Comparison, compare_fronts
from studies.methods import METHODS, Kind, Method, methods_of
from studies.paper.case import Case
from studies.paper.points import PaperPoint, paper_points
from studies.paper.printed import CONDITIONS
from studies.paper.tasks import title_of
from studies.runs.pieces import (
    Begin,
    Done,
    InterruptedPiece,
    NotTriedError,
    Piece,
    run_pieces,
    searched,
)

FLOOR = "floor"
_Answer = TypeVar("_Answer")


@dataclass(frozen=True)
class StudySettings:
    """How thorough a study is.

    Parameters
    ----------
    terms : int
        Terms of the polynomial.
    points : int
        Points of the gradient's fronts.
    runs : int
        Seeds of each metaheuristic.
    seed : int
        First seed.
    workers : int
        Processes.
    population, generations : int, optional
        Of the metaheuristics; the paper's by default.

    Raises
    ------
    ValueError
        When one is out of range.
    """

    terms: int = 6
    points: int = 50
    runs: int = 3
    seed: int = 0
    workers: int = 1
    population: int | None = None
    generations: int | None = None

    def __post_init__(self) -> None:
        CycloidPolynomial(self.terms)
        whole("terms", self.terms, 1)
        number_of_points(self.points)
        seeds_of(self.seed, self.runs)
        number_of_workers(self.workers)
        if self.population is not None:
            number_of_individuals(self.population)
        if self.generations is not None:
            number_of_generations(self.generations)


@dataclass(frozen=True, eq=False)
class CaseStudy:
    """What a study found for one task.

    Attributes
    ----------
    case : Case
        The task and the box.
    comparison : Comparison
        All fronts.
    polishes : dict of str to Polish
        What the gradient gained on the first front of a metaheuristic, by method.
    floor : Floor or None
        The least energy of any joint motion at rest on arrival; None where it was not found.
    paper : tuple of PaperPoint
        The paper's own points.
    failures : tuple of str
        What failed, one line for each.
    """

    case: Case
    comparison: Comparison
    polishes: Mapping[str, Polish]
    floor: Floor | None
    paper: tuple[PaperPoint, ...]
    failures: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Study:
    """A study of one task or several.

    Attributes
    ----------
    settings : StudySettings
        How thorough.
    cases : tuple of CaseStudy
        What was found, task by task.
    seconds : float
        How long it took.
    done : int or None
        How many pieces of work came to an end before Ctrl-C; None where all did.
    """

    settings: StudySettings
    cases: tuple[CaseStudy, ...]
    seconds: float
    done: int | None = None


def amount_of_work(cases: Sequence[Case], settings: StudySettings) -> int:
    """How many pieces of work `run_study` begins."""
    return sum(len(pieces_of(case, settings)) for case in cases)


def run_study(
    cases: Sequence[Case] = CONDITIONS,
    settings: StudySettings | None = None,
    begin: Begin = lambda name: None,
) -> Study:
    """Run every method on every case and compare what they find.

    Parameters
    ----------
    cases : sequence of Case
        The tasks; the paper's six conditions by default.
    settings : StudySettings, optional
        How thorough.
    begin : callable, optional
        Called with the name of every piece of work when it begins; `amount_of_work` says how many
        there are.

    Returns
    -------
    Study
        Fronts, comparison, floor and polish of every case. A method that fails on a case is left
        out of it, with its reason. After Ctrl-C what was found until then.

    Raises
    ------
    KeyboardInterrupt
        When it was interrupted before anything was found.
    """
    began, ended = time.perf_counter(), 0
    settings = StudySettings() if settings is None else settings
    found: list[CaseStudy] = []
    for case in cases:
        done = run_pieces(pieces_of(case, settings), begin, go_on=True)
        ended += done.number
        with note_interrupts() as came:  # what was found is put together to the end
            found += _case_study(case, settings, done)
        if done.interrupted or came:
            if not found:
                raise KeyboardInterrupt
            break
    else:
        return Study(settings, tuple(found), time.perf_counter() - began)
    return Study(settings, tuple(found), time.perf_counter() - began, done=ended)


def pieces_of(case: Case, settings: StudySettings) -> list[Piece]:
    """The work on one case; every answer is kept under the name of its method, or `FLOOR`."""
    work: dict[str, Callable[[Done], object]] = {}
    for method in methods_of(Kind.GRADIENT):
        work[method.name] = partial(_swept, case, method, settings)
    for method in methods_of(Kind.METAHEURISTIC):
        work[method.name] = partial(_searched, case, method, settings)
        work[method.then_polished().name] = partial(_polished, method, settings)
    work[FLOOR] = lambda done: energy_floor(case.task)
    title = title_of(case.task)
    return [Piece(name, f"{title}: {name}", one) for name, one in work.items()]


def _swept(case: Case, method: Method, settings: StudySettings, done: Done) -> list[Front]:
    for other in methods_of(Kind.GRADIENT):  # they begin with the same end, and would fail alike
        if isinstance(done.failures.get(other.name), InfeasibleTaskError):
            raise NotTriedError(f"not tried, as {other.name} found no motion within the limits")
    front = method.sweep(
        case.task,
        CycloidPolynomial(settings.terms),
        bound=case.bound,
        points=settings.points,
    )
    return _whole(front, [front])


def _searched(case: Case, method: Method, settings: StudySettings, done: Done) -> list[Front]:
    return searched(
        case,
        method,
        settings.terms,
        settings.runs,
        seed=settings.seed,
        workers=settings.workers,
        population=settings.population,
        generations=settings.generations,
    )


def _polished(method: Method, settings: StudySettings, done: Done) -> Polish:
    first = next((front for front in done.answers.get(method.name, []) if front.points), None)
    if first is None:
        raise NotTriedError(f"not tried, as {method.name} found no front to start from")
    polish = polish_front(first)
    return _whole(polish.front, polish)


def _whole(front: Front, answer: _Answer) -> _Answer:
    """The answer that the front belongs to; InterruptedPiece where it was interrupted."""
    if not front.complete:
        raise InterruptedPiece(answer)
    return answer


def _case_study(case: Case, settings: StudySettings, done: Done) -> list[CaseStudy]:
    """What was found for a case, if anything was before Ctrl-C."""
    fronts, failures = list[Front](), list[str]()
    names = [str(piece.key) for piece in pieces_of(case, settings)]
    for name in names:
        if name in done.failures:
            failures.append(f"{name}: {done.failures[name]}")
        elif name in done.parts:
            fronts += _fronts_of(done.parts[name])
            failures.append(f"{name}: interrupted, with what was found until then")
        elif name not in done.answers:
            failures.append(f"{name}: not done before the interruption")
        elif name != FLOOR:
            found = _fronts_of(done.answers[name])
            kept = [front for front in found if front.points]
            if len(kept) < len(found):
                failures.append(f"{name}: {len(found) - len(kept)} of {len(found)} found no point")
            fronts += kept
    if not fronts and done.interrupted:
        return []
    if len(fronts) < 2 and not done.interrupted:
        where = title_of(case.task)
        raise SolverFailedError(f"{where}: no two fronts to compare; {'; '.join(failures)}")
    floor = done.answers.get(FLOOR)
    polishes = {m.name: done.answers.get(m.then_polished().name) for m in METHODS.values()}
    study = CaseStudy(
        case=case,
        comparison=compare_fronts(fronts, floor=None if floor is None else floor.energy, least=1),
        polishes={name: polish for name, polish in polishes.items() if polish is not None},
        floor=floor,
        paper=tuple(paper_points(case.task, {settings.terms})),
        failures=tuple(failures),
    )
    return [study]


def _fronts_of(answer: list[Front] | Polish) -> list[Front]:
    return [answer.front] if isinstance(answer, Polish) else answer
