"""What is asked of a contest, and whether it fits what its folder holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple, Self

from quietarm.metaheuristics import PRESETS, NamedProblem
from quietarm.metaheuristics.algorithms.settings import Value, with_defaults
from quietarm.metaheuristics.budget.run import check_method, number_of_evaluations, parts_of
from quietarm.metaheuristics.ensemble import seeds_of
from quietarm.metaheuristics.objective.claims import check_figures
from quietarm.metaheuristics.runs.settings import number_of_individuals, search_versions
from quietarm.metaheuristics.sharing.workers import HERE, Workers
from quietarm.studies.contest.names import POPULATION, folder_of, name_of
from quietarm.studies.contest.store import Run, Store
from quietarm.studies.display.words import counted

_REMEDY = "remove it to have it made again"
_OWN = "the method's own"
_CODE = ("quietarm", "pymoo")
"""What decides how a search goes; other libraries change its rounding."""


@dataclass(frozen=True)
class Entry:
    """A method as it takes part."""

    method: str
    settings: Mapping[str, Value]
    population: int | None
    name: str

    @classmethod
    def of(cls, method: str, given: Mapping[str, Value], population: int | None) -> Self:
        """A method with what is given; ValueError where a setting is unknown or out of range."""
        search, _ = parts_of(method)
        own, stated = dict(given), dict[str, Value]()
        if search in PRESETS:
            if POPULATION in own:
                population = stated[POPULATION] = number_of_individuals(own.pop(POPULATION))
            known = PRESETS[search].settings
            defaults, values = with_defaults(method, known, {}), with_defaults(method, known, own)
            own = {name: values[name] for name in own if values[name] != defaults[name]}
        check_method(method, population, own)
        return cls(method, own, population, name_of(method, {**stated, **own}))

    def too_few(self, evaluations: int) -> str:
        """What to say where the evaluations leave few generations."""
        search, _ = parts_of(self.method)
        return PRESETS[search].too_few(evaluations, self.population) if search in PRESETS else ""

    def can_search(self, problem: NamedProblem) -> bool:
        """Whether it keeps the limits of a problem, where that has some."""
        search, _ = parts_of(self.method)
        return not problem.task.limits or search not in PRESETS or PRESETS[search].keeps_limits


class Planned(NamedTuple):
    """A run that is asked for."""

    problem: NamedProblem
    entry: Entry
    seed: int

    @property
    def place(self) -> str:
        """That of the `Run` that it becomes."""
        return f"runs/{self.problem.name}/{folder_of(self.entry.name)}/seed{self.seed}.json"


@dataclass(frozen=True)
class Contest:
    """What is asked of a contest."""

    problems: tuple[NamedProblem, ...]
    methods: tuple[str, ...]
    runs: int = 31
    evaluations: int = 20_000
    seed: int = 0
    population: int | None = None
    settings: Mapping[str, Mapping[str, Value]] = field(default_factory=dict)
    explain: bool = False
    part: tuple[int, int] = (1, 1)
    workers: Workers = HERE

    def __post_init__(self) -> None:
        number_of_evaluations(self.evaluations)
        if self.population is not None:
            number_of_individuals(self.population)
        names = [problem.name for problem in self.problems]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"two problems are called {name}; give each once, by its own name")
        if not self.planned:
            raise ValueError(f"{self.left_out[0]}; give another method or problem")

    @cached_property
    def entries(self) -> dict[str, Entry]:
        """The methods as they take part, by what each is called."""
        given = self.settings
        entries = [Entry.of(name, given.get(name, {}), self.population) for name in self.methods]
        return {entry.name: entry for entry in entries}

    @cached_property
    def planned(self) -> dict[str, Planned]:
        """All runs by their places: every method on every problem from one seed, then the next.

        So a contest that is stopped has as many runs of one method, and on one problem, as of
        another.
        """
        runs = [
            Planned(problem, entry, seed)
            for seed in seeds_of(self.seed, self.runs)
            for problem in self.problems
            for entry in self.entries.values()
            if entry.can_search(problem)
        ]
        return {run.place: run for run in runs}

    @cached_property
    def mine(self) -> dict[str, Planned]:
        """Those of this part, i of n: every n-th."""
        number, of = self.part
        return {place: run for k, (place, run) in enumerate(self.planned.items())
                if k % of == number - 1}  # fmt: skip

    def how_far(self, store: Store) -> str:
        """How many of the runs are there, in words."""
        total, left = len(self.mine), len(self.mine.keys() - store.kept)
        more = f"; {left} are to be done" if left else ""
        return f"{total - left} of {counted(total, 'run')} are in {store.path}{more}"

    @property
    def left_out(self) -> list[str]:
        """Which methods cannot search which problem, in words."""
        return [
            f"{name} cannot search {problem.name}, which has limits: it is left out there"
            for problem in self.problems
            for name, entry in self.entries.items()
            if not entry.can_search(problem)
        ]


def check_alike(store: Store, contest: Contest) -> None:
    """Refuse to add runs to those of a folder that cannot be compared with them."""
    yardsticks = store.yardsticks
    for problem in contest.problems:
        known = yardsticks.get(problem.name)
        asked = problem.bound, problem.task, problem.profile
        if known and (known.bound, known.front.task, known.front.profile) != asked:
            raise ValueError(
                f"{store.path} has another move or box of the name {problem.name}; give another "
                "--output"
            )
    adding = bool(contest.planned.keys() - store.kept)
    for run in store.of(Run):
        exact = yardsticks.get(run.problem)
        if exact is None:
            raise ValueError(
                f"{store.path} has runs on {run.problem} without its exact front; put it back, or "
                "give another --output"
            )
        front, bound = run.front, run.front.settings.get("bound")
        measured = exact.scale, exact.bound, exact.front.task, exact.front.profile
        if (run.scale, bound, front.task, front.profile) != measured:
            raise ValueError(
                f"{store.path} has a run in another box, on another move or against another exact "
                f"front ({run.words}); remove it, or give another --output"
            )
        check_figures(front, str(store.path / run.place), _REMEDY)
        if not run.file:
            _check_amounts(run, contest, store.path, adding=adding)


def _check_amounts(run: Run, contest: Contest, folder: Path, *, adding: bool) -> None:
    """Refuse a run of other evaluations, population or, where others are added, versions."""
    population, ours = run.population, search_versions()
    remedy = f"give --population {population}" if population else "leave --population out"
    spent, budget = run.evaluations, contest.evaluations
    facts: list[tuple[str, object, object, str]] = [
        ("number of evaluations", spent, budget, f"give --evaluations {spent}")
    ]
    if f"{POPULATION}=" not in run.method:
        facts.append((POPULATION, population, contest.population, remedy))
    for name in _CODE if adding else ():
        version = run.front.versions.get(name, "unknown")
        facts.append((f"version of {name}", version, ours[name], f"install {name} {version}"))
    for what, theirs, asked, remedy in facts:
        if theirs != asked:
            raise ValueError(
                f"{folder} has a run of another {what} ({run.words}): {theirs or _OWN}, not "
                f"{asked or _OWN}; {remedy}, or another --output"
            )
