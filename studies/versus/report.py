"""A plan and its rivals as a table and a picture."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from matplotlib.figure import Figure
from quietarm.ocp import PointToPoint
from quietarm.studies.display.words import REST, millimetres, move_of, title_of
from quietarm.studies.document.blocks import Bullets, Document, Picture, Text
from quietarm.studies.document.table import Cell, Column, Table
from quietarm.studies.figures.axes import axes_or_new, logarithmic, new_figure
from quietarm.studies.figures.looks import BLUE, RED
from quietarm.studies.versus.rivals import Rival

_OVERRUN = 2e-3
"""A limit that is passed by no more than this share is kept."""


def versus_document(
    task: PointToPoint, found: Sequence[Rival], allowed: float | None = None
) -> Document:
    """A row each, what cannot be and why, and what they leave and take as a picture.

    What the robust plan is `allowed` to leave [m] is said where there is one.
    """
    reasons = {rival.why: [r.name for r in found if r.why == rival.why] for rival in found}
    reasons.pop("", None)
    missing = [f"{'; '.join(names)}: {why}" for why, names in reasons.items()]
    if allowed:
        words = f"may leave {millimetres(allowed)}; --residual-limit asks for less"
        missing.insert(0, f"robust plan: {words}")
    missing += [
        f"{rival.name} breaks: {', '.join(b)}" for rival in found if (b := _broken(task, rival))
    ]
    words = (
        "Residuals and peaks are by CVODES on the assumed plant; worst is the largest residual in "
        "the range of the errors. All take the whole duration: what a shaper moves is shorter by "
        "the shaper. Ruckig keeps limits of speed, acceleration and jerk; cycloids keep none."
    )
    return Document(
        f"Against what is used today: {title_of(task)}",
        [
            _table(task, found, shown=True).turned(),
            Bullets(missing, soft=True),
            Text(words, soft=True),
            Picture("versus.png", partial(_picture, task, found), "Residual and energy"),
        ],
        {"versus": _table(task, found, shown=False)},
    )


def _table(task: PointToPoint, found: Sequence[Rival], shown: bool) -> Table:
    columns = [
        Column("motion"),
        Column("leaves [mm]", "{:.3g}".format, "residual_mm"),
        *([Column("worst [mm]", "{:.3g}".format, "worst_mm")] if task.ranges else []),
        Column("energy [J]", "{:.4f}".format, "energy_J"),
        Column("torque [N m]", "{:.3g}".format, "peak_torque_Nm"),
        Column("accel. [1/s^2]", "{:.3g}".format, "peak_acceleration_rad_s2"),
        *([] if shown else [Column("breaks")]),
    ]
    rows: list[list[Cell]] = []
    for rival in found:
        motion = rival.motion
        if motion is None:
            continue
        left: Cell = "rest" if shown and motion.residual < REST else 1e3 * motion.residual
        worst = [] if rival.worst is None else [1e3 * rival.worst]
        peaks = [motion.energy, motion.peak_torque, motion.peak_acceleration]
        broken = [] if shown else [", ".join(_broken(task, rival)) or None]
        cells = [rival.name, left, *worst, *peaks, *broken]
        texts = [column.text(cell) for column, cell in zip(columns, cells, strict=True)]
        rows.append([*texts] if shown else cells)
    return Table("", columns, rows)


def _broken(task: PointToPoint, rival: Rival) -> list[str]:
    """The limits that a motion breaks."""
    return [] if rival.motion is None else list(rival.motion.exceeded(task.limits, _OVERRUN))


def _picture(task: PointToPoint, found: Sequence[Rival]) -> Figure:
    """Energy against the residual, as planned and at worst."""
    figure = new_figure(8, 5.4)
    ax = axes_or_new(figure.subplots())
    for rival in found:
        if rival.motion is None:
            continue
        energy, planned = rival.motion.energy, 1e3 * max(rival.motion.residual, REST)
        worst = planned if rival.worst is None else 1e3 * max(rival.worst, REST)
        colour = RED if "plan" in rival.name and "plain" not in rival.name else BLUE
        ax.plot([planned, worst], [energy] * 2, color=colour, linewidth=1)
        ax.plot(planned, energy, "o", color=colour, markersize=5, fillstyle="none")
        ax.plot(worst, energy, "o", color=colour, markersize=5)
        ax.annotate(f" {rival.name}", (worst, energy), va="center", fontsize=8)
    logarithmic(ax, 1 / REST)
    ax.margins(x=0.18)
    ends = "open: as planned, filled: at worst" if task.ranges else "as planned"
    ax.set(xlabel=f"residual F1 [mm] ({ends})", ylabel="energy F2 [J]")
    figure.suptitle(f"{task.plant.name}, {move_of(task)}", fontsize=11)
    return figure
