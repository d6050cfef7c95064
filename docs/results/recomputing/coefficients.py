"""Energy within 1 mm by the number of coefficients."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .experiment import GRADIENT_FRONT, TERMS
from .gaps import Results, median_energy
from .runs import Problem


def energy_by_terms(results: Results, crossed: Sequence[str]) -> dict[str, list[dict[str, float]]]:
    """Energy within 1 mm above that of the gradient with most coefficients, medians over moves [%].

    After 10,000 candidates; a run without such a motion counts as infinite.
    """
    most = {Problem(name).move: name for name in results.problems(TERMS[-1])}
    least = {move: runs[0].energy for move, name in most.items() if (runs := results.control(name))}
    figures = {}
    for method in (GRADIENT_FRONT, *crossed):
        budget = 0 if method == GRADIENT_FRONT else 10_000
        figures[method] = []
        for terms in TERMS:
            ratios = [
                median_energy(runs) / least[Problem(name).move]
                for name in results.problems(terms)
                if Problem(name).move in least and (runs := results.of(method, budget, name))
            ]
            above = 100 * (float(np.median(ratios)) - 1) if ratios else float("nan")
            figures[method].append({"terms": terms, "above": above, "moves": len(ratios)})
    return figures


def gain_of_coefficients(
    results: Results, crossed: Sequence[str], fewer: int = 10, more: int = 24
) -> dict[str, dict[str, int]]:
    """On how many moves a method's energy within 1 mm is less with more coefficients.

    After 10,000 candidates; beside it the moves on which it has no such motion with more of them.
    """
    figures = {}
    for method in crossed:
        energies = dict[int, dict[str, float]]()
        for terms in (fewer, more):
            runs_of = {name: results.of(method, 10_000, name) for name in results.problems(terms)}
            energies[terms] = {
                Problem(name).move: median_energy(runs) for name, runs in runs_of.items() if runs
            }
        moves = energies[fewer].keys() & energies[more].keys()
        figures[method] = {
            "moves": len(moves),
            "less": sum(energies[more][move] < energies[fewer][move] for move in moves),
            "none": sum(energies[more][move] == np.inf for move in moves),
        }
    return figures
