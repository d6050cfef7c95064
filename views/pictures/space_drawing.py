"""A structure in space on axes of matplotlib, frame by frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from numpy.typing import NDArray

from quietarm.views.pictures.grammar import AFTER_ARRIVAL, FAINT, GREY, PALE
from quietarm.views.pictures.space import Camera, by_depth, capsules
from quietarm.views.pictures.structure import Structure

Array = NDArray[np.float64]
Update = Callable[[int], object]
"""Brings an artist to a frame."""
_EDGE = 0.004
"""Width of the light edge around a part, as a share of the room's size."""
_LIGHT = 0.3
"""Share by which the lit side of a part is whiter, and how far and how wide it is."""
_LIT = 0.35
_FLAT = 0.45
"""Height of a shadow as a share of its width, about."""
_SHADOW = "#DADDE1"


def draw_in_space(ax: Axes, structure: Structure, camera: Camera) -> Iterator[Update]:
    """Set up a structure's panel; what brings its parts to a frame."""
    edge, squares = camera.floor()
    parts = structure.bent
    places = [camera.seen(part.points)[..., :2].reshape(-1, 2) for part in parts]
    ax.update_datalim(np.vstack([edge, *places]))
    ax.autoscale_view()
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_axis_off()
    light_edge = _EDGE * camera.room.reach
    ax.add_collection(PolyCollection([edge], facecolor=PALE, zorder=0.1), autolim=False)
    lines = LineCollection(squares, color="white", linewidth=0.8, zorder=0.2)
    ax.add_collection(lines, autolim=False)
    shadow = PathPatch(Path(edge), facecolor=_SHADOW, linewidth=0.0, zorder=0.3)
    ax.add_patch(shadow)

    def cast(k: int) -> None:
        outlines = list[Array]()
        for part in parts:
            if part.colour != FAINT:
                outlines += capsules(camera.shadow(part.points[k]), _FLAT * part.radius)
        shadow.set_path(Path.make_compound_path(*(Path(line, closed=True) for line in outlines)))

    yield cast
    begun = int(np.searchsorted(structure.times, structure.trail_begins))
    for path in structure.paths:
        (trail,) = ax.plot([], [], color=structure.line.colour, linewidth=1.6, zorder=0.4)
        trail.set_alpha(AFTER_ARRIVAL)
        way = camera.seen(path)[:, :2]
        yield lambda k, trail=trail, way=way: trail.set_data(*way[begun : k + 1].T)
    bodies = PolyCollection([], linewidths=0.0, zorder=1.0)
    ax.add_collection(bodies, autolim=False)

    def place(k: int) -> None:
        outlines = list[Array]()
        colours = list[Any]()
        for number, seen in by_depth(parts, k, camera):
            part = parts[number]
            for look in _layers(part.colour, light_edge):
                pieces = capsules(seen, look["share"] * part.radius, look["wider"], look["shift"])
                outlines += pieces
                colours += [look["colour"]] * len(pieces)
        bodies.set_verts(outlines)
        bodies.set_facecolor(colours)

    yield place
    for part in structure.unbent:
        if not part.tip:
            continue
        (dashed,) = ax.plot([], [], color=GREY, linewidth=1.0, linestyle="--")
        line = camera.seen(part.points)[..., :2]
        yield lambda k, dashed=dashed, line=line: dashed.set_data(*line[k].T)


def _layers(colour: str, edge: float) -> list[dict[str, Any]]:
    """A light edge around a part, the part, and its lit side."""
    lit = tuple((1 - _LIGHT) * channel + _LIGHT for channel in to_rgb(colour))
    return [
        {"colour": "white", "share": 1.0, "wider": edge, "shift": 0.0},
        {"colour": colour, "share": 1.0, "wider": 0.0, "shift": 0.0},
        {"colour": lit, "share": _LIT, "wider": 0.0, "shift": _LIT},
    ]
