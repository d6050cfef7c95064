"""The state from which an algorithm goes on, and its parts, checked as they are read.

A file may hold anything: every function raises KeyError where an entry is missing, TypeError or
ValueError where it is not what a state has there.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from pymoo.core.population import Population
from quietarm.ocp.base.checks import finite, whole

POPULATION_ARRAYS = ("X", "F", "G", "H")


@runtime_checkable
class Resumable(Protocol):
    """An algorithm whose run can be saved to a file and continued, bit for bit."""

    @property
    def settings(self) -> dict[str, Any]:
        """What a state is of, in plain numbers and words."""
        ...

    def state(self) -> dict[str, Any]:
        """All that the run needs to go on: a nested plain dict."""
        ...

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on from a `state`; call it after `setup` with the settings of that run."""
        ...


def part_of(state: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """An entry that is a table itself."""
    if not isinstance(state[name], Mapping):
        raise TypeError(f"{name} is not a table")
    return state[name]


def number_of(state: Mapping[str, Any], name: str) -> float:
    """An entry that is a finite number."""
    return finite(name, _no_array(state, name))


def count_of(state: Mapping[str, Any], name: str, least: int = 0) -> int:
    """An entry that is a whole number of at least `least`."""
    return whole(name, _no_array(state, name), least)


def array_of(
    state: Mapping[str, Any],
    name: str,
    shape: tuple[int, ...],
    least: float | None = None,
    most: float = math.inf,
) -> NDArray[np.float64]:
    """An entry that is an array of numbers, as a copy of its own."""
    values = np.array(state[name])
    if values.dtype.kind not in "fiu":
        raise TypeError(f"{name} is not an array of numbers")
    values = values.astype(float)
    if values.size == 0 and shape[0] < 1:
        values = values.reshape(0, *shape[1:])  # no rows; a list of none does not say how long
    wanted = (len(values) if shape[0] == -1 and values.ndim else shape[0], *shape[1:])
    if values.shape != wanted:
        raise ValueError(f"{name} has shape {values.shape}, where a state has {shape}")
    low, high = (-sys.float_info.max, sys.float_info.max) if least is None else (least, most)
    if not (math.isnan(low) or np.all((values >= low) & (values <= high))):
        raise ValueError(f"{name} has entries that are not from {low:g} to {high:g}")
    return values


def population_of(columns: Mapping[str, Any], problem: Any, rows: int = -1) -> Any:
    """A population that counts as evaluated."""
    sizes = (problem.n_var, problem.n_obj, problem.n_ieq_constr, problem.n_eq_constr)
    arrays: dict[str, NDArray[np.float64]] = {}
    for name, size in zip(POPULATION_ARRAYS, sizes, strict=True):
        # the objectives and constraints of a candidate that failed may be anything
        arrays[name] = array_of(columns, name, (rows, size), None if name == "X" else math.nan)
        rows = len(arrays[name])
    population = Population.new(**arrays)
    population.apply(lambda individual: individual.evaluated.update({"F", "G", "H"}))
    return population


def restore_generator(generator: np.random.Generator, state: Mapping[str, Any]) -> None:
    """Let the random numbers go on as from the state's entry `random_state`."""
    saved = part_of(state, "random_state")
    if not _alike(saved, generator.bit_generator.state):
        raise ValueError("random_state is not one of NumPy's generator")
    try:
        generator.bit_generator.state = saved
    except (OverflowError, ValueError):
        raise ValueError("random_state is out of the range of NumPy's generator") from None


def _alike(saved: Any, own: Any) -> bool:
    """Whether two states of generators have the same names, kinds of numbers, and words."""
    if isinstance(own, Mapping):
        same_names = isinstance(saved, Mapping) and saved.keys() == own.keys()
        return same_names and all(_alike(saved[name], own[name]) for name in own)
    return type(saved) is int if isinstance(own, int) else saved == own


def _no_array(state: Mapping[str, Any], name: str) -> object:
    if isinstance(state[name], np.ndarray | list | Mapping):  # no message shows a whole one
        raise TypeError(f"{name} is not a number")
    return state[name]
