"""Fronts as documents: how each was found, its ends and knee, what is missing, the spread."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from quietarm.metaheuristics.ensemble import (
    SEARCH_RESIDUAL,
    Spread,
    energies_at,
    energy_at,
    hypervolumes,
)
from quietarm.ocp import CrossCheck, FailedPoint, Front, FrontPoint
from quietarm.ocp.front.curve import RESIDUAL_LIMIT
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.robustness.perturbed import worst_of
from quietarm.studies.display.words import counted, energy_words, millimetres, residual_words
from quietarm.studies.document.blocks import Document, Lines
from quietarm.studies.reports.plan import worst_in_words

_SOLVERS = {"sqp": "sequential quadratic programs", "ipopt": "IPOPT"}


def sweep_document(front: Front, asked_for: int, check: CrossCheck | None = None) -> Document:
    """A front by the gradient, of which so many points were asked for."""
    lines = [
        *energy_words(front.task),
        f"{front.method}: {counted(len(front.points), 'point')}, "
        f"{counted(front.iterations, 'iteration')} of the solver "
        f"in {front.seconds:.1f} s{_state(front)}",
        *_point_lines(front),
        *_level_lines(front),
        *_scenario_lines(front),
        *([] if check is None else [_check_line(check)]),
        *failure_lines(front, asked_for),
        *(
            f"no weight reaches residuals from {residual_words(begin)} to {millimetres(end)}: the "
            "front is not convex there"
            for begin, end in front.gaps
        ),
    ]
    return Document("", [Lines(lines)])


def searches_document(fronts: Sequence[Front], notes: Sequence[str] = ()) -> Document:
    """Fronts of searches, and the spread of those that are complete."""
    lines = energy_words(fronts[0].task)
    for front in fronts:
        seed = "" if front.seed is None else f", seed {front.seed}"
        lines += [
            f"{front.method}{seed}: {counted(len(front.points), 'point')}, "
            f"{counted(front.evaluations, 'candidate')} in {front.seconds:.1f} s, "
            f"{front.failed} failed{_state(front)}",
            *_point_lines(front),
        ]
    complete = [front for front in fronts if front.complete]
    if len(complete) > 1:
        energies, level = energies_at(complete), millimetres(SEARCH_RESIDUAL)
        lines += [
            f"hypervolume: {_quartiles(hypervolumes(complete), '.4f')} of the box up to "
            f"{millimetres(complete[0].reference[0])} and {complete[0].reference[1]:.3g} J",
            f"energy at {level}: {_quartiles(energies, '.4g', ' J')}; "
            f"{energies.count} of {energies.seeds} seeds reach {level}",
        ]
    return Document("", [Lines([*lines, *notes])])


def failure_lines(front: Front, asked_for: int) -> list[str]:
    """How many of the points asked for failed, and why; none where none did."""
    if not front.failures:
        return []
    reasons: dict[str, list[str]] = {}
    for failure in front.failures:
        reasons.setdefault(failure.reason, []).append(_asked(failure))
    return [
        f"{len(front.failures)} of {asked_for} points could not be found:",
        *(f"  {', '.join(asked)}: {reason}" for reason, asked in reasons.items()),
    ]


def _state(front: Front) -> str:
    return "" if front.complete else " (interrupted: what was found until then)"


def _point_lines(front: Front) -> list[str]:
    """The ends and the knee, a line each; of two points none is a knee."""
    if not front.points:
        return []
    chosen = {"stillest": front.stillest(), "knee": front.knee(), "cheapest": front.cheapest()}
    if len(front.points) < 3:
        del chosen["knee"]
    return [f"  {name:15}{_point_in_words(front, point)}" for name, point in chosen.items()]


def _level_lines(front: Front) -> list[str]:
    """The least energy within some residuals."""
    energies = {level: energy_at(front, level) for level in LEVELS}
    return [
        f"  {f'within {millimetres(level)}':15}{'none' if energy != energy else f'{energy:.4g} J'}"
        for level, energy in energies.items()  # NaN where there is none
    ]


def _point_in_words(front: Front, point: FrontPoint) -> str:
    """Energy and residual; of an uncertain plant also what is left between its samples."""
    words = f"{point.energy:.4g} J at {residual_words(point.residual)}"
    worst = worst_of(front.task, front.profile, point.coefficients)
    return words if worst is None else f"{words}; at worst {worst_in_words(worst)}"


def _scenario_lines(front: Front) -> list[str]:
    """Of an uncertain task, what its residuals are."""
    if front.task.uncertainty is None:
        return []
    return [
        f"the front of {len(front.task.scenarios)} scenarios: a residual is the largest over them; "
        "between them more may be left, as plans say"
    ]


def _check_line(check: CrossCheck) -> str:
    """By how much the other solver's energies differ."""
    found = [point for point in check.points if point.other == point.other]  # not NaN
    missing = len(check.points) - len(found)
    shares = [point.difference for point in found] or [float("nan")]
    return (
        f"checked by {_SOLVERS[check.solver]}, {counted(len(check.points), 'point')} from the "
        f"plain cycloid: its energies differ by {min(shares):+.1g} to {max(shares):+.1g}"
        " of their size" + f"; {missing} it did not find" * (missing > 0)
    )


def _asked(failure: FailedPoint) -> str:
    if RESIDUAL_LIMIT in failure.asked:
        return f"residual <= {millimetres(failure.asked[RESIDUAL_LIMIT])}"
    return ":".join(f"{weight:.3g}" for weight in failure.asked.values()) + " (residual:energy)"


def _quartiles(spread: Spread, form: str, unit: str = "") -> str:
    if not spread.count:
        return "none"
    if not isfinite(spread.median):
        return "median not reached"
    upper = f"{spread.upper:{form}}{unit}" if isfinite(spread.upper) else "not reached"
    return f"median {spread.median:{form}}{unit}, quartiles {spread.lower:{form}} to {upper}"
