"""The work of a study: every method on every case, compared with each other and the floor."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

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
from ocp.base.checks import whole
from studies.comparison.measures import Comparison, compare_fronts
from studies.methods import METHODS, Kind, Method, methods_of
from studies.paper.case import Case
from studies.paper.points import PaperPoint, paper_points
from studies.paper.printed import CONDITIONS
from studies.paper.tasks import title_of
from studies.runs.pieces import Begin, Done, NotTriedError, Piece, run_pieces, searched

FLOOR = "floor"


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
        least = {"terms": 1, "points": 2, "runs": 1, "seed": 0, "workers": 1}
        for name, value in least.items():
            whole(name, getattr(self, name), value)
        for name, value in {"population": 2, "generations": 1}.items():
            if getattr(self, name) is not None:
                whole(name, getattr(self, name), value)


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
    """A study of one task or several."""

    settings: StudySettings
    cases: tuple[CaseStudy, ...]
    seconds: float


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
        out of it, with its reason.

    Raises
    ------
    KeyboardInterrupt
        When a search was interrupted.
    """
    began = time.perf_counter()
    settings = StudySettings() if settings is None else settings
    found = tuple(_study_case(case, settings, begin) for case in cases)
    return Study(settings, found, time.perf_counter() - began)


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
        **({"workers": settings.workers} if method.parallel else {}),
    )
    return [_whole(front)]


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
    polish = polish_front(first, workers=settings.workers)
    _whole(polish.front)
    return polish


def _whole(front: Front) -> Front:
    """The same front; KeyboardInterrupt where it was interrupted."""
    if not front.complete:
        raise KeyboardInterrupt
    return front


def _study_case(case: Case, settings: StudySettings, begin: Begin) -> CaseStudy:
    pieces = pieces_of(case, settings)
    done = run_pieces(pieces, begin, go_on=True)
    fronts, failures = list[Front](), list[str]()
    for name in (str(piece.key) for piece in pieces):
        if name in done.failures:
            failures.append(f"{name}: {done.failures[name]}")
        elif name != FLOOR:
            answer = done.answers[name]
            found = [answer.front] if isinstance(answer, Polish) else answer
            kept = [front for front in found if front.points]
            if len(kept) < len(found):
                failures.append(f"{name}: {len(found) - len(kept)} of {len(found)} found no point")
            fronts += kept
    if len(fronts) < 2:
        where = title_of(case.task)
        raise SolverFailedError(f"{where}: no two fronts to compare; {'; '.join(failures)}")
    floor = done.answers.get(FLOOR)
    polishes = {m.name: done.answers.get(m.then_polished().name) for m in METHODS.values()}
    return CaseStudy(
        case=case,
        comparison=compare_fronts(fronts, floor=None if floor is None else floor.energy),
        polishes={name: polish for name, polish in polishes.items() if polish is not None},
        floor=floor,
        paper=tuple(paper_points(case.task, {settings.terms})),
        failures=tuple(failures),
    )
