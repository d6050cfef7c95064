"""A search of one's own, which commands know by its name."""

from __future__ import annotations

import re
from abc import ABC
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from quietarm.metaheuristics.algorithms.settings import Value
from quietarm.ocp.checks import failed_in, quoted

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm

    from quietarm.metaheuristics.problems.recorded import RecordedFunction

_OF_GRADIENT = ("epsilon", "weighted", "multistart")


class SearchMethod(ABC):
    """A search: a name, and `run`, or `algorithm` where pymoo has it.

    A class beside a plant in its `--plant-file`, or anywhere in Python, is known by its name to
    `quietarm.search` and to the commands search, bench and list. What it may be set to are the
    fields of a dataclass, numbers or words with defaults: ``--setting step=0.1``.

    Raises
    ------
    ValueError
        When a subclass has no name that can be typed, or does nothing.
    """

    name: ClassVar[str]
    """What it is called where it is typed: small letters, digits and hyphens."""
    label: ClassVar[str]
    """What it is called in tables; by default the name."""
    budget: ClassVar[int] = 10_000
    """Candidates of `run` where none are asked for."""
    population: ClassVar[int] = 100
    generations: ClassVar[int] = 400
    """Of an `algorithm`, where none are asked for."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        name = vars(cls).get("name")
        if name is None:
            return
        if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9-]*", name):
            raise ValueError(
                f"name of the search {cls.__name__} is {quoted(name)}; give small letters, digits "
                "and hyphens"
            )
        if name in _OF_GRADIENT:
            raise ValueError(f"search {name} has the name of a gradient method; give another")
        if "label" not in vars(cls):
            cls.label = name
        if cls.run is SearchMethod.run and cls.algorithm is SearchMethod.algorithm:
            raise ValueError(
                f"search {name} does nothing; define run(self, function, seed, budget), or "
                "algorithm(self, population)"
            )

    def run(self, function: RecordedFunction, seed: int, budget: int) -> None:
        """Ask a function of a problem for candidates, as often as one likes.

        Parameters
        ----------
        function : RecordedFunction
            Called with candidates within `lower` and `upper`, shape (candidates, variables), it
            returns objectives and violations of limits, a row a candidate. It keeps the front.
        seed : int
            Of the random numbers.
        budget : int
            Candidates in all; with the last of them the search ends.
        """
        raise NotImplementedError

    def algorithm(self, population: int) -> Algorithm:
        """A new algorithm of pymoo for so many individuals."""
        raise NotImplementedError

    def __call__(self, function: RecordedFunction, seed: int, budget: int) -> None:
        """Run it; ValueError in one line where its own lines fail, or ask for nothing."""
        try:
            self.run(function, seed, budget)
        except Exception as error:
            raise failed_in(f"search {self.name}", type(self), error) from error
        if not function.archive.evaluations:
            raise ValueError(
                f"search {self.name} asked for no candidate; call function(candidates), one a row"
            )

    def make(self, population: int) -> Algorithm:
        """The algorithm; ValueError in one line where its own lines fail."""
        try:
            return self.algorithm(population)
        except Exception as error:
            raise failed_in(f"search {self.name}", type(self), error) from error

    @classmethod
    def defaults(cls) -> Mapping[str, Value]:
        """What it may be set to, with the defaults; ValueError of a field without one."""
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
        """A value that is of the kind of the default."""
        default = cls.defaults()[name]
        kind = float if isinstance(default, float) else type(default)
        fits = isinstance(value, kind) and isinstance(value, bool) == isinstance(default, bool)
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            return float(value)
        if not fits or not isinstance(value, float | int | str):
            words = {float: "a number", int: "a whole number", bool: "true or false"}
            raise ValueError(f"{name} is {value!r}; give {words.get(kind, 'a word')}")
        return value
