"""Hold what the points of a front leave between the samples of an uncertain plant as well."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.front.answer import Front
from quietarm.ocp.front.checking import RESIDUAL_LIMIT, checked
from quietarm.ocp.front.points import FailedPoint, FrontPoint, non_dominated
from quietarm.ocp.front.sweep import Sweep
from quietarm.ocp.record import REST
from quietarm.ocp.robustness.worst import peaks_between

_SOLVED, _STATED = 0.02, 1e-3
"""Shares by which it may do so before points are solved again, and before their residual is."""
_ROUNDS, _ADDED, _PEAKS = 4, 3, 4
"""Most times that points are solved again, most samples that each adds, peaks of a point."""
_APART = 0.1
"""Peaks of several points closer than this share of the ranges share a sample."""

Found = FrontPoint | FailedPoint


@dataclass(frozen=True)
class _Point:
    """A point with the peaks of its residual between the samples."""

    point: FrontPoint
    peaks: NDArray[np.float64]

    @property
    def excess(self) -> NDArray[np.float64]:
        """Share by which each peak passes the point's residual."""
        return (self.peaks[:, 0] - self.point.residual - REST) / max(self.point.residual, REST)


def held_between(sweep: Sweep, found: Sequence[Found]) -> tuple[list[Found], float | None, bool]:
    """Points of a sweep whose residual holds between the samples of its uncertain plant as well.

    Where CVODES between the samples finds much more than a point's residual, the peaks become
    samples, which all points share, and the points that pass their residual there are solved again,
    each from where it is. A point that was not found is tried again from its neighbours. In the end
    peaks become samples until every point's residual is what it leaves at worst.
    """
    if sweep.task.uncertainty is None:
        return list(found), None, True
    kept, task = list(found), sweep.task
    try:
        for _ in range(_ROUNDS):
            more = _samples(sweep, kept)
            if not more and not _failed(kept):
                break
            sweep.add_samples(more)
            again = _solved_again(sweep, kept)
            if not more and _failed(again) == _failed(kept):
                break
            kept, task = again, sweep.task
        return *_at_worst(sweep, kept), True
    except KeyboardInterrupt:
        sweep.take(task)  # without the samples that no points have
        return kept, None, False


def _failed(found: Sequence[Found]) -> int:
    return sum(isinstance(one, FailedPoint) for one in found)


def _looked_at(sweep: Sweep, point: FrontPoint) -> _Point:
    where = sweep.task, sweep.profile, point.coefficients
    return _Point(point, peaks_between(*where, _PEAKS)[1])


def _samples(sweep: Sweep, found: Sequence[Found]) -> list[list[float]]:
    """The errors of the peaks that pass their point's residual too far, the farthest first."""
    points = [_looked_at(sweep, one) for one in found if isinstance(one, FrontPoint)]
    passing = [
        (excess, peak[1:])
        for one in points
        for excess, peak in zip(one.excess, one.peaks, strict=True)
        if excess > _SOLVED
    ]
    near = _APART * np.array(list(sweep.task.ranges.values()))
    chosen = list[NDArray[np.float64]]()
    for _, errors in sorted(passing, key=lambda one: -one[0]):
        if len(chosen) < _ADDED and all((abs(errors - one) > near).any() for one in chosen):
            chosen.append(errors)
    return [errors.tolist() for errors in chosen]


def _solved_again(sweep: Sweep, found: Sequence[Found]) -> list[Found]:
    """The points at their residuals with the samples that there are now, the cheapest first."""
    points = [one for one in found if isinstance(one, FrontPoint)]
    cheapest = min(points, key=lambda one: one.energy, default=None)  # the assumed plant's
    order = sorted((one for one in found if one is not cheapest), key=_target, reverse=True)
    for way in (order, order[::-1]):  # what fails from one neighbour is tried from the other
        beside = cheapest if way is order else None
        for i, one in enumerate(way):
            way[i] = one = _held_at(sweep, one, beside)
            beside = one if isinstance(one, FrontPoint) else beside
        order[:] = sorted(way, key=_target, reverse=True)
    if cheapest is None:
        return order
    return [replace(cheapest, residual=_residual(sweep, cheapest)), *order]


def _held_at(sweep: Sweep, one: Found, beside: FrontPoint | None) -> Found:
    """A point that keeps its residual at all samples, from itself or else from one beside it."""
    guesses = [guess for guess in (one, beside) if isinstance(guess, FrontPoint)]
    if isinstance(one, FrontPoint):
        residual = _residual(sweep, one)
        if residual <= one.residual * (1 + _STATED) + REST:
            return replace(one, residual=residual)
    elif RESIDUAL_LIMIT not in one.asked:
        return one
    target, reason = _target(one), getattr(one, "reason", "")
    asked = {RESIDUAL_LIMIT: target}
    for guess in guesses:
        solved = sweep.best([np.array(guess.coefficients)], sweep.ask(target))
        if solved.status.solved:
            point = checked(sweep, solved, asked, target * (1 + _SOLVED))
            if isinstance(point, FrontPoint):
                return point
            reason = point.reason
        else:
            reason = reason or solved.status.text
    return FailedPoint(asked, reason)


def _target(one: Found) -> float:
    """The residual that a point is to keep [m]."""
    return one.residual if isinstance(one, FrontPoint) else one.asked.get(RESIDUAL_LIMIT, 0.0)


def _residual(sweep: Sweep, point: FrontPoint) -> float:
    """The largest at the samples [m]."""
    return Candidate.of_profile(sweep.task, sweep.profile, point.coefficients).residual


def _left(sweep: Sweep, point: FrontPoint, errors: Sequence[float]) -> float:
    candidate = Candidate.of_profile(sweep.task, sweep.profile, point.coefficients)
    return candidate.perturbed(dict(zip(sweep.task.error_names, errors, strict=True))).residual


def _at_worst(sweep: Sweep, found: Sequence[Found]) -> tuple[list[Found], float]:
    """The points with the residual that they leave at worst, where a peak is far above a sample."""
    points = [one for one in found if isinstance(one, FrontPoint)]
    others = [one for one in found if isinstance(one, FailedPoint)]
    looked = [_looked_at(sweep, replace(p, residual=_residual(sweep, p))) for p in points]
    while looked:
        farthest = max(looked, key=lambda one: one.excess.max())
        excess = float(farthest.excess.max())
        if excess <= _STATED:
            return [*(one.point for one in looked), *others], max(excess, 0.0)
        errors = farthest.peaks[np.argmax(farthest.excess), 1:].tolist()
        sweep.add_samples([errors])
        looked = [replace(one, point=_with_sample(sweep, one.point, errors)) for one in looked]
    return [*others], 0.0


def _with_sample(sweep: Sweep, point: FrontPoint, errors: Sequence[float]) -> FrontPoint:
    return replace(point, residual=max(point.residual, _left(sweep, point, errors)))


def on_same_samples(fronts: Sequence[Front]) -> list[Front]:
    """Fronts of one uncertain plant with their residuals at the samples of all of them."""
    plants = [(front.task.plant, *front.task.ranges.items()) for front in fronts]
    samples: dict[Hashable, dict[tuple[float, ...], None]] = {}
    for plant, front in zip(plants, fronts, strict=True):
        samples.setdefault(plant, {}).update(dict.fromkeys(front.task.scenarios[1:]))
    return [
        _at_samples(front, [*samples[plant]]) for plant, front in zip(plants, fronts, strict=True)
    ]


def _at_samples(front: Front, samples: Sequence[tuple[float, ...]]) -> Front:
    if front.task.uncertainty is None or not front.points:
        return front
    task = front.task.with_samples(samples)
    new = [one for one in samples if one not in front.task.scenarios]
    errors = [dict(zip(task.error_names, one, strict=True)) for one in new]
    judged = [Candidate.of_profile(task, front.profile, p.coefficients) for p in front.points]
    left = [
        max([point.residual, *(candidate.perturbed(one).residual for one in errors)])
        for point, candidate in zip(front.points, judged, strict=True)
    ]
    points = (replace(p, residual=most) for p, most in zip(front.points, left, strict=True))
    return replace(front, task=task, points=non_dominated(points))
