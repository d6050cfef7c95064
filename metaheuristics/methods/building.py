"""Build a method that is known by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from itertools import product
from math import comb
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

from quietarm.metaheuristics.algorithms.velocity import VelocityRule
from quietarm.metaheuristics.methods.settings import Value
from quietarm.metaheuristics.thinning import farthest_apart
from quietarm.ocp.checks import install

if TYPE_CHECKING:
    from quietarm.metaheuristics.methods.presets import Preset  # which loads this file late


def built(
    preset: Preset, population: int, values: Mapping[str, Value], objectives: int
) -> Algorithm | Callable[..., None]:
    """A new algorithm for so many objectives, or a function with its settings.

    Its operators are its own: those of pymoo's default arguments are shared, and some remember a
    run.
    """
    operator_kinds: dict[str, Callable[..., Any]] = {
        "crossover": SBX,
        "mutation": PM,
        "rule": VelocityRule,
    }
    if preset.needs and find_spec(preset.needs) is None:
        raise ValueError(f"{preset.name} needs {preset.needs}; {install(preset.needs)}")
    arguments = dict[str, Any]()
    operators = dict[str, dict[str, Value]]()
    for setting in preset.settings:
        operator, dot, argument = setting.argument.partition(".")
        target = operators.setdefault(operator, {}) if dot else arguments
        target[argument if dot else operator] = values[setting.name]
    arguments.update((name, operator_kinds[name](**options)) for name, options in operators.items())
    module, _, kind = preset.kind.partition(":")
    method = getattr(import_module(module), kind)
    if preset.is_function:
        return partial(method, **arguments)
    first = directions(population, objectives) if preset.by_directions else population
    return method(first, **arguments)


def directions(number: int, objectives: int = 2) -> NDArray[np.float64]:
    """Evenly spread reference directions, shape (number, objectives), of sum 1.

    Those of a simplex lattice (Das and Dennis 1998); where none has so many, those of the next
    larger one that are farthest apart.
    """
    if objectives == 2:
        first = np.linspace(0.0, 1.0, number)
        return np.column_stack([first, 1.0 - first])
    parts = 1
    while comb(parts + objectives - 1, objectives - 1) < number:
        parts += 1
    whole_numbers = product(range(parts + 1), repeat=objectives - 1)
    lattice = [(*row, parts - sum(row)) for row in whole_numbers if sum(row) <= parts]
    rows = np.array(lattice) / parts
    return rows if len(rows) == number else rows[farthest_apart(rows, number)]
