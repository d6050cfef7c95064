"""The base class of a user's own search, which commands know by its name."""

from __future__ import annotations

import re
from abc import ABC
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from quietarm.metaheuristics.methods.settings import Value
from quietarm.metaheuristics.named_method import BY_GRADIENT
from quietarm.ocp.checks import failed_in, forgotten_if_refused, quoted

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm

    from quietarm.metaheuristics.problems.recorded import RecordedFunction


class SearchMethod(ABC):
    """A user's own search: a class with a `name`, and either `run` or `algorithm`.

    `quietarm.search` and the commands search, bench and list know it by its name as soon as it is
    defined, in a `--plant-file` or anywhere in Python. Its settings are the fields of a dataclass,
    numbers or words with defaults: ``--setting step=0.1``.

    Raises
    ------
    ValueError
        If a subclass has no name that can be typed, or defines neither method.
    """

    name: ClassVar[str]
    """The name that is typed: small letters, digits and hyphens."""
    label: ClassVar[str]
    """The name in tables; by default `name`."""
    budget: ClassVar[int] = 10_000
    """Default number of candidates of `run`."""
    population: ClassVar[int] = 100
    """Default population of `algorithm`."""
    generations: ClassVar[int] = 400
    """Default number of generations of `algorithm`."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "name" in vars(cls):
            with forgotten_if_refused(cls):
                _check_definition(cls)

    def run(self, function: RecordedFunction, seed: int, budget: int) -> None:
        """Ask the problem's function for candidates until the budget is spent.

        Parameters
        ----------
        function : RecordedFunction
            Call it with candidates between its `lower` and `upper`, shape (candidates, variables).
            It returns objectives and violations of limits, one row for each candidate. It keeps the
            front, and ends the search after the last candidate of the budget.
        seed : int
            Seed of the random numbers.
        budget : int
            Number of candidates.
        """
        raise NotImplementedError

    def algorithm(self, population: int) -> Algorithm:
        """Return a new algorithm of pymoo for a population of this size."""
        raise NotImplementedError

    def __call__(self, function: RecordedFunction, seed: int, budget: int) -> None:
        """Run it; ValueError in one line if its code fails, or asks for no candidate."""
        try:
            self.run(function, seed, budget)
        except Exception as error:
            raise failed_in(f"search {self.name}", type(self), error) from error
        if not function.archive.evaluations:
            raise ValueError(
                f"search {self.name} asked for no candidate; call function(candidates), one a row"
            )

    def make(self, population: int) -> Algorithm:
        """Return the algorithm; ValueError in one line if its code fails."""
        try:
            return self.algorithm(population)
        except Exception as error:
            raise failed_in(f"search {self.name}", type(self), error) from error

    @classmethod
    def defaults(cls) -> Mapping[str, Value]:
        """Return its settings with their defaults; ValueError if a field has none."""
        entries = dict[str, Any]()
        for field in fields(cls) if is_dataclass(cls) else ():
            if field.default is MISSING or not isinstance(field.default, float | int | str):
                raise ValueError(
                    f"{field.name} of the search {cls.name} has no default; give a number or a word"
                )
            entries[field.name] = field.default
        return entries

    @classmethod
    def check(cls, name: str, value: object) -> Value:
        """Return a value of the type of the default; ValueError for another type."""
        default = cls.defaults()[name]
        kind = float if isinstance(default, float) else type(default)
        fits = isinstance(value, kind) and isinstance(value, bool) == isinstance(default, bool)
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            return float(value)
        if not fits or not isinstance(value, float | int | str):
            words: dict[type, str] = {
                float: "a number",
                int: "a whole number",
                bool: "true or false",
            }
            raise ValueError(f"{name} is {value!r}; give {words.get(kind, 'a word')}")
        return value


def _check_definition(kind: type[SearchMethod]) -> None:
    """Raise ValueError for a class that is not a complete search; label it otherwise."""
    name: Any = kind.name
    if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9-]*", name):
        raise ValueError(
            f"name of the search {kind.__name__} is {quoted(name)}; give small letters, digits "
            "and hyphens"
        )
    if name in BY_GRADIENT:
        raise ValueError(f"search {name} has the name of a gradient method; give another")
    if "label" not in vars(kind):
        kind.label = name
    if kind.run is SearchMethod.run and kind.algorithm is SearchMethod.algorithm:
        raise ValueError(
            f"search {name} does nothing; define run(self, function, seed, budget), or "
            "algorithm(self, population)"
        )
