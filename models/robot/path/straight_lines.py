"""Straight lines between points that joints go through: how far from them, and by how few."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from quietarm.models.joint_motion import Array
from quietarm.models.robot.path.piecewise import Piecewise, interpolate

Spline = Callable[[Array], Array]


def nearest_on_lines(positions: Array, points: Array) -> Array:
    """The nearest point of the lines between points, of many positions, shape (positions, joints).

    Of several joints none is at fault for its timing.
    """
    begins = points[:-1]
    ways = np.diff(points, axis=0)
    squares = np.maximum((ways**2).sum(axis=1), 1e-300)
    nearest = np.empty_like(positions)
    for part in np.array_split(np.arange(len(positions)), 1 + len(positions) * len(ways) // _MANY):
        arms = positions[part, None] - begins
        shares = np.clip((arms * ways).sum(axis=2) / squares, 0.0, 1.0)
        feet = begins + shares[..., None] * ways
        best = ((positions[part, None] - feet) ** 2).sum(axis=2).argmin(axis=1)
        nearest[part] = feet[np.arange(len(part)), best]
    return nearest


_MANY = 200_000
"""Pairs of a position and a line at once."""


def vertices_within(points: Array, tolerance: float) -> Array:
    """Return as few of the points as keep the lines within a tolerance of all [rad or m]."""
    return points[numbers_within(points, tolerance)]


def numbers_within(points: Array, tolerance: float) -> list[int]:
    """The numbers of these; the tolerance is of the joints together.

    Douglas and Peucker, Cartographica 10 (1973).
    """
    kept = {0, len(points) - 1}
    open_parts = [(0, len(points) - 1)]
    while open_parts:
        begin, end = open_parts.pop()
        if end - begin < 2:
            continue
        between = points[begin + 1 : end]
        line = points[[begin, end]]
        off = np.linalg.norm(between - nearest_on_lines(between, line), axis=1)
        at = int(off.argmax())
        if off[at] > tolerance:
            middle = begin + 1 + at
            kept.add(middle)
            open_parts += [(begin, middle), (middle, end)]
    return sorted(kept)


def without_spurs(points: Array, tolerance: float) -> tuple[Array, tuple[str, ...]]:
    """Points without short ways out and back, as of a motion that overshoots; words on them.

    What is left was passed anyway. Long ones stay, and so do all where they are many: noise.
    """
    remarks = list[str]()
    left = points
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    for _ in range(_MOST_SPURS + 1):
        corners = numbers_within(left, tolerance / 4)
        steps = np.diff(left[corners], axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        cosines = (steps[1:] * steps[:-1]).sum(axis=1) / (lengths[1:] * lengths[:-1])
        ways = np.minimum(lengths[1:], lengths[:-1])
        spurs = np.flatnonzero((cosines < BACK) & (ways < _SHORT * length))
        if not len(spurs):
            return left, tuple(remarks)
        spur = spurs[0]
        left = np.delete(left, np.arange(corners[spur] + 1, corners[spur + 2]), axis=0)
        remarks.append(
            f"{ways[spur]:.2g} rad (or m) that it goes beyond a point and back are left out"
        )
    return points, ()


BACK = -0.95
"""Cosine between two parts of a way, below which it turns back."""
_MOST_SPURS = 4
_SHORT = 0.05
"""Share of the way of what may be left out."""


def fewest_within(
    points: Array, tolerance: float, spline: Callable[[Array, Array], Spline], most: int
) -> tuple[list[int], Array]:
    """Numbers of some of the points whose spline is within a tolerance of the lines between all.

    Points are added where it is farthest, one between two others at a time.

    Parameters
    ----------
    points : ndarray, shape (points, joints)
        Without neighbours at one place.
    tolerance : float
        [rad or m].
    spline : callable
        (places, points) -> the spline.
    most : int
        How many may be needed.

    Returns
    -------
    numbers, places : list of int, ndarray
        Where these are, by the way along the lines from 0 to 1. None where it takes more.
    """
    ways = np.linalg.norm(np.diff(points, axis=0), axis=1)
    places = np.append(0.0, np.cumsum(ways)) / ways.sum()
    places[-1] = 1.0
    between = (places[1:] + places[:-1]) / 2
    checked = np.sort(np.concatenate([places, between]))
    along = np.column_stack([np.interp(checked, places, column) for column in points.T])
    kept = np.unique(
        np.searchsorted(places, np.linspace(0.0, 1.0, _FIRST)).clip(max=len(points) - 1)
    )
    while len(kept) <= most:
        off = np.abs(spline(places[kept], points[kept])(checked) - along).max(axis=1)
        if off.max() <= tolerance:
            return kept.tolist(), places[kept]
        parts = np.searchsorted(places[kept], checked, side="right").clip(1, len(kept) - 1)
        added = list[int]()
        for part in range(1, len(kept)):
            begin, end = kept[part - 1], kept[part]
            inside = np.flatnonzero(parts == part)
            at = inside[off[inside].argmax()]
            if off[at] > tolerance and end - begin > 1:
                nearest = int(np.abs(places[begin + 1 : end] - checked[at]).argmin())
                added.append(begin + 1 + nearest)
        if not added:
            break
        kept = np.sort(np.append(kept, added))
    return [], np.array([])


_FIRST = 3
"""Points of a first spline."""


def rounded_lines(points: Array, tolerance: float) -> Piecewise:
    """Straight lines between points whose corners are rounded, with three continuous derivatives.

    Within a tolerance of the corners, of the joints together [rad or m], and nearer where lines are
    short.
    """
    lengths, directions = _lines_of(points)
    turns = np.linalg.norm(np.diff(directions, axis=0), axis=1)
    wanted = tolerance / (_AT_CORNER * np.maximum(turns, 1e-12))
    return with_round_corners(points, np.minimum(wanted, room_at_corners(lengths)))


def room_at_corners(lengths: Array) -> Array:
    """Return how far from each corner it may begin to be round: half of the shorter line."""
    return np.minimum(lengths[:-1], lengths[1:]) / 2


def with_round_corners(points: Array, halves: Array) -> Piecewise:
    """Straight lines between points, round from a way before each corner to as far behind it.

    Three derivatives are continuous.
    """
    lengths, directions = _lines_of(points)
    corners = np.cumsum(lengths)[:-1]
    turns = np.diff(directions, axis=0)
    total = lengths.sum()
    knots = np.concatenate([[0.0], np.column_stack([corners - halves, corners + halves]).ravel()])
    knots = np.append(knots, total)
    knots = knots[np.append(True, np.diff(knots) > _NOTHING * total)]
    knots[-1] = total

    def positions(places: Array) -> Array:
        way = np.asarray(places) * total
        line = points[0] + way[:, None] * directions[0]
        for corner, turn, half in zip(corners, turns, halves):
            share = np.clip((way - corner) / (2 * half) + 0.5, 0.0, 1.0)
            beyond = np.maximum(way - corner - half, 0.0)
            line = line + (2 * half * _rise(share) + beyond)[:, None] * turn
        return line

    return Piecewise(knots / total, interpolate(positions, knots / total, _TERMS))


def _lines_of(points: Array) -> tuple[Array, Array]:
    """Lengths and directions of the lines between points."""
    ways = np.diff(points, axis=0)
    lengths = np.linalg.norm(ways, axis=1)
    return lengths, ways / lengths[:, None]


def blends_within(
    points: Array, place: Callable[[Array], Array], radii: Array
) -> tuple[Array, Array]:
    """Return where corners begin to be round, such that a place in space is then within a radius.

    Parameters
    ----------
    points : ndarray, shape (points, joints)
        Without neighbours at one place.
    place : callable
        Positions of the joints -> the place [m].
    radii : ndarray
        Around the place at each point but the first and the last [m].

    Returns
    -------
    halves, reached : ndarray
        The way before and behind each corner, and how far the place is from that at the corner
        there [m], less than the radius where half of a line is nearer.
    """
    lengths, directions = _lines_of(points)
    room = room_at_corners(lengths)
    halves = np.empty(len(room))
    reached = np.empty(len(room))
    for number, (corner, radius) in enumerate(zip(points[1:-1], radii)):
        centre = place(corner)

        def away(way: float, direction: Array, corner: Array = corner) -> float:
            return float(np.linalg.norm(place(corner + way * direction) - centre))  # noqa: B023

        sides = (-directions[number], directions[number + 1])
        half = min(_first_reach(away, side, radius, room[number]) for side in sides)
        halves[number] = half
        reached[number] = max(away(half, side) for side in sides)
    return halves, reached


def _first_reach(
    away: Callable[[float, Array], float], direction: Array, radius: float, room: float
) -> float:
    """Return the way along a direction on which a radius is reached first, or the room there is."""
    before = 0.0
    for way in np.linspace(0.0, room, _STEPS_TO_REACH)[1:]:
        if away(way, direction) > radius:
            least, most = before, float(way)
            for _ in range(_HALVINGS):
                middle = (least + most) / 2
                least, most = (
                    (least, middle) if away(middle, direction) > radius else (middle, most)
                )
            return least
        before = float(way)
    return room


_STEPS_TO_REACH = 33
_HALVINGS = 40


def _rise(share: Array) -> Array:
    """Integral of the smooth step of fifth degree, whose first two derivatives begin with 0."""
    return share**6 - 3 * share**5 + 2.5 * share**4


_TERMS = 7
"""Of a polynomial of sixth degree."""
_AT_CORNER = 2 * float(_rise(np.array(0.5)))
"""How far a rounded corner is from the corner, in shares of half its length times the turn."""
_NOTHING = 1e-9
"""Share of the way of a line that is all corner."""
