"""Fronts of searches on the screen: what each holds, and the spread over seeds."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL, Spread, energies_at, hypervolumes
from quietarm.ocp import Front
from quietarm.studies.display.words import counted, millimetres, print_lines
from quietarm.studies.reports.worst import point_in_words
from rich.console import Console


def print_fronts(console: Console, fronts: Sequence[Front]) -> None:
    """Print the ends and the knee of every front, and the spread of those that are complete."""
    for front in fronts:
        print_lines(console, *_front_lines(front))
    complete = [front for front in fronts if front.complete]
    if len(complete) > 1:
        energies = energies_at(complete)
        print_lines(
            console,
            f"hypervolume: {quartiles(hypervolumes(complete), '.4f')}",
            f"energy at {millimetres(SEARCH_RESIDUAL)}: {quartiles(energies, '.4g', ' J')}; "
            f"{reached(energies)}",
        )


def quartiles(spread: Spread, form: str, unit: str = "") -> str:
    """Median and quartiles in words, each number in this form."""
    if not spread.count:
        return "none"
    return (
        f"median {spread.median:{form}}{unit}, quartiles {spread.lower:{form}} to "
        f"{spread.upper:{form}}{unit}"
    )


def reached(spread: Spread) -> str:
    """How many seeds have an energy at `SEARCH_RESIDUAL`."""
    return f"{spread.count} of {spread.seeds} seeds reach {millimetres(SEARCH_RESIDUAL)}"


def _front_lines(front: Front) -> list[str]:
    state = "" if front.complete else " (interrupted: what was found until then)"
    seed = "" if front.seed is None else f", seed {front.seed}"
    lines = [
        f"{front.method}{seed}: {counted(len(front.points), 'point')}, "
        f"{counted(front.evaluations, 'candidate')} in {front.seconds:.1f} s, "
        f"{front.failed} failed{state}"
    ]
    if front.points:
        chosen = {"stillest": front.stillest(), "knee": front.knee(), "cheapest": front.cheapest()}
        lines += [f"  {name:9}{point_in_words(front, point)}" for name, point in chosen.items()]
    return lines
