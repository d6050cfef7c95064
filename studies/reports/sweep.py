"""The gradient's fronts on the screen: ends, knee, energies, and what is missing."""

from __future__ import annotations

from quietarm.metaheuristics.ensemble import energy_at
from quietarm.ocp import CrossCheck, FailedPoint, Front, UncertainPlant
from quietarm.ocp.front.checking import RESIDUAL_LIMIT
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.front.robust import EXCESS
from quietarm.studies.display.words import counted, millimetres, print_lines
from quietarm.studies.reports.worst import point_in_words
from rich.console import Console


def print_sweep(
    console: Console, front: Front, asked_for: int, check: CrossCheck | None = None
) -> None:
    """Print a front: how it was found, its ends and knee, energies, what could not be found."""
    state = "" if front.complete else " (interrupted: what was found until then)"
    print_lines(
        console,
        f"{front.method}: {counted(len(front.points), 'point')}, "
        f"{counted(front.iterations, 'iteration')} of the solver "
        f"in {front.seconds:.1f} s{state}",
        *point_lines(front),
        *excess_lines(front),
        *check_lines(check),
        *failure_lines(front, asked_for),
        *gap_lines(front),
    )


def point_lines(front: Front) -> list[str]:
    """The ends, the knee, and the least energy within some residuals, one line for each."""
    chosen = {"stillest": front.stillest(), "knee": front.knee(), "cheapest": front.cheapest()}
    if len(front.points) < 3:
        del chosen["knee"]  # it would be an end
    lines = [f"  {name:15}{point_in_words(front, point)}" for name, point in chosen.items()]
    for level in LEVELS:
        energy, name = energy_at(front, level), f"within {millimetres(level)}"
        found = f"{energy:.4g} J" if energy == energy else "none"  # NaN where there is none
        lines.append(f"  {name:15}{found}")
    return lines


def excess_lines(front: Front) -> list[str]:
    """Of an uncertain plant, how well the residuals hold between its samples."""
    if not isinstance(front.task.plant, UncertainPlant):
        return []
    excess = front.settings.get(EXCESS)
    if not isinstance(excess, float):
        return ["residuals hold at the samples of the plant alone; between them more may be left"]
    errors = ", ".join(
        f"{name} within {100 * most:g} %" for name, most in front.task.plant.ranges.items()
    )
    more = f"at most {100 * excess:.2g} % more" if excess > 0 else "no more"
    return [
        f"residuals hold for any {errors}: between the samples CVODES finds {more} at any point"
    ]


def check_lines(check: CrossCheck | None) -> list[str]:
    """By how much the other solver's energies differ."""
    if check is None:
        return []
    count, names = len(check.points), {"sqp": "sequential quadratic programs", "ipopt": "IPOPT"}
    found = [point for point in check.points if point.other == point.other]  # not NaN
    lost = f"; {count - len(found)} it did not find" if len(found) < count else ""
    largest = max((abs(point.difference) for point in found), default=float("nan"))
    return [
        f"checked by {names[check.solver]}, {counted(count, 'point')} from the plain cycloid: "
        f"energies differ by at most {largest:.1g} of their size{lost}"
    ]


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


def gap_lines(front: Front) -> list[str]:
    """The ranges of the residual that no weight reaches, one line for each."""
    return [
        f"no weight reaches residuals from {millimetres(begin)} to {millimetres(end)}: the front "
        "is not convex there"
        for begin, end in front.gaps
    ]


def _asked(failure: FailedPoint) -> str:
    if RESIDUAL_LIMIT in failure.asked:
        return f"residual <= {millimetres(failure.asked[RESIDUAL_LIMIT])}"
    return ":".join(f"{weight:.3g}" for weight in failure.asked.values()) + " (residual:energy)"
