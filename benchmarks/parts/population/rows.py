"""The rows of the tables: every way to evaluate a population, with steps of equal error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from parts.population.equations import PROFILE, TASK, Values, numbers, peak_after
from parts.population.marches import march_arrays, march_compiled
from parts.population.one_by_one import integrate, rates_in_floats, rates_in_numpy

from quietarm.metaheuristics.evaluation.population import objectives_of, search_evaluator
from quietarm.ocp.simulation.evaluator import Evaluator
from quietarm.ocp.simulation.mesh import Mesh

CANDIDATES = 200
FEW, TUNING = 5, 40  # candidates of solve_ivp: to time, to choose its samples
ENERGY_ERROR, ARRIVAL_ERROR, SHARE, REFERENCE_STEPS = 1e-4, 1e-6, 0.9, 1500
FEWER_STEPS = range(14, 60, 2)
STEPS = (20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60, 64, 70, 76, 82, 90, 100, 110, 120, 135, 150,
         170, 190, 210, 240, 270, 300, 350, 400)  # fmt: skip
SAMPLES = (200, 300, 400, 600, 800, 1000, 1500, 2000, 4000)


def even(steps: int) -> NDArray[np.float64]:
    return np.linspace(0.0, 1.0, steps + 1)


def graded(steps: int) -> NDArray[np.float64]:
    return Mesh(steps).boundaries


@dataclass(frozen=True)
class Method:
    """A row of the tables.

    `errors` are of every candidate: of F2 (relative), W at arrival [m], F1 (relative). `target` is
    the least ratio to quietarm that is asked for, where there is one.
    """

    title: str
    steps: str
    errors: tuple[NDArray[np.float64], ...]
    call: Callable[[], object]
    candidates: int = CANDIDATES
    target: float | None = None


def errors_of(values: Values, reference: Values) -> tuple[NDArray[np.float64], ...]:
    difference = np.abs(values - reference)
    relative = difference / np.abs(reference)
    return relative[:, 1], difference[:, 2], relative[:, 0]


def accurate(errors: tuple[NDArray[np.float64], ...]) -> bool:
    energy, arrival, _ = errors
    return bool(
        np.quantile(energy, SHARE) <= ENERGY_ERROR and np.quantile(arrival, SHARE) <= ARRIVAL_ERROR
    )


def by_rollout(population: NDArray[np.float64], steps: int) -> Values:
    """Evaluate the population with the peak after arrival in closed form."""
    x = numbers(TASK)
    evaluation = Evaluator(TASK, PROFILE, steps)(population)
    arrival = evaluation.arrival[:, 0]
    peaks = [peak_after(x, *state) for state in arrival]
    return np.column_stack([peaks, evaluation.energy[:, 0], arrival[:, 0]])


def tuned(
    title: str,
    choices: Sequence[tuple[str, Callable[[NDArray[np.float64]], Values]]],
    population: NDArray[np.float64],
    reference: Values,
    timed_on: int = CANDIDATES,
    target: float | None = None,
) -> Method:
    """The first of the choices that is accurate enough."""
    for name, march in choices:
        errors = errors_of(march(population), reference)
        if accurate(errors):
            call = partial(march, population[:timed_on])
            return Method(title, name, errors, call, timed_on, target)
    raise RuntimeError(f"{title}: {choices[-1][0]} are not accurate enough")


def ours(
    title: str, steps: int | None, population: NDArray[np.float64], reference: Values
) -> Method:
    """The evaluator with the steps of every search or another number of steps."""
    evaluator = search_evaluator(TASK, PROFILE, steps)

    def objectives(population: NDArray[np.float64]) -> NDArray[np.float64]:
        return objectives_of(evaluator(population))

    arrival = by_rollout(population, evaluator.steps)[:, 2]
    figures = np.column_stack([objectives(population), arrival])
    call = partial(objectives, population)
    return Method(title, f"{evaluator.steps} graded", errors_of(figures, reference), call)


def methods(population: NDArray[np.float64]) -> list[Method]:
    """First quietarm, then the others, with steps that make them as accurate as asked."""
    x, reference = numbers(TASK), by_rollout(population, REFERENCE_STEPS)
    fewer = (ours("quietarm, Evaluator", n, population, reference) for n in FEWER_STEPS)
    rows = [
        next(method for method in fewer if accurate(method.errors)),
        ours("quietarm, default steps", None, population, reference),
    ]
    for title, march, option, spacing, target in (
        ("numba loop", march_compiled, False, even, 1.0),
        ("numba loop, graded", march_compiled, False, graded, 1.0),
        ("numba loop, trapezoid", march_compiled, True, even, None),
        ("NumPy, time by time", march_arrays, False, even, 5.0),
        ("NumPy, time by time, graded", march_arrays, False, graded, 5.0),
        ("NumPy, all at once, graded", march_arrays, True, graded, None),
    ):
        choices = [
            (f"{steps} {spacing.__name__}", partial(march, x, spacing(steps), option))
            for steps in STEPS
        ]
        rows.append(tuned(title, choices, population, reference, target=target))
    for title, equations, through, target in (
        ("solve_ivp, in NumPy, F1 too", rates_in_numpy, True, 3000.0),
        ("solve_ivp, in NumPy", rates_in_numpy, False, 3000.0),
        ("solve_ivp, in floats, F1 too", rates_in_floats, True, None),
        ("solve_ivp, in floats", rates_in_floats, False, None),
    ):
        choices = [
            (f"{samples} samples", partial(integrate, x, samples, equations, through))
            for samples in SAMPLES
        ]
        rows.append(tuned(title, choices, population[:TUNING], reference[:TUNING], FEW, target))
    return rows
