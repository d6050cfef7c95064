"""What defines a search: all that its front depends on, and how it stands in a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import metadata
from typing import Any

from quietarm.ocp import JointProfile, PointToPoint
from quietarm.ocp.checks import whole
from quietarm.ocp.record import coefficient_bound, versions

MOST_INDIVIDUALS, MOST_GENERATIONS = 100_000, 1_000_000


def number_of_individuals(value: object) -> int:
    """The size of a population as an int; ValueError when it is out of range."""
    # a crossing takes a pair, and a swarm of one has nobody to learn from
    because = f"{MOST_INDIVIDUALS} take 1.6 GB of memory"
    return whole("population", value, 2, MOST_INDIVIDUALS, because)


def number_of_generations(value: object) -> int:
    """A number of generations as an int; ValueError when it is out of range."""
    return whole("generations", value, 1, MOST_GENERATIONS, "the longest of the paper's takes 500")


@dataclass(frozen=True)
class SearchSettings:
    """What is asked of any algorithm."""

    bound: float
    population: int | None
    generations: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "bound", coefficient_bound(self.bound))
        if self.population is not None:
            object.__setattr__(self, "population", number_of_individuals(self.population))
        object.__setattr__(self, "generations", number_of_generations(self.generations))


@dataclass(frozen=True)
class SearchSpec:
    """What a search is; with the same versions, the same one gives the same front."""

    task: PointToPoint
    profile: JointProfile
    method: str
    settings: SearchSettings
    seed: int
    algorithm: Mapping[str, Any]

    def __post_init__(self) -> None:
        object.__setattr__(self, "seed", whole("seed", self.seed, 0))
        self.profile.refuse_no_choice()


def search_versions() -> dict[str, str]:
    """Versions of what computes a search."""
    return {**versions(), "pymoo": metadata.version("pymoo")}
