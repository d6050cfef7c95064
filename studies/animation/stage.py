"""The picture that moves: structures above, curves over time with a cursor below."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.lines import Line2D
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar
from quietarm.models import Body
from quietarm.ocp import Trajectory
from quietarm.studies.animation.cast import Actor, Array
from quietarm.studies.animation.formats import Picture
from quietarm.studies.display.pictures import as_written
from quietarm.studies.display.words import REST, millimetres, move_of, moved, title_of
from quietarm.studies.figures.axes import TITLE, axes_or_new, new_figure

_COLUMNS = {1: 1, 2: 2, 4: 2}
"""Panels in a row, by how many there are; else 3."""
_PANEL = 4.0  # inches wide; all other sizes follow
_LEAST_HEIGHT, _MOST_HEIGHT, _PROFILES, _HEAD = 1.7, 3.2, 2.0, 0.45
_MARGIN = 0.08
_LABEL = 44
"""Letters of a label that fit above a panel."""
_THIN, _THICK, _DISC, _PATH = 4.0, 7.0, 13.0, 2.0

_CURVES: dict[str, Callable[[Trajectory], Array]] = {
    "joint angle [rad]": lambda sampled: sampled.joint[:, :1],
    "tip displacement [mm]": lambda sampled: 1e3 * sampled.tips,
    "power [W]": lambda sampled: sampled.power[:, None],
}
"""What is drawn over time, a column for each curve."""

Moving = list[tuple[Line2D, Sequence[Any]]]
"""Artists that change, each with its data (x, y) at every frame."""


def frames_of(
    cast: Sequence[Actor],
    end: float,
    speed: float,
    width: int,
    report: Callable[[int, int], object] | None = None,
) -> Iterator[Picture]:
    """The frames, in order; what does not move is drawn once."""
    columns = _COLUMNS.get(len(cast), 3)
    rows = -(-len(cast) // columns)
    inches = _PANEL * max(columns, 2)
    same = len({actor.line.plan.task for actor in cast}) == 1
    corners = [_with_room(cast, actor.line.plan.task.plant.name) for actor in cast]
    shapes = [np.ptp(one, axis=0) for one in corners]
    highest = max(inches / columns * up / across for across, up in shapes)
    row = _HEAD + 0.2 * (not same) + float(np.clip(highest, _LEAST_HEIGHT, _MOST_HEIGHT))
    heights = [0.3 + rows * row, _PROFILES]
    figure = new_figure(inches, sum(heights))
    figure.set_dpi(width / inches)
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=heights).flat
    words = title_of(cast[0].line.plan.task) if same else "several moves on one clock"
    title = figure.suptitle(_short(words, 22 * columns + 44), x=0.01, ha="left", fontsize=11)
    clock = figure.text(0.99, 1.0, "", ha="right", va="top", fontsize=11, animated=True)
    panels = list(above.subplots(rows, columns, squeeze=False).flat)
    for spare in panels[len(cast) :]:
        spare.axis("off")
    moving: Moving = []
    for actor, its_corners, ax in zip(cast, corners, panels, strict=False):
        moving += _structure(ax, actor, its_corners, same)
    for ax, name in zip(below.subplots(1, len(_CURVES)), _CURVES, strict=True):
        moving += _profile(ax, name, cast, end)
    for artist, _ in moving:
        artist.set_animated(True)
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    with as_written(figure):
        canvas.draw()
    figure.set_layout_engine("none")
    clock.set_y(title.get_position()[1])
    background = canvas.copy_from_bbox(figure.bbox)
    for number, time in enumerate(cast[0].times):
        canvas.restore_region(background)
        clock.set_text(f"t = {time:.2f} s" + f", speed x {speed:g}" * (speed != 1))
        clock.draw(canvas.renderer)
        for artist, data in moving:
            artist.set_data(*data[number])
            artist.draw(canvas.renderer)
        if report is not None:
            report(number + 1, len(cast[0].times))
        yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


def _structure(ax: Axes, actor: Actor, corners: Array, same: bool) -> Moving:
    """Set up a structure's panel; its artists."""
    line, task = actor.line, actor.line.plan.task
    left = line.plan.residual
    residual = millimetres(left) if left >= REST else f"below {millimetres(REST)}"
    lines = [
        line.label,
        *([] if same else [f"{moved(task)}, {move_of(task)}"]),
        f"residual {residual}, energy {line.plan.energy:.3g} J",
    ]
    ax.set_title("\n".join(_short(words, _LABEL) for words in lines), **TITLE)
    ax.set(xticks=[], yticks=[])
    for spine in ax.spines.values():
        spine.set_color("0.8")
    ax.margins(0)
    ax.update_datalim(corners)
    ax.autoscale_view()
    ax.set_aspect("equal", adjustable="datalim")
    words = "deflection to scale" if actor.scale == 1 else f"deflection x {actor.scale:g}"
    ax.text(0.02, 0.03, words, transform=ax.transAxes, fontsize=9, color="0.3")
    length = _round_below(0.25 * float(np.ptp(corners, axis=0).max()))
    ax.add_artist(
        AnchoredSizeBar(ax.transData, length, f"{length:g} m", "lower right", frameon=False)
    )
    dashed: dict[str, Any] = {"color": "0.55", "linewidth": 1.0, "linestyle": "--"}
    moving: Moving = [
        (ax.plot([], [], **dashed)[0], [body.points.T for body in bodies])
        for bodies in zip(*actor.unbent, strict=True)
    ]
    arrived = int(np.searchsorted(actor.times, task.duration))
    for path in actor.paths:
        trail = ax.plot([], [], color=line.colour, linewidth=_PATH, alpha=0.5)[0]
        moving.append((trail, [path[arrived : n + 1].T for n in range(len(path))]))
    for bodies in zip(*actor.bodies, strict=True):
        drawn = ax.plot([], [], solid_capstyle="round", **_look(bodies[0], line.colour))[0]
        moving.append((drawn, [body.points.T for body in bodies]))
    return moving


def _look(body: Body, colour: str) -> dict[str, Any]:
    """A disc, a thick line or a thin one."""
    if len(body.points) == 1:
        return {"color": "0.25", "marker": "o", "markersize": _DISC, "linestyle": ""}
    dark = body.rigid and not body.tip
    return {"color": "0.25" if dark else colour, "linewidth": _THICK if body.rigid else _THIN}


def _profile(ax: Axes, name: str, cast: Sequence[Actor], end: float) -> Moving:
    """Draw a curve of all motions; the cursor, and a dot on every curve."""
    axes_or_new(ax)
    ax.set_title(name, **TITLE)
    ax.set_xlabel("time [s]  (dashed: arrival)", fontsize=9)
    ax.set_xlim(0.0, end)
    times = cast[0].times
    cursor = ax.axvline(0.0, color="0.2", linewidth=1.2)
    moving: Moving = [(cursor, [([time, time], [0, 1]) for time in times])]
    for actor in cast:
        line, sampled = actor.line, actor.trajectory
        for values in _CURVES[name](sampled).T:
            ax.plot(sampled.time, values, color=line.colour, linestyle=line.style, linewidth=1.6)
            dot = ax.plot([], [], "o", color=line.colour, markersize=5)[0]
            at_frames = np.interp(times, sampled.time, values)
            moving.append((dot, [([t], [v]) for t, v in zip(times, at_frames, strict=True)]))
    for arrival in {actor.line.plan.task.duration for actor in cast}:
        ax.axvline(arrival, color="0.6", linewidth=0.8, linestyle="--")
    return moving


def _with_room(cast: Sequence[Actor], plant: str) -> Array:
    """The corners of all motions of a plant [m] with a margin, wider below where words stand."""
    every = np.vstack([a.corners for a in cast if a.line.plan.task.plant.name == plant])
    low, high = every.min(axis=0), every.max(axis=0)
    room = _MARGIN * float((high - low).max())
    return np.array([low, high]) + room * np.array([[-1.0, -2.5], [1.0, 1.0]])


def _round_below(length: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is no longer."""
    power = 10.0 ** np.floor(np.log10(length))
    return max(float(m * power) for m in (1, 2, 5) if m * power <= length)


def _short(text: str, most: int) -> str:
    """A line that fits: cut where it is longer."""
    return text if len(text) <= most else f"{text[: most - 3]}..."
