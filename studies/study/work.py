"""The work of a study: every method on every case, compared with each other and the floor."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

from quietarm.metaheuristics.algorithms.presets import preset_of
from quietarm.metaheuristics.ensemble import one_seed, seeds_of
from quietarm.metaheuristics.runs.settings import number_of_generations, number_of_individuals
from quietarm.metaheuristics.sharing.pieces import (
    INTERRUPTED,
    Done,
    Listener,
    NotTriedError,
    Piece,
    Say,
)
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import (
    CycloidPolynomial,
    Floor,
    Front,
    InfeasibleTaskError,
    Polish,
    QuietarmError,
    SolverFailedError,
    energy_floor,
    polish_front,
)
from quietarm.ocp.checks import whole
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.record import number_of_points
from quietarm.studies.comparison.measures import Comparison, compare_fronts
from quietarm.studies.display.words import title_of
from quietarm.studies.paper import CONDITIONS, Case, PaperPoint, paper_points
from quietarm.studies.registry.methods import METHODS, PAPERS, Kind, Method, methods_of

FLOOR = "floor"


@dataclass(frozen=True)
class StudySettings:
    """How thorough a study is."""

    terms: int = 6
    points: int = 50
    runs: int = 3
    seed: int = 0
    workers: int = 1
    scheduler: str | None = None
    population: int | None = None
    generations: int | None = None
    methods: tuple[str, ...] = tuple(method.name for method in PAPERS)
    settings: Mapping[str, Mapping[str, object]] = field(default_factory=dict)
    fronts: tuple[Front, ...] = ()

    def __post_init__(self) -> None:
        whole("terms", self.terms, 1)
        number_of_points(self.points)
        seeds_of(self.seed, self.runs)
        Workers(self.workers, self.scheduler)
        if self.population is not None:
            number_of_individuals(self.population)
        if self.generations is not None:
            number_of_generations(self.generations)
        for name in self.methods:
            preset = preset_of(name)
            preset.checked(self.population or preset.population, self.settings.get(name))

    @property
    def searches(self) -> tuple[Method, ...]:
        """The metaheuristics."""
        return tuple(METHODS[name] for name in self.methods)

    @property
    def profile(self) -> CycloidPolynomial:
        """The joint profile of all methods."""
        return CycloidPolynomial(self.terms)


class Key(NamedTuple):
    """What the answer of a piece is kept under: a front's method, a polished one's, or `FLOOR`."""

    case: Case
    name: str
    seed: int | None = None


def pieces_of(case: Case, settings: StudySettings) -> list[Piece]:
    """The work on one case."""
    sweeps = [Key(case, method.name) for method in methods_of(Kind.GRADIENT)]
    pieces = [
        _piece(key, partial(_swept, key, settings), sweeps[:i]) for i, key in enumerate(sweeps)
    ]
    for method in settings.searches:
        asked = {
            "profile": settings.profile,
            "bound": case.bound,
            "population": settings.population,
            "generations": settings.generations,
            "settings": settings.settings.get(method.name),
        }
        keys = {
            seed: Key(case, method.name, seed) for seed in seeds_of(settings.seed, settings.runs)
        }
        pieces += [
            _piece(key, partial(one_seed, case.task, method.name, asked, seed))
            for seed, key in keys.items()
        ]
        searches, polished = list(keys.values()), Key(case, method.then_polished().name)
        pieces.append(_piece(polished, partial(_polished, method, searches), searches))
    return [*pieces, _piece(Key(case, FLOOR), partial(_floor, case))]


def _piece(key: Key, work: Callable[[Done, Say], object], after: Sequence[Key] = ()) -> Piece:
    seed = "" if key.seed is None else f", seed {key.seed}"
    return Piece(key, f"{title_of(key.case.task)}: {key.name}{seed}", work, tuple(after))


def _swept(key: Key, settings: StudySettings, earlier: Done, say: Say) -> Front:
    for other, error in earlier.failures.items():  # they begin with the same end, and fail alike
        if isinstance(error, InfeasibleTaskError) and isinstance(other, Key):
            raise NotTriedError(f"not tried, as {other.name} found no motion within the limits")
    sweep, case = METHODS[key.name].sweep, key.case
    return sweep(case.task, settings.profile, bound=case.bound, points=settings.points)


def _polished(method: Method, keys: Sequence[Key], searches: Done, say: Say) -> Polish:
    found = (searches.answers[key] for key in keys if key in searches.answers)
    first = next((front for front in found if front.points), None)
    if first is None:
        raise NotTriedError(f"not tried, as {method.name} found no front to start from")
    return polish_front(first)


def _floor(case: Case, earlier: Done, say: Say) -> Floor:
    return energy_floor(case.task)


@dataclass(frozen=True, eq=False)
class CaseStudy:
    """What a study found for one task."""

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
    done: int | None = None
    stopped: str = ""


def amount_of_work(cases: Sequence[Case], settings: StudySettings) -> int:
    """How many pieces of work `run_study` begins."""
    return sum(len(pieces_of(case, settings)) for case in cases)


def run_study(
    cases: Sequence[Case] = CONDITIONS,
    settings: StudySettings | None = None,
    begin: Callable[[str], None] = lambda name: None,
) -> Study:
    """Run every method on every case and compare what they find."""
    began = time.perf_counter()
    settings = StudySettings() if settings is None else settings
    for front in settings.fronts:
        if all(front.task != case.task for case in cases):
            raise ValueError(
                f"the front by {front.method} is of another task, {title_of(front.task)}; leave it "
                "out, or give the task that it is of"
            )
    pieces = [piece for case in cases for piece in pieces_of(case, settings)]
    where = Workers(settings.workers, settings.scheduler)
    done = run_pieces(pieces, Listener(begin), workers=where, note=QuietarmError)
    with note_interrupts():  # what was found is put together to the end
        found = [_case_study(case, settings, done) for case in cases]
    studied = tuple(case for case in found if case is not None)
    if not studied:
        floors = [words for case in cases for words in _floor_words(case, done)]
        if done.stopped == INTERRUPTED and not floors:
            raise KeyboardInterrupt
        words = "; ".join([f"{done.stopped} before there was a front", *floors])
        raise QuietarmError(words)
    number = done.number if done.stopped else None
    return Study(settings, studied, time.perf_counter() - began, number, done.stopped)


def _case_study(case: Case, settings: StudySettings, done: Done) -> CaseStudy | None:
    """What was found for a case; None where the work was stopped before that was anything."""
    keys = [piece.key for piece in pieces_of(case, settings) if isinstance(piece.key, Key)]
    fronts = [front for key in keys for front in _fronts_of(key, done) if front.points]
    if not fronts and done.stopped:
        return None
    fronts += [front for front in settings.fronts if front.task == case.task]
    failures, floor = _what_is_missing(keys, done), _found(Key(case, FLOOR), done)
    if len(fronts) < 2 and not done.stopped:
        why = "; ".join([*failures, *_floor_words(case, done)])
        raise SolverFailedError(f"{title_of(case.task)}: no two fronts to compare; {why}")
    polishes = {
        method.name: done.answers[key]
        for method in settings.searches
        if (key := Key(case, method.then_polished().name)) in done.answers
    }
    return CaseStudy(
        case=case,
        comparison=compare_fronts(fronts, floor=None if floor is None else floor.energy, least=1),
        polishes=polishes,
        floor=floor,
        paper=tuple(paper_points(case.task, {settings.terms})),
        failures=tuple(failures),
    )


def _floor_words(case: Case, done: Done) -> list[str]:
    """The floor of a case in words, where it was found: without a front there is no page for it."""
    floor = _found(Key(case, FLOOR), done)
    return [] if floor is None else [f"floor of {title_of(case.task)}: {floor.energy:.6g} J"]


def _found(key: Hashable, done: Done) -> Any:
    """What a piece found, whole or in part; None where it found nothing."""
    return done.answers.get(key, done.parts.get(key))


def _fronts_of(key: Key, done: Done) -> list[Front]:
    """The front that a piece found, whole or in part."""
    found = _found(key, done)
    found = found.front if isinstance(found, Polish) else found
    return [found] if isinstance(found, Front) else []


def _what_is_missing(keys: Sequence[Key], done: Done) -> list[str]:
    """What did not come to its end, and why: a line for each method and reason."""
    seeds = Counter(key.name for key in keys)
    troubles = Counter((key.name, _trouble(key, done)) for key in keys)
    return [
        f"{name}{f' ({count} of {seeds[name]} seeds)' if seeds[name] > 1 else ''}: {trouble}"
        for (name, trouble), count in troubles.items()
        if trouble
    ]


def _trouble(key: Key, done: Done) -> str:
    """Why the answer of a piece is missing; empty where it is not."""
    if key in done.failures:
        return str(done.failures[key])
    if key in done.parts:
        return "interrupted, with what was found until then"
    if key not in done.answers:
        return "not done before the interruption"
    return "found no point" if any(not front.points for front in _fronts_of(key, done)) else ""
