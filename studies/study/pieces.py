"""The pieces of work of a study: every method on a case, and the floor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

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
    return to_the_end(sweep(case.task, settings.profile, bound=case.bound, points=settings.points))


def _polished(method: Method, keys: Sequence[Key], searches: Done, say: Say) -> Polish:
    found = (searches.answers[key] for key in keys if key in searches.answers)
    first = next((front for front in found if front.points), None)
    if first is None:
        raise NotTriedError(f"not tried, as {method.name} found no front to start from")
    return to_the_end(polish_front(first))


def _floor(case: Case, earlier: Done, say: Say) -> Floor:
    return to_the_end(energy_floor(case.task))
