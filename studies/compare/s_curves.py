"""S-curves of a task: the fastest within its limits, and the one that is tuned to its modes.

An S-curve has a constant jerk in each of at most seven phases. What bends is left out, except that
a limit of torque or deflection counts as the acceleration that it allows where nothing swings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, permutations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from quietarm.ocp import PointToPoint
from quietarm.ocp.planning.rigid_motion import RigidBounds, assumed_bounds, rigid_motion
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.simulation.free_vibration import FreeVibration

Array = NDArray[np.float64]
CRUISE, RAMP, ROUNDING = range(3)
"""Pulses of a tuned S-curve: an S-curve's speed is three of them, convolved."""
_MULTIPLES = (1, 2, 3)
"""Periods that a pulse may be long."""


def bounds_of(task: PointToPoint) -> RigidBounds:
    """Return what the joint may do along its path; ValueError if nothing limits it."""
    bounds = assumed_bounds(task)
    if math.isinf(min(bounds.speeding_up, bounds.braking)) and math.isinf(bounds.rising):
        raise ValueError(
            "nothing limits the acceleration of the joint; plan the move with a limit, such as "
            "--acceleration-limit 40 --jerk-limit 2000"
        )
    return bounds


def gentler(bounds: RigidBounds, slowness: float) -> RigidBounds:
    """Return bounds with smaller accelerations: divided by the square of a factor of 1 or more."""
    return bounds._replace(
        speeding_up=bounds.speeding_up / slowness**2, braking=bounds.braking / slowness**2
    )


def slower(bounds: RigidBounds, slowness: float) -> RigidBounds:
    """Return the bounds of a motion that is stretched in time by a factor."""
    return RigidBounds(
        bounds.speed / slowness,
        bounds.speeding_up / slowness**2,
        bounds.braking / slowness**2,
        bounds.rising / slowness**3,
        bounds.falling / slowness**3,
    )


def s_curve(task: PointToPoint, bounds: RigidBounds) -> FreeMotion:
    """Return the fastest S-curve over a task's way within bounds."""
    free = rigid_motion(abs(task.span), bounds).free_motion
    way = math.copysign(1.0, task.span)
    return FreeMotion(free.times, way * free.acceleration, way * free.jerk)


def cycloid_duration(task: PointToPoint, bounds: RigidBounds) -> float:
    """Return how long the plain cycloid takes over a task's way within bounds [s]."""
    span = abs(task.span)
    acceleration = min(bounds.speeding_up, bounds.braking)
    jerk = min(bounds.rising, bounds.falling)
    return max(
        2 * span / bounds.speed,
        math.sqrt(2 * math.pi * span / acceleration),
        (4 * math.pi**2 * span / jerk) ** (1 / 3),
    )


def tuned_s_curve(
    task: PointToPoint, bounds: RigidBounds, duration: float | None = None
) -> FreeMotion:
    """Return the fastest S-curve within bounds of which one time is a whole number of periods.

    The spectrum of its acceleration is zero at the mode's frequency. With several modes each of the
    slowest has a time of its own, up to three of them. With a duration [s] it takes that long, with
    the smallest peak acceleration. ValueError if nothing vibrates, or nothing fits the bounds.
    """
    modes = FreeVibration(task.plant, task.target).modes
    if not modes:
        raise ValueError(
            f"plant {task.plant.name!r} does not vibrate, so that there is no period to tune to; "
            "take s-curve"
        )
    periods = [
        2 * math.pi / (frequency * math.sqrt(1 - damping**2)) for frequency, damping in modes
    ]
    count = 2 if math.isinf(min(bounds.rising, bounds.falling)) else 3
    least = _least_products(abs(task.span), bounds)[:count]
    choices = _fixed_boxes(periods[:count], count)
    found = (_best_boxes(least, fixed, duration) for fixed in choices)
    fitting = [boxes for boxes in found if boxes is not None]
    if not fitting:
        within = "" if duration is None else f" and {duration:.4g} s"
        remedy = "" if duration is None else "a longer duration or "
        raise ValueError(
            f"no S-curve within the limits{within} has a time of one, two or three periods; give "
            f"{remedy}wider limits"
        )
    if duration is None:
        return _of_boxes(task.span, min(fitting, key=sum))
    return _of_boxes(task.span, max(fitting, key=lambda boxes: boxes[CRUISE] * boxes[RAMP]))


def _fixed_boxes(periods: Sequence[float], count: int) -> Iterator[Mapping[int, float]]:
    """Every choice of pulses that are multiples of the periods, one of them for each period."""
    for places in permutations(range(count), len(periods)):
        for multiples in product(_MULTIPLES, repeat=len(periods)):
            yield {
                place: multiple * period
                for place, multiple, period in zip(places, multiples, periods)
            }


def _least_products(span: float, bounds: RigidBounds) -> list[float]:
    """Least cruise, cruise times ramp, and cruise times ramp times rounding, by the bounds."""
    return [
        span / bounds.speed,
        span / min(bounds.speeding_up, bounds.braking),
        span / min(bounds.rising, bounds.falling),
    ]


def _best_boxes(
    least: Sequence[float], fixed: Mapping[int, float], duration: float | None
) -> tuple[float, ...] | None:
    """Lengths of pulses, some of them fixed, of the least sum; None if none fit.

    With a duration they take that long, and the acceleration is the least. In the logarithms of the
    lengths both are convex programs: products are linear, and the sum of boxes, and their order, in
    which phases do not overlap, are sums of exponentials.
    """
    count = len(least)
    shortest = 1e-6  # [s]
    longest = 1e6
    low = np.full(count, math.log(shortest))
    high = np.full(count, math.log(longest))
    for place, length in fixed.items():
        low[place] = high[place] = math.log(length)
    needed = np.log(np.maximum(least, shortest**count))

    def products(logs: Array) -> Array:
        """At least 0 each: the cruise, times the ramp, times the rounding."""
        return np.cumsum(logs) - needed

    def crowded(logs: Array) -> Array:
        """At most 1 each: ramp and rounding in the cruise, the rounding in the ramp, the sum."""
        lengths = np.exp(logs)
        shares = [lengths[k + 1 :].sum() / lengths[k] for k in range(count - 1)]
        return np.array(shares if duration is None else [*shares, lengths.sum() / duration])

    def cost(logs: Array) -> float:
        if duration is None:
            return float(np.exp(logs).sum())
        return float(-logs[: RAMP + 1].sum())  # the logarithm of the acceleration

    def slope(logs: Array) -> Array:
        if duration is None:
            return np.exp(logs)
        return np.where(np.arange(count) <= RAMP, -1.0, 0.0)

    # long enough for all products, and in order
    scale = max(*(value ** (1 / (k + 1)) for k, value in enumerate(least)), *fixed.values())
    start = np.clip(np.log(scale * 2.0 ** np.arange(count, 0, -1)), low, high)
    solution: Any = minimize(
        cost, start, jac=slope, method="SLSQP", bounds=[*zip(low.tolist(), high.tolist())],
        constraints=[
            {"type": "ineq", "fun": products},
            {"type": "ineq", "fun": lambda logs: 1.0 - crowded(logs)},
        ],
        options={"ftol": 1e-10, "maxiter": 200},
    )  # fmt: skip
    lengths = np.exp(np.clip(solution.x, low, high))
    if duration is not None:
        free = max(set(range(count)) - set(fixed), key=lengths.__getitem__, default=CRUISE)
        lengths[free] += duration - lengths.sum()
        if lengths.min() <= 0:
            return None
    tolerance = 1e-6
    kept = np.cumprod(lengths) >= np.array(least) * (1 - tolerance)
    tuned = all(abs(lengths[k] / length - 1) < tolerance for k, length in fixed.items())
    if not (kept.all() and tuned) or (crowded(np.log(lengths)) > 1 + tolerance).any():
        return None
    return tuple(lengths.tolist())


def _of_boxes(span: float, boxes: Sequence[float]) -> FreeMotion:
    """The motion whose speed is pulses, convolved, over a way."""
    jumps = dict[float, float]()
    for chosen in (some for k in range(len(boxes) + 1) for some in combinations(boxes, k)):
        sign = -1.0 if len(chosen) % 2 else 1.0
        jumps[sum(chosen)] = jumps.get(sum(chosen), 0.0) + sign
    shortest = 1e-9  # [s]: jumps that are nearer to each other are one
    times = list[float]()
    sizes = list[float]()
    for time in sorted(jumps):
        if times and time - times[-1] < shortest:
            sizes[-1] += jumps[time]
        else:
            times.append(time)
            sizes.append(jumps[time])
    steps = span / math.prod(boxes) * np.cumsum(sizes)[:-1]
    at = np.array(times)
    if len(boxes) == 2:
        return FreeMotion(at, steps, np.zeros_like(steps))
    accelerations = np.append(0.0, np.cumsum(steps * np.diff(at)))[:-1]
    return FreeMotion(at, accelerations, steps)
