"""What the page draws of a motion, as arrays: curves, and the structure frame by frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Body
from quietarm.ocp import Plan
from quietarm.ocp.task import QUANTITIES
from quietarm.studies.animation.cast import cast_of
from quietarm.studies.display.words import raised
from quietarm.studies.explore.state import Explored
from quietarm.studies.figures import Line
from quietarm.studies.figures.looks import BLUE, RED

Numbers = list[float]
GREY, INK = "#9e9e9e", "#404040"
FRAMES = 25
"""A second."""
_POINTS = 200
"""Of a curve: on a panel a third of a screen wide their corners cannot be seen."""
_DOT = 1e-6
"""Length of a line that shows as a dot [m]; without any length it would not show."""
_IN_SIGHT = 0.4
"""A limit is drawn where the motion comes to this share of it; else it would flatten the motion."""
TITLES = {"angle": "joint angle [deg]"} | {
    name: f"{quantity.label} [{'mm' if quantity.unit == 'm' else raised(quantity.unit)}]"
    for name, quantity in QUANTITIES.items()
}
"""The panels, by the names of their quantities."""


class Curve(NamedTuple):
    """A line of a panel."""

    x: Numbers
    y: Numbers
    colour: str
    dash: str = "solid"


def panels(explored: Explored) -> dict[str, list[Curve]]:
    """Each quantity over time: the plain cycloid in grey, the motion in hand, limits, arrival."""
    found: dict[str, list[Curve]] = {name: [] for name in TITLES}
    for plan, colour in ((explored.cycloid, GREY), (explored.plan, BLUE)):
        at = plan.trajectory
        every = slice(None, None, max(1, len(at.time) // _POINTS))
        columns = {"angle": [math.degrees(1.0) * at.joint[:, 0]]} | {
            name: quantity.of(at.motion, list(at.tips.T), at.torque)
            for name, quantity in QUANTITIES.items()
        }
        for name, values in columns.items():
            found[name] += [
                Curve(_plain(at.time[every]), _plain(_factor(name) * one[every]), colour)
                for one in values
            ]
    ends = _plain(np.array([0.0, explored.task.duration]))
    for limit in explored.task.limits:
        if limit.name in found and limit.peak_of(explored.plan.motion) >= _IN_SIGHT * limit.size:
            levels = (_factor(limit.name) * one * np.ones(2) for one in (limit.upper, limit.lower))
            found[limit.name] += [Curve(ends, _plain(one), RED, "dashed") for one in levels]
    for curves in found.values():
        ends = [pick(y for curve in curves for y in curve.y) for pick in (min, max)]
        curves.append(Curve([explored.task.duration] * 2, ends, INK, "dotted"))
    return found


def robustness_curves(explored: Explored) -> list[Curve]:
    """The residual [mm] over the error of the frequency [%], and what is tolerated."""
    found = explored.robustness
    (sweep,) = found.sweeps
    errors = _plain(100 * sweep.errors)
    tolerated = np.full(2, 1e3 * found.tolerated)
    return [
        Curve(errors, _plain(1e3 * sweep.figures.residual), BLUE),
        Curve([errors[0], errors[-1]], _plain(tolerated), GREY, "dashed"),
    ]


@dataclass(frozen=True)
class Film:
    """The structure in motion."""

    frames: int
    xs: list[Numbers]
    ys: list[Numbers]
    """Coordinates of every body [m], frame after frame."""
    looks: dict[str, list[Any]]
    """Colour and width of every body."""
    paths: list[list[Numbers]]
    corners: list[Numbers]
    """Coordinates x and y of where each tip goes, and the least and largest of all [m]."""
    scale: float
    """How many times larger deflections are drawn than they are."""


def film(plan: Plan) -> Film:
    """The structure of a plan from its start to the end of the residual window."""
    end = plan.task.duration + plan.task.residual_window
    times = np.arange(0.0, end, 1 / FRAMES)
    (actor,) = cast_of([Line(plan, "")], times, end)
    of_bodies = [
        np.array([_drawable(body) for body in frames]) for frames in zip(*actor.bodies, strict=True)
    ]
    xs, ys = ([_plain(points[..., axis].ravel()) for points in of_bodies] for axis in (0, 1))
    colours, widths = zip(*map(_look, actor.bodies[0]), strict=True)
    looks = {"colour": list(colours), "width": list(widths)}
    paths = [[_plain(path[:, axis]) for path in actor.paths] for axis in (0, 1)]
    corners = [_plain(ends) for ends in actor.corners.T]
    return Film(len(times), xs, ys, looks, paths, corners, actor.scale)


def _plain(values: NDArray[np.float64]) -> Numbers:
    """Numbers to five digits of the largest: lists are in the browser sooner than many arrays."""
    largest = float(np.abs(values).max(initial=0.0))
    digits = 0 if largest == 0 else 4 - math.floor(math.log10(largest))
    return np.round(values, digits).tolist()


def _factor(name: str) -> float:
    return 1e3 if name in QUANTITIES and QUANTITIES[name].unit == "m" else 1.0


def _drawable(body: Body) -> NDArray[np.float64]:
    """The line of a body; a disc is hardly one, with round ends."""
    return (
        body.points if len(body.points) > 1 else body.points + np.array([[0.0, 0.0], [_DOT, 0.0]])
    )


def _look(body: Body) -> tuple[str, float]:
    """A disc, a thick line or a thin one, as `quietarm animate` draws them."""
    if len(body.points) == 1:
        return INK, 16.0
    dark = body.rigid and not body.tip
    return (INK if dark else BLUE), (9.0 if body.rigid else 5.0)
