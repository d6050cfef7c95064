"""Fronts in lines: how each was found, its ends and knee, what is missing, the spread of seeds."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

from quietarm.metaheuristics.evaluation.noise import belief_of
from quietarm.metaheuristics.spread import SEARCH_RESIDUAL, energies_at, hypervolumes
from quietarm.ocp import CrossCheck, FailedPoint, Front, FrontPoint, Gain, PointToPoint
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.front.tradeoff import RESIDUAL_LIMIT
from quietarm.ocp.joint_words import further_words
from quietarm.ocp.limits import FRONT, QUANTITIES
from quietarm.ocp.objectives import Objective, objectives_on
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.rest import still_of
from quietarm.ocp.robustness import worst_of, worst_of_rows
from quietarm.views.report.captions import caption_of_front, caption_of_fronts
from quietarm.views.report.plan_rows import worst_in_words
from quietarm.views.report.words import (
    corner_words,
    counted,
    energy_words,
    residual_place,
    residual_words,
    scenarios_words,
    spread_words,
)
from quietarm.views.tips import tip_words


def gradient_lines(front: Front, asked_for: int, check: CrossCheck | None = None) -> list[str]:
    """A front by the gradient, of which so many points were asked for."""
    record = front.record
    tip_unit = front.task.plant.tip_unit
    return [
        f"{caption_of_front(front)}.",
        *energy_words(front.task),
        *_chosen_points(front),
        *(
            f"  {f'within {tip_words(level, tip_unit)}':14} {_within(front, level)}"
            for level in LEVELS
        ),
        _residual_line(front.task),
        *_range_lines(front),
        *([] if check is None else [_check_line(check)]),
        *_grid_lines(front),
        *failure_lines(front, asked_for),
        *(
            f"no weight reaches residuals from {residual_words(begin, front.task)} to "
            f"{tip_words(end, tip_unit)}: the front is not convex there"
            for begin, end in front.gaps
        ),
        f"{record.method}: {counted(len(front.points), 'point')}, "
        f"{counted(record.iterations, 'iteration')} of the solver in {record.seconds:.1f} s",
    ]  # fmt: skip


def _within(front: Front, level: float) -> str:
    """Return the least energy within a residual in words, and further figures of that motion."""
    point = front.cheapest_within(level)
    if point is None:
        return "none"
    return ", ".join([f"{point.energy:.4g} J", *further_words(front.judged(point), FRONT)])


def search_lines(fronts: Sequence[Front], notes: Sequence[str] = ()) -> list[str]:
    """Fronts of searches or tables, and the spread over several seeds."""
    task = fronts[0].task
    lines = [f"{caption_of_fronts(fronts)}.", *energy_words(task)]
    if len(fronts) > 1:
        energies = energies_at(fronts)
        level = tip_words(SEARCH_RESIDUAL, task.plant.tip_unit)
        lines += [
            f"energy within {level}: {spread_words(energies, '.4g', ' J')}, median (quartiles)",
            f"hypervolume: {spread_words(hypervolumes(fronts), '.4f')} of the area up to "
            f"{corner_words(fronts[0])}, median (quartiles)",
        ]
    for front in fronts:
        points = [*_chosen_points(front), *_noise_lines(front)]
        how = [_found_line(front)]
        lines += points + how if len(fronts) == 1 else how + points
    ranges = [line for front in fronts for line in _range_lines(front)]
    return [*lines, _residual_line(task), *ranges, *notes]


def _found_line(front: Front) -> str:
    """Return how a search found a front: method, seed, candidates and time."""
    record = front.record
    seed = "" if record.seed is None else f", seed {record.seed}"
    failed = f", {front.failed} failed" if front.failed else ""
    return (
        f"{record.method}{seed}: {counted(len(front.points), 'point')}, "
        f"{counted(record.evaluations, 'candidate')} in {record.seconds:.1f} s{failed}"
    )


def polish_lines(given: Front, polished: Front, gains: Sequence[Gain]) -> list[str]:
    """Say what the points of a front gained by the gradient."""
    # points that the list of gains shows
    rows = 10
    shares = np.array([gain.share for gain in gains])
    tip_unit = given.task.plant.tip_unit
    dominated = len(given.points) - len(polished.points)
    shown = np.linspace(0, len(gains) - 1, min(rows, len(gains))).round().astype(int)
    return [
        f"Polishing saves {shares.max():.2%} of the energy of a point at most, "
        f"{np.median(shares):.2%} in the median.",
        f"{'residual':>12}{'before':>12}{'after':>12}{'saved':>9}",
        *(
            f"{tip_words(gain.residual, tip_unit):>12}{f'{gain.before:.4g} J':>12}"
            f"{f'{gain.after:.4g} J':>12}{f'{gain.share:.2%}':>9}"
            for gain in (gains[i] for i in shown)
        ),
        *_chosen_points(polished),
        _residual_line(polished.task),
        *_range_lines(polished),
        *([f"{counted(dominated, 'point')} dropped, dominated by another now"] * (dominated > 0)),
        *failure_lines(polished, len(given.points)),
        f"{polished.record.method}: {counted(len(given.points), 'point')}, "
        f"{polished.record.iterations - given.record.iterations} iterations of the solver in "
        f"{polished.record.seconds - given.record.seconds:.1f} s",
    ]  # fmt: skip


def failure_lines(front: Front, asked_for: int) -> list[str]:
    """Say how many of the points asked for failed, and why; nothing if none did."""
    if not front.failures:
        return []
    reasons = dict[str, list[str]]()
    tip_unit = front.task.plant.tip_unit
    for failure in front.failures:
        reasons.setdefault(failure.reason, []).append(_asked(failure, tip_unit))
    return [
        f"{len(front.failures)} of {asked_for} points could not be found:",
        *(f"  {', '.join(points)}: {reason}" for reason, points in reasons.items()),
    ]


def _residual_line(task: PointToPoint) -> str:
    """Say where and when the residuals of fronts are measured."""
    return f"residuals are {residual_place(task)}"


def _range_lines(front: Front) -> list[str]:
    """Say what points leave within the range of errors, beyond its ends; nothing without one."""
    task = front.task
    if not task.ranges or not front.points:
        return []
    worst = worst_of_rows(task, front.profile, [point.coefficients for point in front.points])
    residuals = np.array([point.residual for point in front.points])
    more = worst - residuals
    leave_more = (more > OVERRUN * residuals) & (more > still_of(task))
    farthest = int(more.argmax())
    errors = len(task.scenarios) - 1
    words = f"the points keep their residuals in the scenarios alone, {errors} errors of the range"
    if not leave_more.any():
        return [f"{words}; within it none leaves more"]
    unit = task.plant.tip_unit
    words += (
        f"; within it {leave_more.sum()} of {len(worst)} leave more, at most "
        f"{tip_words(worst[farthest], unit)} where the front has "
        f"{residual_words(residuals[farthest], task)}"
    )
    limit = task.band_limit
    if limit is not None:
        words += (
            f", and {(worst <= (1 + OVERRUN) * limit).sum()} leave no more than "
            f"{tip_words(limit, unit)}, the band over its margin; quietarm front --objectives "
            "time,energy, or quietarm plan --band, keeps the band in all of it"
        )
    return [words]


def _chosen_points(front: Front) -> list[str]:
    """The ends and the knee, a line each."""
    if not front.points:
        return []
    chosen = {"least residual": front.smallest_residual(), "knee": front.knee(),
              "least energy": front.cheapest()}  # fmt: skip
    for objective in _peaks_of(front):
        quantity = objective.quantity
        least = min(front.points, key=lambda point, name=quantity: point.peaks[name])
        chosen[f"least {QUANTITIES[quantity].words.of(front.task.plant.joint)}"] = least
    if not front.has_knee:
        del chosen["knee"]
    width = max(15, *(len(name) + 1 for name in chosen))
    lines = [f"  {name:{width}}{_point_in_words(front, point)}" for name, point in chosen.items()]
    if not front.has_knee and len(front.points) > 2:
        lines.insert(1, f"  {'knee':{width}}none between the ends")
    return lines


def _peaks_of(front: Front) -> list[Objective]:
    """The peaks that are objectives of a front."""
    objectives = objectives_on(front.task.plant, front.objectives)
    return [objective for objective in objectives if objective.quantity]


def _grid_lines(front: Front) -> list[str]:
    """Say what became of the cells of a grid of limits; nothing if there was none."""
    settings = front.record.settings
    if "grid" not in settings:
        return []
    return [
        f"grid of {settings['grid']} limits on the residual and the peaks: "
        f"{settings['infeasible_cells']} cells have no motion, and {settings['cells_left_out']} "
        "were not solved, as their neighbours tell"
    ]


def _noise_lines(front: Front) -> list[str]:
    """Say what the search believed, and what is true; nothing without noise."""
    noise = front.record.settings.get("noise")
    if not isinstance(noise, float):
        return []
    times = front.record.settings["reevaluate"]
    again = f", {times} evaluations of what is kept" if times != 1 else ""
    belief = belief_of(front)
    if belief is None:
        return [f"noise {noise:.3g} of residual and energy{again}"]
    return [
        f"noise {noise:.3g} of residual and energy{again}: at {counted(belief.points, 'point')} "
        f"that it took for the best it believed energies {belief.energy:+.2%} and residuals "
        f"{belief.residual:+.2%} of their size (medians); {belief.dominated} are dominated in truth"
    ]


def _point_in_words(front: Front, point: FrontPoint) -> str:
    """Energy and residual; of an uncertain plant also the worst case."""
    tip_unit = front.task.plant.tip_unit
    motion = front.judged(point)
    worst = worst_of(motion)
    words = f"{point.energy:.4g} J at {scenarios_words(point.residual, worst, front.task)}"
    words += "".join(
        f", {QUANTITIES[objective.quantity].words.of(front.task.plant.joint)} "
        f"{tip_words(point.peaks[objective.quantity], objective.unit)}"
        for objective in _peaks_of(front)
    )
    words += "".join(f", {text}" for text in further_words(motion, FRONT))
    return words if worst is None else f"{words}; worst case {worst_in_words(worst, tip_unit)}"


def _check_line(check: CrossCheck) -> str:
    """Say by how much the other solver's energies differ."""
    shares = [point.difference for point in check.points if isfinite(point.other)]
    missing = len(check.points) - len(shares)
    shares = shares or [float("nan")]
    solver = {"sqp": "sequential quadratic programs", "ipopt": "IPOPT"}[check.solver.name]
    return (
        f"checked by {solver}, {counted(len(check.points), 'point')} from the plain cycloid: its "
        f"energies differ by {min(shares):+.1g} to {max(shares):+.1g} of their size"
        + f"; it found no motion for {missing}"
        * (missing > 0)
    )


def _asked(failure: FailedPoint, tip_unit: str) -> str:
    if RESIDUAL_LIMIT in failure.asked:
        peaks = "".join(
            f" and {name.removesuffix('_limit')} <= {size:.3g}"
            for name, size in failure.asked.items()
            if name != RESIDUAL_LIMIT
        )
        return f"residual <= {tip_words(failure.asked[RESIDUAL_LIMIT], tip_unit)}{peaks}"
    return ":".join(f"{weight:.3g}" for weight in failure.asked.values()) + " (residual:energy)"
