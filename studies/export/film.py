"""Films of motions: structures side by side above, curves with a cursor below, by matplotlib."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, HTMLWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar
from numpy.typing import NDArray
from PIL import Image
from quietarm.models import Body
from quietarm.ocp.checks import positive, whole
from quietarm.ocp.files import write_whole
from quietarm.studies.display.pictures import as_written
from quietarm.studies.display.words import REST, millimetres, move_of, moved, title_of
from quietarm.studies.export.formats import FORMATS, FRAMES, format_of
from quietarm.studies.figures.axes import TITLE, axes_or_new, new_figure
from quietarm.studies.figures.motion import Motions, draw_lines, lines_of
from quietarm.studies.figures.structure import Structure, structures_of

_MOST_MOTIONS, _MOST_FRAMES = 6, 500
"""More could not be seen side by side, or would take minutes."""
_LEAST_A_SECOND, _MOST_A_SECOND = 1, 50
_LEAST_WIDTH, _MOST_WIDTH = 200, 2000
_ROUNDING = 1e-6
"""Of a frame: one that is this close to the end belongs to it."""
_COLUMNS = {1: 1, 2: 2, 4: 2}
"""Panels in a row, by how many there are; else 3."""
_PANEL, _LINE, _LETTERS = 4.0, 0.2, 11.5
"""Width of a panel and height of a line of its title [inch], and letters an inch."""
_LEAST_HEIGHT, _MOST_HEIGHT, _CURVES_HEIGHT = 1.7, 3.2, 2.0
_COLOURS = 128
_MEGABYTES = 200.0
"""Most of a page, far above what `_MOST_FRAMES` take."""
_CURVES = ("angle", "deflection", "power")

Update = Callable[[int], object]
"""Brings an artist to a frame."""


@dataclass(frozen=True, eq=False)
class Film:
    """Motions on one clock; a notebook shows them where this is a cell's last line."""

    structures: Sequence[Structure]
    end: float
    speed: float
    rate: float
    width: int

    @property
    def frames(self) -> int:
        """How many pictures it has."""
        return len(self.structures[0].times)

    @property
    def seconds(self) -> float:
        """How long it takes [s]."""
        return self.frames / self.rate

    def save(
        self,
        path: str | Path,
        format: str | None = None,  # noqa: A002  # as other libraries call it
        report: Callable[[int, int], object] = lambda done, total: None,
    ) -> None:
        """Write a film as gif, mp4 (by the program ffmpeg) or html, whole or not at all.

        ValueError where the name ends in something else, or there is no ffmpeg.
        """
        name = format_of(Path(path), format)
        if not FORMATS[name].is_film:
            raise ValueError(f"{path} is no film; end its name in .gif, .mp4 or .html")
        write_whole(path, self._content(name, report))

    def _content(self, name: str, report: Callable[[int, int], object]) -> bytes:
        if name == "mp4" and not FFMpegWriter.isAvailable():
            raise ValueError(
                "an mp4 needs the program ffmpeg, which is not found here; install it, or make a "
                "gif or html"
            )
        figure, updates = _draw(self)
        with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
            place = Path(folder) / f"film.{name}"
            writer = _writer(name, self.rate)
            with writer.saving(figure, str(place), figure.dpi):
                for k in range(self.frames):
                    for update in updates:
                        update(k)
                    writer.grab_frame()
                    report(k + 1, self.frames)
            return place.read_bytes()

    def _repr_html_(self) -> str:
        """What a notebook shows: a gif, so that it needs no server."""
        content = base64.b64encode(self._content("gif", lambda done, total: None)).decode()
        return f'<img alt="structures in motion" src="data:image/gif;base64,{content}"/>'


def animate(
    motions: Motions,
    *,
    deflection_scale: float | None = None,
    speed: float = 1.0,
    rate: float = FRAMES,
    width: int = 800,
) -> Film:
    """Draw structures in motion, side by side and on one clock.

    Every link is bent as its mode bends it, and its plant says how (`Plant.structure`); dashed is
    where it would be without bending. After arrival the path of the tips is drawn. Below are the
    joint angle, the tips' displacements and the power, with a cursor. The clock goes on until the
    last residual window ends.

    Parameters
    ----------
    motions : sequence of Line, Plan or Floor
        The motions, of any plants and durations, 6 at most; a plan alone is drawn beside the plain
        cycloid of its task.
    deflection_scale : float, optional
        How many times larger than they are deflections are drawn, which the picture says; by
        default so that the largest is up to a fifth of the structure, but never less than 1.
    speed : float
        Seconds of the motion in a second of the film: 0.25 is slow motion.
    rate : float
        Frames in a second, 50 at most. A gif counts hundredths of a second: 50, 25 and 20 are
        exact, 30 is rounded.
    width : int
        Width of the picture [pixels], 200 to 2000.

    Returns
    -------
    Film
        To be shown in a notebook, or saved.

    Raises
    ------
    ValueError
        When there is no motion or too many, or a number is out of range.
    """
    lines = lines_of(motions)
    if len(lines) > _MOST_MOTIONS:
        raise ValueError(
            f"{len(lines)} motions are given, where {_MOST_MOTIONS} are the most that can be seen "
            "side by side; give fewer"
        )
    width = whole("width", width, _LEAST_WIDTH, _MOST_WIDTH, "more pixels make a huge file")
    if deflection_scale is not None:
        positive("deflection scale", deflection_scale)
    end = max(line.plan.task.duration + line.plan.task.residual_window for line in lines)
    times = _frame_times(end, speed, rate)
    return Film(structures_of(lines, times, end, deflection_scale), end, speed, rate, width)


def _frame_times(end: float, speed: float, rate: float) -> NDArray[np.float64]:
    """When the frames are; ValueError where they are too many, or too few in a second."""
    positive("speed", speed)
    if not _LEAST_A_SECOND <= rate <= _MOST_A_SECOND:
        raise ValueError(
            f"the rate of frames is {rate:g} Hz; give {_LEAST_A_SECOND} to {_MOST_A_SECOND}: "
            "browsers show no more of a gif, and slow motion is a lower speed"
        )
    frames = end * rate / speed
    if frames > _MOST_FRAMES:
        raise ValueError(
            f"{end:g} s at {rate:g} frames per second and speed {speed:g} make {frames:.0f} "
            f"frames, where {_MOST_FRAMES} are the most that can be drawn and shown in reasonable "
            "time; give a lower rate or a higher speed"
        )
    return np.arange(float(int(frames + _ROUNDING) + 1)) * speed / rate


def _writer(name: str, rate: float) -> AbstractMovieWriter:
    if name == "html":
        return HTMLWriter(fps=rate, embed_frames=True, embed_limit=_MEGABYTES)
    return FFMpegWriter(fps=rate) if name == "mp4" else _GifWriter(fps=rate)


class _GifWriter(PillowWriter):
    """Frames share the colours of the last one, undithered: a tenth of the size."""

    _frames: list[Image.Image]

    def finish(self) -> None:
        """Write the file."""
        last, none = self._frames[-1], Image.Dither.NONE
        palette = last.quantize(_COLOURS, dither=none)
        self._frames = [one.quantize(palette=palette, dither=none) for one in self._frames]
        super().finish()


def _draw(film: Film) -> tuple[Figure, list[Update]]:
    """The figure, laid out, and what brings it to a frame."""
    structures = film.structures
    columns = _COLUMNS.get(len(structures), 3)
    rows = -(-len(structures) // columns)
    inches = _PANEL * max(columns, 2)
    same = len({one.line.plan.task for one in structures}) == 1
    room = int(_LETTERS * inches / columns)
    titles = [_title(one, same, room) for one in structures]
    words = title_of(structures[0].line.plan.task) if same else "several moves on one clock"
    heading = wrap(words, int(_LETTERS * inches) - 24)  # the clock stands beside it
    corners = [_corners(structures, one.line.plan.task.plant.name) for one in structures]
    highest = max(inches / columns * up / across for across, up in np.ptp(corners, axis=1))
    row = float(np.clip(highest, _LEAST_HEIGHT, _MOST_HEIGHT)) + _LINE * max(map(len, titles))
    heights = [_LINE * len(heading) + 0.1 + rows * row, _CURVES_HEIGHT]
    figure = new_figure(inches, sum(heights))
    figure.set_dpi(film.width / inches)
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=heights).flat
    figure.suptitle("\n".join(heading), x=0.01, ha="left", fontsize=11)
    clock = figure.text(0.99, 0.99, "", ha="right", va="top", fontsize=11)
    times = structures[0].times

    def tell(k: int) -> None:
        at_speed = f", speed x {film.speed:g}" if film.speed != 1 else ""
        clock.set_text(f"t = {times[k]:.2f} s{at_speed}")

    updates: list[Update] = [tell]
    panels = list(above.subplots(rows, columns, squeeze=False).flat)
    for spare in panels[len(structures) :]:
        spare.axis("off")
    for one, title, its_corners, ax in zip(structures, titles, corners, panels, strict=False):
        ax.set_title("\n".join(title), **TITLE)
        updates += _draw_structure(ax, one, its_corners)
    for ax, quantity in zip(below.subplots(1, len(_CURVES)), _CURVES, strict=True):
        draw_lines([one.line for one in structures], quantity, axes_or_new(ax))
        ax.set_xlim(0.0, film.end)
        ax.xaxis.label.set_fontsize(9)
        cursor = ax.axvline(0.0, color="0.2", linewidth=1.2)
        updates.append(lambda k, cursor=cursor: cursor.set_xdata([times[k], times[k]]))
    with as_written(figure):
        figure.draw_without_rendering()
    figure.set_layout_engine("none")
    return figure, updates


def _title(one: Structure, same: bool, room: int) -> list[str]:
    """The lines above a panel."""
    plan = one.line.plan
    residual = millimetres(plan.residual) if plan.residual >= REST else f"below {millimetres(REST)}"
    lines = [
        one.line.label,
        *([] if same else [f"{moved(plan.task)}, {move_of(plan.task)}"]),
        f"residual {residual}, energy {plan.energy:.3g} J",
    ]
    return [part for line in lines for part in wrap(line, room)]


def _draw_structure(ax: Axes, one: Structure, corners: NDArray[np.float64]) -> Iterator[Update]:
    """Set up a structure's panel; what brings its parts to a frame."""
    ax.set(xticks=[], yticks=[])
    for spine in ax.spines.values():
        spine.set_color("0.8")
    ax.margins(0)
    ax.update_datalim(corners)
    ax.autoscale_view()
    ax.set_aspect("equal", adjustable="datalim")
    words = "deflection to scale" if one.scale == 1 else f"deflection x {one.scale:g}"
    ax.text(0.02, 0.03, words, transform=ax.transAxes, fontsize=9, color="0.3")
    length = _round_below(0.25 * float(np.ptp(corners, axis=0).max()))
    ax.add_artist(
        AnchoredSizeBar(ax.transData, length, f"{length:g} m", "lower right", frameon=False)
    )

    def part(points: Sequence[NDArray[np.float64]], **look: Any) -> Update:
        (artist,) = ax.plot([], [], **look)
        return lambda k: artist.set_data(*points[k].T)

    colour = one.line.colour
    for bodies in zip(*one.unbent, strict=True):
        dashed = {"color": "0.55", "linewidth": 1.0, "linestyle": "--"}
        yield part([body.points for body in bodies], **dashed)
    arrived = int(np.searchsorted(one.times, one.line.plan.task.duration))
    for path in one.paths:
        trail = [path[arrived : k + 1] for k in range(len(path))]
        yield part(trail, color=colour, linewidth=2.0, alpha=0.5)
    for bodies in zip(*one.bodies, strict=True):
        look = _look(bodies[0], colour)
        yield part([body.points for body in bodies], solid_capstyle="round", **look)


def _look(body: Body, colour: str) -> dict[str, Any]:
    """A disc, a thick line or a thin one."""
    if len(body.points) == 1:
        return {"color": "0.25", "marker": "o", "markersize": 13.0, "linestyle": ""}
    dark = body.rigid and not body.tip
    return {"color": "0.25" if dark else colour, "linewidth": 7.0 if body.rigid else 4.0}


def _corners(structures: Sequence[Structure], plant: str) -> NDArray[np.float64]:
    """The corners of all motions of a plant [m] with a margin, wider below where words stand."""
    every = np.vstack([s.corners for s in structures if s.line.plan.task.plant.name == plant])
    low, high = every.min(axis=0), every.max(axis=0)
    room = 0.08 * float((high - low).max())
    return np.array([low, high]) + room * np.array([[-1.0, -2.5], [1.0, 1.0]])


def _round_below(length: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is no longer."""
    power = 10.0 ** np.floor(np.log10(length))
    return max(float(m * power) for m in (1, 2, 5) if m * power <= length)
