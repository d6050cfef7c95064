"""Build a method that is known by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

from quietarm.metaheuristics.algorithms.settings import Value
from quietarm.metaheuristics.algorithms.velocity import VelocityRule
from quietarm.ocp.checks import install

if TYPE_CHECKING:
    from quietarm.metaheuristics.algorithms.presets import Preset  # which loads this file late


def built(
    preset: Preset, population: int, values: Mapping[str, Value]
) -> Algorithm | Callable[..., None]:
    """A new algorithm, or a function with its settings.

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
    first = directions(population) if preset.by_directions else population
    return method(first, **arguments)


def directions(number: int) -> NDArray[np.float64]:
    """Evenly spread reference directions of two objectives, shape (number, 2), of sum 1."""
    first = np.linspace(0.0, 1.0, number)
    return np.column_stack([first, 1.0 - first])
