"""The headline study: every method on a task, held against each other and against the floor."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from metaheuristics import PAPER_BOX
from metaheuristics.ensemble import search_many
from ocp import (
    CycloidPolynomial,
    Front,
    InfeasibleTaskError,
    PointToPoint,
    Polish,
    QuietarmError,
    SolverFailedError,
    epsilon_front,
    polish_front,
    weighted_front,
)
from ocp.checks import positive, whole
from ocp.floor import energy_floor
from ocp.floor_answer import Floor
from studies.comparison.measures import Comparison, compare
from studies.paper.points import PaperPoint, paper_points
from studies.paper.printed import ROWS
from studies.paper.tasks import title_of

Answer = TypeVar("Answer")

SEARCHES = ("nsga2", "vepso")
"""The metaheuristics of a study; their first seed's front is polished."""
_PIECES = 3 + 2 * len(SEARCHES)


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


@dataclass(frozen=True)
class Case:
    """A task of a study and the box that its coefficients stay in.

    Parameters
    ----------
    task : PointToPoint
        The move.
    bound : float, optional
        Largest absolute coefficient; the paper's for its plants.

    Raises
    ------
    ValueError
        When there is no bound, or it is not positive.
    """

    task: PointToPoint
    bound: float | None = None

    def __post_init__(self) -> None:
        bound = PAPER_BOX.get(self.task.plant.name) if self.bound is None else self.bound
        if bound is None:
            raise ValueError(
                f"give a bound on the coefficients: the paper has none for {self.task.plant.name}"
            )
        object.__setattr__(self, "bound", positive("bound on the coefficients", bound))


PAPER_CASES: tuple[Case, ...] = tuple(
    Case(condition.task) for condition in dict.fromkeys(row.condition for row in ROWS)
)
"""The paper's six conditions, each in its plant's box."""


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
        What did not work, a line each.
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


def amount_of_work(cases: Sequence[Case]) -> int:
    """How many pieces of work `study` begins."""
    return _PIECES * len(cases)


def study(
    cases: Sequence[Case] = PAPER_CASES,
    settings: StudySettings | None = None,
    begin: Callable[[str], None] = lambda name: None,
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


def _study_case(case: Case, settings: StudySettings, begin: Callable[[str], None]) -> CaseStudy:
    task, profile = case.task, CycloidPolynomial(settings.terms)
    gradient = partial(_gradient, task, profile, bound=case.bound, points=settings.points)
    log, polishes = _Log(title_of(task), begin), dict[str, Polish]()
    fronts = log.fronts("epsilon", partial(gradient, epsilon_front, workers=settings.workers))
    if log.infeasible:  # the weighted method begins with the same end, and would fail alike
        log.failures.append("weighted: not tried, as epsilon found no motion within the limits")
    else:
        fronts += log.fronts("weighted", partial(gradient, weighted_front))
    for method in SEARCHES:
        found = log.fronts(method, partial(_searched, case, method, settings))
        fronts += found
        for front in found[:1]:
            polish = partial(_polished, front, settings.workers, polishes)
            fronts += log.fronts(f"{method}, polished", polish)
    floor = log.tried("floor", partial(energy_floor, task))
    if len(fronts) < 2:
        raise SolverFailedError(f"{log.where}: no two fronts to compare; {'; '.join(log.failures)}")
    return CaseStudy(
        case=case,
        comparison=compare(fronts, floor=None if floor is None else floor.energy),
        polishes=polishes,
        floor=floor,
        paper=tuple(paper_points(task, {settings.terms})),
        failures=tuple(log.failures),
    )


class _Log:
    """Says which piece of work begins, and keeps the reasons of those that fail."""

    def __init__(self, where: str, begin: Callable[[str], None]) -> None:
        self.where, self.failures, self.begin = where, list[str](), begin
        self.infeasible = False

    def tried(self, name: str, work: Callable[[], Answer]) -> Answer | None:
        """The answer of a piece of work; None where it fails."""
        self.begin(f"{self.where}: {name}")
        try:
            return work()
        except QuietarmError as error:
            self.failures.append(f"{name}: {error}")
            self.infeasible |= isinstance(error, InfeasibleTaskError)
            return None

    def fronts(self, name: str, work: Callable[[], list[Front]]) -> list[Front]:
        """The fronts of a piece of work that have points; KeyboardInterrupt where one was cut."""
        found = self.tried(name, work) or []
        if not all(front.complete for front in found):
            raise KeyboardInterrupt
        kept = [front for front in found if front.points]
        if len(kept) < len(found):
            self.failures.append(f"{name}: {len(found) - len(kept)} of {len(found)} found no point")
        return kept


def _gradient(
    task: PointToPoint, profile: CycloidPolynomial, find: Callable[..., Front], **settings: Any
) -> list[Front]:
    return [find(task, profile, **settings)]


def _polished(front: Front, workers: int, polishes: dict[str, Polish]) -> list[Front]:
    polishes[front.method] = polish_front(front, workers=workers)
    return [polishes[front.method].front]


def _searched(case: Case, method: str, settings: StudySettings) -> list[Front]:
    fronts = search_many(
        case.task, method, settings.runs, workers=settings.workers, seed=settings.seed,
        profile=CycloidPolynomial(settings.terms), bound=case.bound,
        population=settings.population, generations=settings.generations,
    )  # fmt: skip
    if len(fronts) < settings.runs:
        raise KeyboardInterrupt
    return fronts
