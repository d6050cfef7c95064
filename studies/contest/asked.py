"""What is asked of a contest, and whether it fits what its folder holds."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from quietarm.metaheuristics import PRESETS, NamedProblem
from quietarm.metaheuristics.algorithms.settings import Value, with_defaults
from quietarm.metaheuristics.budget.run import check_method, number_of_evaluations, parts_of
from quietarm.metaheuristics.ensemble import seeds_of
from quietarm.metaheuristics.objective.claims import check_figures
from quietarm.metaheuristics.runs.settings import number_of_individuals, search_versions
from quietarm.metaheuristics.sharing.workers import HERE, Workers
from quietarm.studies.contest.names import POPULATION, name_of, sets_population
from quietarm.studies.contest.problems import Yardstick
from quietarm.studies.contest.runs import Key, Run
from quietarm.studies.contest.store import Store
from quietarm.studies.display.words import counted

_REMEDY = "remove it to have it made again"
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
        if POPULATION in own and search in PRESETS:
            population = number_of_individuals(own.pop(POPULATION))
            stated[POPULATION] = population
        if search in PRESETS:
            known = PRESETS[search].settings
            defaults, values = with_defaults(method, known, {}), with_defaults(method, known, own)
            own = {name: values[name] for name in own if values[name] != defaults[name]}
        return cls(method, own, population, name_of(method, {**stated, **own}))

    def can_search(self, problem: NamedProblem) -> bool:
        """Whether it keeps the limits of a problem, where that has some."""
        search, _ = parts_of(self.method)
        return not problem.task.limits or search not in PRESETS or PRESETS[search].keeps_limits


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
    workers: Workers = HERE

    def __post_init__(self) -> None:
        object.__setattr__(self, "methods", tuple(dict.fromkeys(self.methods)))
        seeds_of(self.seed, self.runs)
        number_of_evaluations(self.evaluations)
        if self.population is not None:
            number_of_individuals(self.population)
        for entry in self.entries.values():
            check_method(entry.method, entry.population, entry.settings)
        if not self.keys:
            raise ValueError(f"{self.left_out[0]}; give another method or problem")

    @property
    def entries(self) -> dict[str, Entry]:
        """The methods as they take part, by what each is called."""
        entries = [
            Entry.of(method, self.settings.get(method, {}), self.population)
            for method in self.methods
        ]
        return {entry.name: entry for entry in entries}

    @property
    def keys(self) -> list[Key]:
        """All runs: every method on every problem from one seed, then from the next.

        So a contest that is stopped has as many runs of one method, and on one problem, as of
        another.
        """
        return [
            Key(problem.name, name, seed)
            for seed in seeds_of(self.seed, self.runs)
            for problem in self.problems
            for name, entry in self.entries.items()
            if entry.can_search(problem)
        ]

    def how_far(self, runs: Container[Key], folder: Path) -> str:
        """How many of the runs are there, in words."""
        there = sum(key in runs for key in self.keys)
        left = len(self.keys) - there
        more = f"; {left} are to be done" if left else ""
        return f"{there} of {counted(len(self.keys), 'run')} are in {folder}{more}"

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
    for problem in contest.problems:
        known = store.yardsticks.get(problem.name)
        if known is not None and (known.bound, known.front.task, known.front.profile) != (
            problem.bound, problem.task, problem.profile,
        ):  # fmt: skip
            raise ValueError(
                f"{store.path} has another move or box of the name {problem.name}; give another "
                "--output"
            )
    for run in [*store.runs.values(), *store.imports.values()]:
        yardstick = store.yardsticks.get(run.problem)
        if yardstick is None:
            place = store.place(Yardstick, run.problem)
            raise ValueError(
                f"{store.path} has runs on {run.problem} without its exact front; put back "
                f"{place}, or give another --output"
            )
        of_run = run.scale, run.front.settings.get("bound"), run.front.task, run.front.profile
        of_problem = (
            yardstick.scale, yardstick.bound, yardstick.front.task, yardstick.front.profile,
        )  # fmt: skip
        if of_run != of_problem:
            raise ValueError(
                f"{store.path} has a run in another box, on another move or against another exact "
                f"front ({run.words}); remove it, or give another --output"
            )
        check_figures(run.front, str(store.place(type(run), run.key)), _REMEDY)
    for run in store.runs.values():
        _check_amounts(run, contest, store.path)
    if any(key not in store.runs for key in contest.keys):
        _check_versions(store.runs.values(), store.path)


def _check_amounts(run: Run, contest: Contest, folder: Path) -> None:
    if run.budget != contest.evaluations:
        raise ValueError(
            f"{folder} has runs of {run.budget} evaluations ({run.words}) and "
            f"{contest.evaluations} are asked for; give --evaluations {run.budget}, or another "
            "--output"
        )
    if run.population != contest.population and not sets_population(run.method):
        theirs, asked = (
            "the method's own" if size is None else size
            for size in (run.population, contest.population)
        )
        remedy = f"give --population {theirs}" if run.population else "leave --population out"
        raise ValueError(
            f"{folder} has a run whose population is {theirs} ({run.words}) and {asked} is asked "
            f"for; {remedy}, or another --output"
        )


def _check_versions(runs: Iterable[Run], folder: Path) -> None:
    ours = search_versions()
    for run in runs:
        for name in _CODE:
            theirs = run.front.versions.get(name, "unknown")
            if theirs != ours[name]:
                raise ValueError(
                    f"{folder} has runs of {name} {theirs} ({run.words}), and new ones would be of "
                    f"{ours[name]}; install {name} {theirs}, or give another --output"
                )
