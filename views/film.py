"""Films of motions: structures side by side above, curves with a cursor below, by matplotlib."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray
from PIL import Image

from quietarm.interrupts import interruptible
from quietarm.ocp import Plan
from quietarm.ocp.checks import positive, whole
from quietarm.ocp.files import unwritable, write_whole
from quietarm.views.film_settings import FRAMES, WIDTHS
from quietarm.views.pictures.axes import TITLE, legend_of, new_figure
from quietarm.views.pictures.grammar import AFTER_ARRIVAL, FAINT, GREY, INK, PALE
from quietarm.views.pictures.motion import Motions, draw_briefly, lines_of
from quietarm.views.pictures.space import Camera, Room
from quietarm.views.pictures.space_drawing import Update, draw_in_space
from quietarm.views.pictures.structure import Structure, structures_of
from quietarm.views.report.saving import as_written
from quietarm.views.report.words import (
    move_of,
    moved,
    raised,
    scenarios_words,
    title_of_picture,
    window_words,
)

_COLUMNS = 2
"""Panels in a row: beside a third the letters would be too small for a phone."""
_PANEL = 2.7
_HIGH = 2.1
_HIGH_IN_SPACE = 2.7
_CURVES_HIGH = 1.6
_LINE = 0.2
_LETTERS = 11.5
"""Width and height of a panel, heights of curves and of a line [inch]; letters an inch.

A film of two panels is 5.4 inch wide: on a phone of 390 pixels a letter of 10 points is 9 high.
"""
_IN_LEGEND = 3
"""Entries in a row of the legend."""
_SMALL = 10
"""Points of the letters at axes."""
_THIN = 0.8
_DISC = 1e-5
"""Of the widths of parts; a part as small as this [m] is a disc."""
_COLOURS = 128


@dataclass(frozen=True, eq=False)
class Film:
    """An animation of motions in the same time; a notebook shows it as the last line of a cell."""

    structures: Sequence[Structure]
    end: float
    speed: float
    rate: float
    width: int

    @property
    def frames(self) -> int:
        """Number of pictures."""
        return len(self.structures[0].times)

    @property
    def seconds(self) -> float:
        """Playing time of the film [s]."""
        return self.frames / self.rate

    @interruptible
    def save(
        self, path: str | Path, report: Callable[[int, int], object] = lambda done, total: None
    ) -> None:
        """Write a film as gif or mp4 (by the program ffmpeg), whole or not at all.

        ValueError where the name ends in something else, or there is no ffmpeg.
        """
        name = Path(path).suffix.lower().removeprefix(".")
        if name not in _WRITERS:
            raise ValueError(f"{path} is no film; end its name in .gif or .mp4")
        write_whole(path, self.content(name, report))

    def content(self, name: str, report: Callable[[int, int], object]) -> bytes:
        """Return the content of a gif or mp4 file; ValueError if ffmpeg is missing for an mp4."""
        if name == "mp4" and not FFMpegWriter.isAvailable():
            raise ValueError(
                "an mp4 needs the program ffmpeg, which is not found here; install it, or make a "
                "gif"
            )
        figure, update = _draw(self)
        writer = _WRITERS[name](fps=self.rate)
        try:
            with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
                place = Path(folder) / f"film.{name}"
                with writer.saving(figure, str(place), figure.dpi):
                    for k in range(self.frames):
                        update(k)
                        writer.grab_frame()
                        report(k + 1, self.frames)
                return place.read_bytes()
        except OSError as error:
            raise unwritable(Path(tempfile.gettempdir()) / f"film.{name}", error) from error

    def _repr_html_(self) -> str:
        """Return the film for a notebook: a gif, so that it needs no server."""
        content = base64.b64encode(self.content("gif", lambda done, total: None)).decode()
        return f'<img alt="structures in motion" src="data:image/gif;base64,{content}"/>'


def animate(
    motions: Motions,
    *,
    deflection_scale: float | None = None,
    speed: float = 1.0,
    rate: float = FRAMES,
    width: int = 800,
) -> Film:
    """Animate structures side by side in the same time.

    Every link bends in the shape of its mode (`Plant.structure`); dashed is the rigid link. After
    arrival the path of the tips is drawn. Below are the tip displacements and the power, with a
    cursor. The film ends with the last residual window, or in it where it would have
    too many frames.

    Parameters
    ----------
    motions : sequence of Line, Plan or Floor
        The motions, of any plants and durations, 6 at most; a plan alone is drawn beside the plain
        cycloid of its task.
    deflection_scale : float, optional
        Scale of the deflections, which is stated in the picture; by default such that the largest
        is up to a fifth of the structure, but at least 1.
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
    least_a_second = 1
    most_a_second = 50
    # of a frame: one that is this close to the end belongs to it
    rounding = 1e-6
    # more could not be seen side by side, or would take minutes
    most_motions = 6
    most_frames = 500
    lines = lines_of(motions)
    whole("number of motions", len(lines), 1, most_motions, "more are too small side by side")
    width = whole("width", width, *WIDTHS, "more pixels make a huge file")
    if deflection_scale is not None:
        positive("deflection scale", deflection_scale)
    tasks = [line.plan.task for line in lines]
    end = max(task.duration + task.residual_window for task in tasks)
    a_second = rate / positive("speed", speed)
    frames = end * a_second
    if max(task.duration for task in tasks) * a_second < most_frames < frames:
        frames = float(most_frames)
        end = frames / a_second
    if not least_a_second <= rate <= most_a_second or frames > most_frames:
        raise ValueError(
            f"{end:g} s at {rate:g} frames per second and speed {speed:g} make {frames:.0f} "
            f"frames, where {most_frames} are the most, and {least_a_second} to {most_a_second} "
            "per second what browsers show; give another rate or speed"
        )
    times = np.arange(float(int(frames + rounding) + 1)) * speed / rate
    return Film(structures_of(lines, times, end, deflection_scale), end, speed, rate, width)


class _GifWriter(PillowWriter):
    """Frames share the colours of the last one, undithered: a tenth of the size."""

    _frames: list[Image.Image]

    def finish(self) -> None:
        """Write the file, unless there is no frame yet, as after Ctrl-C."""
        if not self._frames:
            return
        last = self._frames[-1]
        none = Image.Dither.NONE
        palette = last.quantize(_COLOURS, dither=none)
        self._frames = [frame.quantize(palette=palette, dither=none) for frame in self._frames]
        super().finish()


_WRITERS: Mapping[str, Callable[..., AbstractMovieWriter]] = {
    "gif": _GifWriter,
    "mp4": FFMpegWriter,
}


def _draw(film: Film) -> tuple[Figure, Callable[[int], Any]]:
    """The figure, laid out, and what brings it to a frame."""
    curves = ("deflection", "power")
    structures = film.structures
    times = film.structures[0].times
    columns = min(len(structures), _COLUMNS)
    rows = -(-len(structures) // columns)
    inches = _PANEL * _COLUMNS
    same = len({structure.line.plan.task for structure in structures}) == 1
    titles = [_title(structure, same, int(_LETTERS * inches / columns)) for structure in structures]
    heading = wrap(_heading(structures[0], same), int(_LETTERS * inches) - 16)  # beside the clock
    in_space = any(structure.line.plan.task.plant.in_space for structure in structures)
    high = _HIGH_IN_SPACE if in_space else _HIGH
    above = _LINE * len(heading) + rows * (high + _LINE * max(map(len, titles)))
    below_high = _CURVES_HIGH + 2 * _LINE
    figure = new_figure(inches, above + below_high)
    figure.set_dpi(film.width / inches)
    figure.suptitle("\n".join(heading), x=0.01, ha="left", fontsize=10)
    clock = figure.text(0.99, 0.99, "", ha="right", va="top", fontsize=10)
    at_speed = f", speed x {film.speed:g}" if film.speed != 1 else ""
    updates: list[Update] = [lambda k: clock.set_text(f"t = {times[k]:.2f} s{at_speed}")]
    subfigures: Any = figure.subfigures(2, 1, height_ratios=[above, _CURVES_HIGH])
    upper, lower = subfigures
    panels = list(upper.subplots(rows, columns, squeeze=False).flat)
    for spare in panels[len(structures) :]:
        spare.axis("off")
    for structure, title, ax in zip(structures, titles, panels):
        ax.set_title("\n".join(title), **TITLE)
        plant = structure.line.plan.task.plant
        if plant.in_space:
            alike = [other for other in structures if other.line.plan.task.plant == plant]
            updates += draw_in_space(ax, structure, Camera(Room.of(alike), plant.seen_from))
            continue
        name = plant.name
        for drawn in structures:
            if drawn.line.plan.task.plant.name == name:
                ax.update_datalim(drawn.corners)
        updates += _draw_structure(ax, structure)
    below = list(lower.subplots(1, len(curves)))
    for ax, quantity in zip(below, curves):
        draw_briefly([structure.line for structure in structures], quantity, ax)
        ax.set_xlim(0.0, film.end)
        ax.tick_params(labelsize=_SMALL)
        cursor = ax.axvline(0.0, color=INK, linewidth=1.2)
        updates.append(lambda k, cursor=cursor: cursor.set_xdata([times[k], times[k]]))
    _explain(figure, structures, below)
    with as_written(figure):
        figure.draw_without_rendering()
    figure.set_layout_engine(None)  # any, even one that does nothing, draws every frame twice
    return figure, lambda k: [update(k) for update in updates]


def _heading(structure: Structure, same: bool) -> str:
    """Return the heading above all panels: the move, if it is one, and its residual's window."""
    if not same:
        return "several moves on one clock"
    task = structure.line.plan.task
    return raised(f"{title_of_picture(task)}; residual {window_words(task.residual_window)}")


def _title(structure: Structure, same: bool, room: int) -> list[str]:
    """The lines above a panel."""
    plan = structure.line.plan
    task = structure.line.plan.task
    worst = plan.worst if isinstance(plan, Plan) else None  # a floor's task is certain
    residual = scenarios_words(plan.residual, worst, task)
    residual = "at rest" if residual == "rest" else residual
    lines = [
        f"{structure.line.label}, {structure.scale_words}",
        *([] if same else [f"{moved(task)}, {move_of(task)}"]),
        f"{plan.energy:.3g} J, residual: {residual}",
    ]
    return [part for line in lines for part in wrap(line, room)]


def _explain(figure: Figure, structures: Sequence[Structure], below: Sequence[Axes]) -> None:
    """Add a legend of all lines, below all panels, and what the squares of a floor are."""
    handles, labels = legend_of(below)
    handles.append(Line2D([], [], color=GREY, linewidth=1.0, linestyle="--"))
    labels.append("without bending")
    handles.append(Line2D([], [], color=GREY, linewidth=2.0, alpha=AFTER_ARRIVAL))
    in_space = [one for one in structures if one.line.plan.task.plant.in_space]
    labels.append("way of the tip" if in_space else "way of the tip after arrival")
    if in_space:
        handles.append(Patch(facecolor=INK))
        labels.append("robot")
    if any(structure.on_support for structure in in_space):
        handles.append(Patch(facecolor=FAINT))
        labels.append("support")
    for words in {Room.of([one]).square_words for one in in_space}:
        handles.append(Patch(facecolor=PALE))
        labels.append(words)
    figure.legend(
        handles, labels, loc="outside lower left", ncols=_IN_LEGEND, fontsize=_SMALL, frameon=False,
        columnspacing=1.0, handlelength=1.6, borderaxespad=0.2,
    )  # fmt: skip


def _draw_structure(ax: Axes, structure: Structure) -> Iterator[Update]:
    """Set up a structure's panel, in metres; what brings its parts to a frame."""
    ax.tick_params(labelsize=_SMALL)
    ax.autoscale_view()
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("x [m]", fontsize=_SMALL)
    ax.set_ylabel("y [m]", fontsize=_SMALL)

    def part(points: Sequence[NDArray[np.float64]] | NDArray[np.float64], **look: Any) -> Update:
        (artist,) = ax.plot([], [], solid_capstyle="round", **look)
        return lambda k: artist.set_data(*points[k].T)

    for points, *_ in structure.unbent:
        yield part(points, color=GREY, linewidth=1.0, linestyle="--")
    begun = int(np.searchsorted(structure.times, structure.trail_begins))
    for path in structure.paths:
        trail = [path[begun : k + 1] for k in range(len(path))]
        yield part(trail, color=structure.line.colour, linewidth=2.0, alpha=AFTER_ARRIVAL)
    for points, colour, width, *_ in structure.bent:
        disc = np.ptp(points[0], axis=0).max() < _DISC
        yield part(points, color=colour, linewidth=_THIN * width, marker="o" if disc else "",
                   markersize=_THIN * width)  # fmt: skip
