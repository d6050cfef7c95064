"""Build a method that is known by name from pymoo's parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from itertools import product
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

from quietarm.metaheuristics.algorithms.velocity import VelocityRule
from quietarm.metaheuristics.methods.settings import Value
from quietarm.metaheuristics.thinning import farthest_apart
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.ocp.solvers.sqp import Sqp

_OPERATORS: Mapping[str, Callable[..., Any]] = {
    "crossover": SBX,
    "mutation": PM,
    "rule": VelocityRule,
    "solver": lambda **options: SOLVERS[Sqp.name](**options),
}
"""Arguments of an algorithm that have arguments of their own."""


def with_arguments(kind: str, values: Mapping[str, Value]) -> Callable[..., Any]:
    """A class or function, as ``module:name``, with values of its arguments.

    Operators are made anew, of ``crossover.eta`` and the like: those of pymoo's default arguments
    are shared, and some remember a run.
    """
    arguments = dict[str, Any]()
    operators = dict[str, dict[str, Value]]()
    for name, value in values.items():
        operator, dot, argument = name.partition(".")
        if dot:
            operators.setdefault(operator, {})[argument] = value
        else:
            arguments[name] = value
    for operator, options in operators.items():
        arguments[operator] = _OPERATORS[operator](**options)
    module, _, name = kind.partition(":")
    return partial(getattr(import_module(module), name), **arguments)


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
