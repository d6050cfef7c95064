"""The time when a tool may act: until its tip stays within a band about the target.

The time is counted from the command's start. The target is where the tip rests after arrival, its
static sag included. During the move the tip's deviation is what the joint has still to go, and the
tip's displacement; after arrival it is the free vibration, in closed form. The time may be before
the motion's end, or after it; it is infinite where the tip never stays within the band.

`time_to_act` is of one motion on one plant, `worst_time_to_act` of all errors within ranges,
`time_to_act_by_samples` of any table of times and deviations, such as a simulation of a drive.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.checks import numbers, positive, takes
from quietarm.ocp.simulation.free_vibration import FreeVibration, vibration_of
from quietarm.ocp.simulation.mesh import ROLLOUT_STEPS, default_steps
from quietarm.ocp.uncertainty import perturb_plant

if TYPE_CHECKING:
    from quietarm.ocp.judged_motion import JudgedMotion

Array = NDArray[np.float64]
Distance = Callable[[Array], Array]
"""The distance of the tip from its target [m] at times [s]."""
_NEAR = 5e-3
"""A sample at a peak that is below the band by a smaller share is looked at more closely: between
samples of 0.1 rad of the fastest mode a peak is higher by 1.3e-3 at most."""
_RADIANS = 0.05
"""Phase of the fastest mode between samples of a vibration."""
_AT_ONCE = 400
"""Samples of a vibration that are looked at together, from its end backwards."""
_ALONG = {1: 41, 2: 9, 3: 5, 4: 3}
"""Errors along each side of a grid by the number of ranges."""
_ON_THE_WAY = {1: 9, 2: 3, 3: 3, 4: 2}
"""The same where the whole motion is integrated for each."""
_CLOSER = 2
"""Rounds in which the grid around the worst case is halved."""


@dataclass(frozen=True)
class Acting:
    """The time when a tool may act in the worst case.

    Attributes
    ----------
    after : float
        Time from the command's start until the tip stays within the band [s].
    errors : mapping of str to float
        The relative errors of the plant for which it is latest.
    """

    after: float
    errors: Mapping[str, float] = field(hash=False)


class ActingMotion:
    """A motion of a task that CVODES has judged, as it is asked when its tool may act."""

    example: ClassVar[str] = (
        "a motion, such as plan.candidate or JudgedMotion.of_profile(task, profile, a)"
    )

    @cached_property
    def acting(self) -> Acting | None:
        """Time when the tip stays within the task's band in the worst case; None without a band."""
        motion: Any = self
        if motion.task.band is None:
            return None
        return worst_time_to_act(motion, motion.task.band, motion.task.ranges)

    @property
    def acts_after(self) -> float:
        """Time from the motion's start until the tip stays within the task's band [s].

        In the worst case of an uncertain task; infinite where it never does, and no number where
        the task has no band.
        """
        return math.nan if self.acting is None else self.acting.after


@takes(motion=ActingMotion)
def time_to_act(motion: JudgedMotion, band: float) -> float:
    """Return the time until the tip stays within a band about its target [s], on a motion's plant.

    Parameters
    ----------
    motion : JudgedMotion
        The motion, along a profile or a free one such as a rival's set points; `perturbed` gives it
        on a plant with errors. Of an uncertain task the nominal plant counts.
    band : float
        Largest distance of each tip from where it rests after arrival [m]. A tip that moves in a
        plane or in space is within a circle or a ball.

    Returns
    -------
    float
        Seconds from the motion's start; infinite where the tip never stays within the band. The
        motion of a plant that does not say where its tip goes with the joint
        (`Plant.tip_deviations`) acts at the end of the motion at the earliest.
    """
    positive("band", band, "m")
    duration = motion.task.duration
    later = act_after_arrival(motion.vibration, motion.arrival[0], band)
    if later > 0:
        return duration + later
    deviations = _on_the_way(motion)
    if deviations is None:
        return duration
    times, rows = deviations
    return min(_by_samples(times, rows, band, motion.vibration.is_in_space), duration)


@on_one_thread
def act_after_arrival(vibration: FreeVibration, state: ArrayLike, band: float) -> float:
    """Return how long after arrival a tip is last beyond the band [s], by the free vibration.

    Parameters
    ----------
    vibration : FreeVibration
        Of the plant, with the joint at the target.
    state : array_like, shape (2 * modes,)
        W [m], then W' [m/s] on arrival.
    band : float
        [m].

    Returns
    -------
    float
        0 where the tip is within the band from arrival on; infinite where it never stays there, as
        without damping.
    """
    rates, shares = _modes_of(vibration, np.asarray(state, dtype=float))
    sizes = np.abs(shares)
    if vibration.is_in_space:
        sizes = np.linalg.norm(sizes, axis=0, keepdims=True)
    lasting = rates.real > -1e-12 * np.abs(rates)
    if np.any(sizes[:, lasting].sum(axis=1) > band):
        return math.inf

    def envelope(time: float) -> float:
        return float((sizes @ np.exp(rates.real * time)).max())

    def distance(times: Array) -> Array:
        swings = (shares @ np.exp(np.multiply.outer(rates, times))).real
        return _distances(swings, vibration.is_in_space)

    if envelope(0.0) <= band:
        return 0.0
    step = _RADIANS / float(vibration.fastest)
    end = step
    while envelope(end) > band:
        end *= 2
        if not math.isfinite(end):
            return math.inf
    end = _root(lambda time: envelope(time) - band, 0.0, end) + step
    while end > 0:
        begin = max(0.0, end - _AT_ONCE * step)
        overlap = min(begin, 2 * step)
        count = math.ceil((end - begin + overlap) / step) + 1
        last = _last_beyond(distance, np.linspace(begin - overlap, end, count), band)
        if last is not None:
            return last
        end = begin
    return 0.0


def _modes_of(vibration: FreeVibration, state: Array) -> tuple[Array, Array]:
    """Eigenvalues of a vibration, and what each adds to the displacement of every tip.

    Displacements are the real parts of shares times exp(eigenvalue * time).
    """
    matrix = vibration.matrix
    rates, vectors = np.linalg.eig(matrix)
    if np.linalg.cond(vectors) > 1e10:  # as of a mode that is damped critically
        nearly = 1 + 1e-10 * np.arange(1, len(matrix) + 1)
        rates, vectors = np.linalg.eig(matrix * nearly[:, None])
    of_modes = np.linalg.solve(vectors, state.astype(complex))
    return rates.astype(complex), (vibration.displacements @ vectors) * of_modes


@takes()
def time_to_act_by_samples(
    times: ArrayLike, deviations: ArrayLike, band: float, in_space: bool = False
) -> float:
    """Return the time until sampled deviations stay within a band [s].

    Parameters
    ----------
    times : array_like, shape (samples,)
        Times from the command's start [s], which do not decrease; where two are the same the
        deviation may bend.
    deviations : array_like, shape (samples,) or (tips, samples)
        Deviation of each tip from its target [m], or of one tip along axes of space. Between
        samples it is a cubic spline.
    band : float
        [m].
    in_space : bool
        Whether the rows are one tip's along perpendicular axes, so that its distance counts.

    Returns
    -------
    float
        Infinite where the last sample is beyond the band: take samples until the tip has settled.

    Raises
    ------
    ValueError
        When times decrease, or the shapes do not fit.
    """
    positive("band", band, "m")
    at = numbers("times", times, "numbers in s")
    rows = np.atleast_2d(numbers("deviations", deviations, "numbers in m"))
    if at.ndim != 1 or rows.ndim != 2 or rows.shape[1] != len(at) or not len(at):
        raise ValueError(
            f"times have shape {at.shape} and deviations {rows.shape}; give (samples,) and "
            "(samples,) or (tips, samples)"
        )
    if np.any(np.diff(at) < 0):
        raise ValueError("the times decrease; give the samples in the order of time")
    return _by_samples(at, rows, band, in_space)


def _by_samples(times: Array, rows: Array, band: float, in_space: bool) -> float:
    """The last time beyond a band, piece by piece from the end; 0 where there is none."""
    if _distances(rows[:, -1:], in_space)[0] > band:
        return math.inf
    ends = [*(np.flatnonzero(np.diff(times) <= 0) + 1).tolist(), len(times)]
    for begin, end in reversed([*zip([0, *ends[:-1]], ends)]):
        if end - begin < 2:
            if _distances(rows[:, begin:end], in_space)[0] > band:
                return float(times[begin])
            continue
        last = _last_beyond(
            _splined(times[begin:end], rows[:, begin:end], in_space), times[begin:end], band
        )
        if last is not None:
            return last
    return 0.0


def _splined(times: Array, rows: Array, in_space: bool) -> Distance:
    from scipy.interpolate import CubicSpline  # takes a quarter of a second to load

    spline = CubicSpline(times, rows, axis=1)
    return lambda at: _distances(spline(at), in_space)


def _distances(rows: Array, in_space: bool) -> Array:
    """Return the tips' distances from their targets: the farthest of several, one in space."""
    return np.linalg.norm(rows, axis=0) if in_space else np.abs(rows).max(axis=0)


def _last_beyond(distance: Distance, times: Array, band: float) -> float | None:
    """The last time at which a distance is beyond the band, between these times as well."""
    sizes = distance(times)

    def beyond(time: float) -> float:
        return float(distance(np.array([time]))[0]) - band

    above = np.flatnonzero(sizes > band)
    last = int(above[-1]) if above.size else -1
    inner = np.arange(max(last + 1, 1), len(times) - 1)
    is_peak = (sizes[inner] >= sizes[inner - 1]) & (sizes[inner] >= sizes[inner + 1])
    for place in reversed(inner[is_peak & (sizes[inner] > (1 - _NEAR) * band)].tolist()):
        before, after = float(times[place - 1]), float(times[place + 1])
        top = _peak(beyond, before, after)
        if beyond(top) > 0:
            return _root(beyond, top, after)
    if last < 0:
        return None
    if last + 1 == len(times):
        return float(times[-1])
    return _root(beyond, float(times[last]), float(times[last + 1]))


def _root(function: Callable[[float], float], begin: float, end: float) -> float:
    """Return where a function changes its sign between two times."""
    from scipy.optimize import brentq  # takes a quarter of a second to load

    found: Any = brentq(function, begin, end)
    return float(found)


def _peak(function: Callable[[float], float], begin: float, end: float) -> float:
    """Return where a function is largest between two times, of which it has one peak."""
    from scipy.optimize import minimize_scalar

    found: Any = minimize_scalar(
        lambda time: -function(time),
        bounds=(begin, end),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return float(found.x)


def _on_the_way(motion: JudgedMotion) -> tuple[Array, Array] | None:
    """Times of the move and the tips' deviations there; None where the plant does not say."""
    sample = motion.moving
    tips = np.array(np.broadcast_arrays(*sample.tips, sample.path.angle)[:-1])
    rows = motion.plant.tip_deviations(np.asarray(sample.path.angle), tips, motion.task.target)
    return None if rows is None else (motion.times, rows)


@takes(motion=ActingMotion)
def worst_time_to_act(motion: JudgedMotion, band: float, ranges: Mapping[str, float]) -> Acting:
    """Return the latest time to act within ranges of errors, with the errors for which it is.

    States on arrival are those of fixed steps on a grid of errors, from which the vibration follows
    in closed form; CVODES gives the time of the worst. Where the tip is within the band from
    arrival on for all errors, CVODES follows the move on a coarser grid, since what counts is then
    on the way.

    Parameters
    ----------
    motion : JudgedMotion
        The motion. One without a profile is integrated by CVODES at every error.
    band : float
        [m].
    ranges : mapping of str to float
        Largest relative errors by name, as of `Uncertainty`; none for the nominal plant alone.
    """
    certain = motion.on(motion.task.certain)
    if not ranges:
        return Acting(time_to_act(certain, band), {})
    largest = np.array(list(ranges.values()))

    def act(shares: Array) -> float:
        errors = dict(zip(ranges, (shares * largest).tolist()))
        return time_to_act(certain.perturbed(errors), band)

    along = _ALONG[len(ranges)] if motion.profile is not None else 0
    around = None
    if along:
        grid = _grid(along, len(ranges))
        later = _after_arrival(certain, band, ranges, grid * largest)
        if later.max() > 0:
            around = grid[int(later.argmax())]
    if around is None:
        along = _ON_THE_WAY[len(ranges)]
        known = {tuple(shares): act(shares) for shares in _with_nominal(_grid(along, len(ranges)))}
    else:
        known = {tuple(around): act(around)}
    for _ in range(_CLOSER):
        along = 2 * along - 1
        middle = np.array(max(known, key=lambda shares: known[shares]))
        for shares in np.clip(middle + _beside(len(ranges)) * 2 / (along - 1), -1, 1):
            if tuple(shares) not in known:
                known[tuple(shares)] = act(shares)
    worst = max(known, key=lambda shares: known[shares])
    return Acting(known[worst], dict(zip(ranges, (np.array(worst) * largest).tolist())))


def _after_arrival(
    motion: JudgedMotion, band: float, ranges: Mapping[str, float], errors: Array
) -> Array:
    """Return how long after arrival the tip is last beyond the band, for each row of errors."""
    faster = 1 + max(ranges.values())  # any of them may be a frequency
    steps = max(ROLLOUT_STEPS, math.ceil(faster * default_steps(motion.task, least=1)))
    evaluator = motion.by_steps(steps, quantities=[], error_names=tuple(ranges))
    arrivals = evaluator([motion.coefficients], errors).arrival[0]
    return np.array([
        act_after_arrival(_vibration_with(motion, dict(zip(ranges, row))), state, band)
        for row, state in zip(errors.tolist(), arrivals)
    ])  # fmt: skip


def _vibration_with(motion: JudgedMotion, errors: Mapping[str, float]) -> FreeVibration:
    task = motion.task
    return vibration_of(perturb_plant(task.plant, errors), task.target, task.residual_window)


def _grid(along: int, ranges: int) -> Array:
    sides = [np.linspace(-1.0, 1.0, along)] * ranges
    return np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, ranges)


def _with_nominal(grid: Array) -> Array:
    nominal = np.zeros((1, grid.shape[1]))
    return grid if np.any(np.all(grid == 0, axis=1)) else np.vstack([nominal, grid])


def _beside(ranges: int) -> Array:
    """Steps to the neighbours of a place of a grid."""
    return np.array([step for step in product((-1.0, 0.0, 1.0), repeat=ranges) if any(step)])
