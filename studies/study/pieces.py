"""The pieces of work of a study: every method on a case, and the floor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

from quietarm.metaheuristics.algorithms.presets import preset_of
from quietarm.metaheuristics.ensemble import one_seed, seeds_of
from quietarm.metaheuristics.runs.settings import number_of_generations, number_of_individuals
from quietarm.metaheuristics.sharing.pieces import Done, NotTriedError, Piece, Say, to_the_end
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import (
    CycloidPolynomial,
    Floor,
    Front,
    InfeasibleTaskError,
    Polish,
    energy_floor,
    polish_front,
)
from quietarm.ocp.answers.provenance import number_of_points
from quietarm.ocp.base.checks import whole
from quietarm.studies.display.words import title_of
from quietarm.studies.paper.case import Case
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
        CycloidPolynomial(self.terms)
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


class Key(NamedTuple):
    """What the answer of a piece is kept under: a front's method, a polished one's, or `FLOOR`."""

    case: Case
    name: str
    seed: int | None = None


def pieces_of(case: Case, settings: StudySettings) -> list[Piece]:
    """The work on one case."""
    title, pieces = title_of(case.task), list[Piece]()

    def add(key: Key, work: Callable[[Done, Say], Any], *after: Key) -> None:
        seed = "" if key.seed is None else f", seed {key.seed}"
        pieces.append(Piece(key, f"{title}: {key.name}{seed}", work, after))

    earlier: list[Key] = []
    for method in methods_of(Kind.GRADIENT):
        key = Key(case, method.name)
        add(key, partial(_swept, case, method, settings), *earlier)
        earlier.append(key)
    shared = {
        "profile": CycloidPolynomial(settings.terms),
        "bound": case.bound,
        "population": settings.population,
        "generations": settings.generations,
    }
    for method in settings.searches:
        search = {**shared, "settings": settings.settings.get(method.name)}
        seeds = seeds_of(settings.seed, settings.runs)
        keys = [Key(case, method.name, seed) for seed in seeds]
        for seed, key in zip(seeds, keys, strict=True):
            add(key, partial(one_seed, case.task, method.name, search, seed))
        add(Key(case, method.then_polished().name), partial(_polished, method, keys), *keys)
    add(Key(case, FLOOR), partial(_floor, case))
    return pieces


def _swept(case: Case, method: Method, settings: StudySettings, earlier: Done, say: Say) -> Front:
    for key, error in earlier.failures.items():  # they begin with the same end, and fail alike
        if isinstance(error, InfeasibleTaskError) and isinstance(key, Key):
            raise NotTriedError(f"not tried, as {key.name} found no motion within the limits")
    profile = CycloidPolynomial(settings.terms)
    return to_the_end(method.sweep(case.task, profile, bound=case.bound, points=settings.points))


def _polished(method: Method, keys: Sequence[Key], searches: Done, say: Say) -> Polish:
    found = (searches.answers[key] for key in keys if key in searches.answers)
    first = next((front for front in found if front.points), None)
    if first is None:
        raise NotTriedError(f"not tried, as {method.name} found no front to start from")
    return to_the_end(polish_front(first))


def _floor(case: Case, earlier: Done, say: Say) -> Floor:
    return to_the_end(energy_floor(case.task))
