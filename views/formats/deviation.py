"""Distance from the plan of a controller that interpolates set points: sampled, and proven.

Between two set points the distance from the plan is cut into short parts. At the ends of a part it
is computed; within, it is at most an eighth of the part's length squared, times the second
derivative's largest size, farther. That size follows from enclosures of the plan's acceleration
over the part (interval arithmetic) and the interpolation's own. The speed of a plan is continuous,
its acceleration need not be.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.models.dimensions import WAY
from quietarm.ocp import Plan
from quietarm.views.formats.enclosure import Interval, NoEnclosureError, enclose
from quietarm.views.formats.exact_path import path_function

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Array = NDArray[np.float64]
LINEAR = 0
SPLINE, CUBIC, QUINTIC = 1, 2, 3
"""Interpolations; but for the first, how many of position, speed and acceleration are given."""
_FEWEST_PARTS = 4
"""Of an interval between two set points."""
_USUAL_PARTS = 2_000
_MOST_PARTS = 160_000
_MARGIN = 0.1
"""Of the sampled deviation: parts are cut again while what may lie between them is more."""
_NOTHING = 1e-9
"""Of the largest position: what nobody asks for more closely."""
_ROUNDING = 1e-14
"""Of the largest position: what double precision may take from a computed distance."""
MOST_POINTS = 20_000
"""Of so many set points and more no deviation is computed."""


class Deviation(NamedTuple):
    """The largest distance of every joint from the plan: sampled, and a bound that is proven.

    The bound is infinite if no enclosure of the path is known.
    """

    sampled: Array
    proven: Array


def motion_at(plan: Plan, times: Array) -> list[Array]:
    """Positions, speeds and accelerations of all joints, each of shape (times, joints).

    After arrival the joints rest.
    """
    task = plan.task
    fractions = _fractions(plan, times)
    function = path_function(plan.profile, task.plant)
    calls = function.map(len(times))
    rows = np.asarray(
        calls(
            fractions[None, :],
            np.tile(np.reshape(plan.coefficients, (-1, 1)), len(times)),
            np.tile(np.reshape(task.move, (-1, 1)), len(times)),
        )
    )
    joints = len(rows) // 3
    moving = fractions < 1
    return [
        rows[order * joints : (order + 1) * joints].T * (moving[:, None] if order else 1.0)
        for order in range(3)
    ]


def pieces_through(times: Array, given: Sequence[Array], interpolation: int) -> PPoly:
    """Return the interpolation of set points: of positions, speeds and accelerations.

    Parameters
    ----------
    times : ndarray
        When the set points hold [s].
    given : sequence of ndarray, shape (times, joints)
        Positions, then speeds and accelerations as far as they are needed.
    interpolation : int
        `LINEAR`, `SPLINE` (a cubic spline through the positions, at rest at both ends), `CUBIC`
        (Hermite's of positions and speeds) or `QUINTIC` (of accelerations as well).
    """
    from scipy.interpolate import BPoly, CubicSpline, PPoly  # slow to load

    if interpolation == LINEAR:
        slopes = np.diff(given[0], axis=0) / np.diff(times)[:, None]
        return PPoly(np.stack([slopes, given[0][:-1]]), times)
    if interpolation == SPLINE:
        return CubicSpline(times, given[0], bc_type="clamped")
    values = np.stack(given[:interpolation], axis=1)
    return PPoly.from_bernstein_basis(BPoly.from_derivatives(times, values))


def deviation_of(plan: Plan, pieces: PPoly) -> Deviation:
    """Return the largest distances between a plan and an interpolation of its set points."""
    intervals = len(pieces.x) - 1
    parts = max(_FEWEST_PARTS, -(-_USUAL_PARTS // intervals))
    largest = abs(pieces(pieces.x)).max(axis=0)
    sampled, within = _in_parts(plan, pieces, parts)
    while (within > np.maximum(_MARGIN * sampled, _NOTHING * largest)).any():
        parts *= 4
        if parts * intervals > _MOST_PARTS or not np.isfinite(within).all():
            break
        sampled, within = _in_parts(plan, pieces, parts)
    return Deviation(sampled, sampled + within + _ROUNDING * largest)


def _in_parts(plan: Plan, pieces: PPoly, parts: int) -> tuple[Array, Array]:
    """The largest distance at the ends of the parts, and the most by which it is exceeded."""
    begins, lengths = pieces.x[:-1], np.diff(pieces.x)
    shares = np.linspace(0.0, 1.0, parts + 1)
    times = begins[:, None] + lengths[:, None] * shares
    joints = pieces.c.shape[2]
    own = np.stack([_on_pieces(pieces.c, lengths, shares, order) for order in (0, 2, 4)])
    exact = motion_at(plan, times.ravel())[0].reshape(*times.shape, joints)
    distances = abs(exact - own[0])
    low, high = _accelerations(plan, times)
    width = lengths[:, None] / parts
    # of the interpolation: a polynomial between the ends of a part, and what it bends there
    bend = (width**2 / 8)[..., None] * abs(own[2]).max(axis=1, keepdims=True)
    left, right = own[1][:, :-1], own[1][:, 1:]
    farthest = np.maximum(
        high - (np.minimum(left, right) - bend), np.maximum(left, right) + bend - low
    )
    within = (width**2 / 8)[..., None] * farthest
    ends = np.maximum(distances[:, :-1], distances[:, 1:])
    sampled = ends.max(axis=(0, 1))
    return sampled, np.maximum((ends + within).max(axis=(0, 1)) - sampled, 0.0)


def _on_pieces(coefficients: Array, lengths: Array, shares: Array, order: int) -> Array:
    """A derivative of the polynomials at shares of their lengths, shape (pieces, shares, joints).

    At the end of a piece it is that of this piece, not of the next.
    """
    degree = len(coefficients) - 1
    into = (lengths[:, None] * shares)[..., None]
    value = np.zeros((*into.shape[:2], coefficients.shape[2]))
    for place in range(degree - order + 1):
        power = degree - place
        factor = np.prod(np.arange(power - order + 1, power + 1)) if order else 1.0
        value = value * into + factor * coefficients[place][:, None, :]
    return value


def _accelerations(plan: Plan, times: Array) -> Interval:
    """Enclosures of the joints' accelerations between neighbouring times of every row."""
    task = plan.task
    fractions = _fractions(plan, times)
    first = Interval(fractions[:, :-1], fractions[:, 1:])
    # the quotient is rounded, and where it is 1 the joints rest or are about to
    first = Interval(
        np.maximum(np.nextafter(first.low, -1), 0), np.minimum(np.nextafter(first.high, 2), 1)
    )
    function = path_function(plan.profile, task.plant)
    joints = function.numel_out(0) // 3
    try:
        enclosures = enclose(function, first, [plan.coefficients, task.move])[2 * joints :]
    except NoEnclosureError:
        nothing = np.full((*first.low.shape, joints), np.inf)
        return Interval(-nothing, nothing)
    low = np.stack([np.asarray(found.low) for found in enclosures], axis=-1)
    high = np.stack([np.asarray(found.high) for found in enclosures], axis=-1)
    rests = (times[:, 1:] > task.duration * (1 + 1e-12))[..., None]
    beyond = (times[:, :-1] >= task.duration)[..., None]
    low = np.where(beyond, 0.0, np.where(rests, np.minimum(low, 0.0), low))
    return Interval(low, np.where(beyond, 0.0, np.where(rests, np.maximum(high, 0.0), high)))


def _fractions(plan: Plan, times: Array) -> Array:
    """Shares of the duration, at most 1; what is 1 but for rounding is 1."""
    shares = np.asarray(times) / plan.task.duration
    return np.where(shares > 1 - 1e-12, 1.0, np.maximum(shares, 0.0))


def deviation_words(plan: Plan, deviation: Deviation) -> str:
    """Say how far the joints are at most from the plan, in the unit of each kind of joint."""
    plant = plan.task.plant
    words = dict[str, tuple[float, float]]()
    for kind, sampled, proven in zip(plant.joint_kinds, *deviation):
        unit = str(WAY.of(kind))
        before = words.get(unit, (0.0, 0.0))
        words[unit] = (max(before[0], proven), max(before[1], sampled))
    return " and ".join(
        f"at most {proven:.3g} {unit} (proven; sampled {sampled:.3g} {unit})"
        if np.isfinite(proven)
        else f"{sampled:.3g} {unit} (sampled; no bound is known)"
        for unit, (proven, sampled) in words.items()
    )
