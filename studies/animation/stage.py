"""The picture that moves: structures above, joint angle and power with a cursor below."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import SubFigure
from matplotlib.lines import Line2D
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar
from quietarm.models import Body
from quietarm.studies.animation.cast import Actor, Array
from quietarm.studies.animation.clock import Clock
from quietarm.studies.animation.formats import Picture
from quietarm.studies.display.pictures import as_written
from quietarm.studies.display.words import millimetres, move_of, plant_words, title_of
from quietarm.studies.figures.axes import TITLE, axes_or_new, new_figure

_COLUMNS = {1: 1, 2: 2, 4: 2}
"""Panels in a row, by how many there are; else 3."""
_PANEL = 4.0  # inches wide; all other sizes follow
_LEAST_HEIGHT, _MOST_HEIGHT, _PROFILES, _HEAD = 1.7, 3.2, 2.0, 0.45
_MARGIN = 0.08
_UNSEEN = 1e-6
"""Residuals below a thousandth of a millimetre [m] are said to be below that."""
_LABEL = 44
"""Letters of a label that fit above a panel."""
_THIN, _THICK, _DISC, _PATH = 4.0, 7.0, 13.0, 2.0


@dataclass(frozen=True)
class _Moving:
    """Artists that change from frame to frame, of one actor."""

    actor: Actor
    bodies: list[Line2D]
    unbent: list[Line2D]
    paths: list[Line2D]
    dots: list[Line2D]
    profiles: list[Array]  # of every dot its values at the frames
    arrived: int  # the first frame after it


class Stage:
    """Draws the frames of an animation, one after another."""

    def __init__(self, cast: Sequence[Actor], clock: Clock, width: int) -> None:
        self._clock = clock
        count = len(cast)
        columns = _COLUMNS.get(count, 3)
        rows = -(-count // columns)
        inches = _PANEL * max(columns, 2)
        same = len({actor.line.plan.task for actor in cast}) == 1
        extents = [_extent(cast, actor.line.plan.task.plant.name) for actor in cast]
        row = (
            _HEAD + 0.2 * (not same) + max(_height(extent, inches / columns) for extent in extents)
        )
        heights = [0.3 + rows * row, _PROFILES]
        self._figure = new_figure(inches, sum(heights))
        self._figure.set_dpi(width / inches)
        parts = self._figure.subfigures(2, 1, squeeze=False, height_ratios=heights)
        above, below = parts.flat
        title = title_of(cast[0].line.plan.task) if same else "several moves on one clock"
        words = _short(title, 22 * columns + 44)
        self._title = self._figure.suptitle(words, x=0.01, ha="left", fontsize=11, parse_math=False)
        self._time = self._figure.text(0.99, 1.0, "", ha="right", va="top", fontsize=11)
        panels = list(above.subplots(rows, columns, squeeze=False).flat)
        for spare in panels[count:]:
            spare.axis("off")
        profiles = self._profiles(below, cast)
        self._moving = [
            self._actor(actor, extent, panel, profiles, same)
            for actor, extent, panel in zip(cast, extents, panels, strict=False)
        ]
        self._cursors = [ax.axvline(0.0, color="0.2", linewidth=1.2) for ax in profiles]
        self._artists: list[Artist] = [self._time, *self._cursors]
        for one in self._moving:
            self._artists += [*one.unbent, *one.paths, *one.bodies, *one.dots]
        for artist in self._artists:
            artist.set_animated(True)

    def frames(self) -> Iterator[Picture]:
        """The frames, in order; what does not move is drawn once."""
        canvas = self._figure.canvas
        assert isinstance(canvas, FigureCanvasAgg)
        with as_written(self._figure):
            canvas.draw()
        self._figure.set_layout_engine("none")
        self._time.set_y(self._title.get_position()[1])
        background = canvas.copy_from_bbox(self._figure.bbox)
        for number, time in enumerate(self._clock.times):
            self._set(number, float(time))
            canvas.restore_region(background)
            for artist in self._artists:
                artist.draw(canvas.renderer)
            yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()

    def _set(self, number: int, time: float) -> None:
        """Move everything to a frame."""
        speed = self._clock.speed
        self._time.set_text(f"t = {time:.2f} s" + f", speed x {speed:g}" * (speed != 1))
        for cursor in self._cursors:
            cursor.set_xdata([time, time])
        for one in self._moving:
            _place(one.bodies, one.actor.bodies[number])
            _place(one.unbent, one.actor.unbent[number])
            for path, points in zip(one.paths, one.actor.paths, strict=True):
                path.set_data(*points[one.arrived : number + 1].T)
            for dot, values in zip(one.dots, one.profiles, strict=True):
                dot.set_data([time], [values[number]])

    def _actor(
        self, actor: Actor, extent: Array, ax: Axes, profiles: Sequence[Axes], same: bool
    ) -> _Moving:
        """Set up a structure's panel, and its artists."""
        colour, task = actor.line.colour, actor.line.plan.task
        moves = [] if same else [f"{plant_words(task.plant)}, {move_of(task)}"]
        lines = [actor.line.label, *moves, _figures(actor)]
        title = "\n".join(_short(line, _LABEL) for line in lines)
        ax.set_title(title, **TITLE, parse_math=False)
        ax.set(xticks=[], yticks=[])
        for spine in ax.spines.values():
            spine.set_color("0.8")
        low, high = _with_room(extent)
        ax.margins(0)
        ax.update_datalim([low, high])
        ax.autoscale_view()
        ax.set_aspect("equal", adjustable="datalim")
        _describe_scales(ax, actor.scale, float((high - low).max()))
        at, sampled = self._clock.times, actor.trajectory.time
        return _Moving(
            actor,
            bodies=[_drawn(ax, body, colour) for body in actor.bodies[0]],
            unbent=[
                ax.plot([], [], color="0.55", linewidth=1.0, linestyle="--")[0]
                for _ in actor.unbent[0]
            ],
            paths=[
                ax.plot([], [], color=colour, linewidth=_PATH, alpha=0.5)[0] for _ in actor.paths
            ],
            dots=[panel.plot([], [], "o", color=colour, markersize=5)[0] for panel in profiles],
            profiles=[np.interp(at, sampled, values) for values in _profiled(actor)],
            arrived=int(np.searchsorted(at, task.duration)),
        )

    def _profiles(self, below: SubFigure, cast: Sequence[Actor]) -> list[Axes]:
        """The curves of all motions, below the structures."""
        axes = list(below.subplots(1, 2, squeeze=False).flat)
        for ax, name in zip(axes, ("joint angle [rad]", "power [W]"), strict=True):
            axes_or_new(ax)
            ax.set_title(name, **TITLE)
            ax.set_xlabel("time [s]  (dashed: arrival)")
            ax.set_xlim(0.0, self._clock.end)
        for actor in cast:
            line = actor.line
            for ax, values in zip(axes, _profiled(actor), strict=True):
                ax.plot(
                    actor.trajectory.time, values, color=line.colour, linestyle=line.style,
                    linewidth=1.6,
                )  # fmt: skip
        for arrival in {actor.line.plan.task.duration for actor in cast}:
            for ax in axes:
                ax.axvline(arrival, color="0.6", linewidth=0.8, linestyle="--")
        return axes


def _profiled(actor: Actor) -> tuple[Array, Array]:
    """What is drawn below: joint angle [rad] and power [W]."""
    return actor.trajectory.joint[:, 0], actor.trajectory.power


def _place(artists: Sequence[Line2D], bodies: Sequence[Body]) -> None:
    for artist, body in zip(artists, bodies, strict=True):
        artist.set_data(*body.points.T)


def _drawn(ax: Axes, body: Body, colour: str) -> Line2D:
    """The artist of a body: a disc, a thick line or a thin one."""
    if len(body.points) == 1:
        return ax.plot([], [], "o", color="0.25", markersize=_DISC)[0]
    drawn = "0.25" if body.rigid and not body.tip else colour
    width = _THICK if body.rigid else _THIN
    return ax.plot([], [], color=drawn, linewidth=width, solid_capstyle="round")[0]


def _extent(cast: Sequence[Actor], plant: str) -> Array:
    """Lower left and upper right corner of all motions of one plant [m], shape (2, 2)."""
    corners = np.vstack([a.extent for a in cast if a.line.plan.task.plant.name == plant])
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def _with_room(extent: Array) -> Array:
    """The corners with a margin; words stand below."""
    room = _MARGIN * float(np.ptp(extent, axis=0).max())
    return extent + room * np.array([[-1.0, -2.5], [1.0, 1.0]])


def _height(extent: Array, width: float) -> float:
    """Height of a panel of this width [inch] that leaves no empty space."""
    across, up = np.ptp(_with_room(extent), axis=0)
    return float(np.clip(width * up / across, _LEAST_HEIGHT, _MOST_HEIGHT))


def _describe_scales(ax: Axes, scale: float, size: float) -> None:
    """Say how far deflections are exaggerated, and how long things are."""
    words = "deflection to scale" if scale == 1 else f"deflection x {scale:g}"
    ax.text(0.02, 0.03, words, transform=ax.transAxes, fontsize=9, color="0.3")
    length = _round_below(0.25 * size)
    ax.add_artist(
        AnchoredSizeBar(ax.transData, length, f"{length:g} m", "lower right", frameon=False)
    )


def _round_below(length: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is no longer."""
    power = 10.0 ** np.floor(np.log10(length))
    return max(float(m * power) for m in (1, 2, 5) if m * power <= length)


def _figures(actor: Actor) -> str:
    """What the motion leaves and takes."""
    left = actor.line.plan.residual
    words = millimetres(left) if left >= _UNSEEN else f"below {millimetres(_UNSEEN)}"
    return f"residual {words}, energy {actor.line.plan.energy:.3g} J"


def _short(text: str, most: int) -> str:
    """A line that fits: cut where it is longer."""
    return text if len(text) <= most else f"{text[: most - 3]}..."
