"""Fronts of a user's own function in lines: how each was found, and its ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from quietarm.metaheuristics.spread import hypervolumes
from quietarm.ocp import Front
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.views.report.words import (
    corner_words,
    counted,
    spread_words,
    values_of_function,
)


def function_lines(fronts: Sequence[Front]) -> list[str]:
    """Fronts of one function, and the spread over several seeds."""
    lines = [_answer(fronts)]
    for front in fronts:
        record = front.record
        seed = "" if record.seed is None else f", seed {record.seed}"
        broken = f", {front.infeasible} violate a constraint" if front.infeasible else ""
        lines += [
            f"{record.method}{seed}: {counted(len(front.points), 'point')}, "
            f"{counted(record.evaluations, 'candidate')} in {record.seconds:.1f} s, "
            f"{front.failed} failed{broken}",
            *_chosen_points(front),
        ]
    function: Any = fronts[0].task
    lines.append(f"values are those that the function {function.name} gave")
    if len(fronts) > 1 and len({front.reference for front in fronts}) == 1:
        lines.append(
            f"hypervolume: {spread_words(hypervolumes(fronts), '.4f')} of the area up to "
            f"{corner_words(fronts[0])}, median (quartiles)"
        )
    return lines


def _answer(fronts: Sequence[Front]) -> str:
    """Say between which values the fronts of a function reach, the least of each objective."""
    known = [front for front in fronts if isinstance(front, FunctionFront) and front.points]
    if not known:
        return "No candidate is on a front."
    outputs = known[0].outputs
    least = [min(float(front.objective_values[:, k].min()) for front in known)
             for k in range(len(outputs))]  # fmt: skip
    what = "The front reaches" if len(fronts) == 1 else f"The fronts of {len(fronts)} seeds reach"
    values = [
        f"{entry.label} {value:.4g} {entry.unit}".rstrip() for entry, value in zip(outputs, least)
    ]
    return f"{what} {' and '.join(values)}, each at its least."


def _chosen_points(front: Front) -> list[str]:
    """The least of each objective, and the knee, a line each."""
    if not isinstance(front, FunctionFront) or not front.points:
        return []
    table = front.objective_values
    rows = {f"least {entry.label}:": int(table[:, k].argmin())
            for k, entry in enumerate(front.outputs)}  # fmt: skip
    if front.has_knee:
        rows["knee:"] = front.points.index(front.knee())  # pyright: ignore[reportArgumentType]
    width = max(15, *(len(name) + 1 for name in rows))
    return [
        f"  {name:{width}}{values_of_function(front, table[row].tolist())}"
        for name, row in rows.items()
    ]
