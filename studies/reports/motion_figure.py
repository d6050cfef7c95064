"""Motions as a picture: the paper's four panels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ocp import Floor, Plan, evaluate_coefficients

_SHOWN, _ABOVE = 0.99, 1.15
"""The torque panel ends at this multiple of the torque that is not exceeded 99 % of the time."""


@dataclass(frozen=True)
class Line:
    """One motion in a picture: its plan or floor, label, colour and matplotlib line style."""

    plan: Plan | Floor
    label: str
    colour: str
    style: str = "-"


def four_panels(lines: Sequence[Line] | Plan, title: str = "") -> Figure:
    """Draw joint angle, angular velocity, tip displacement and motor torque against time.

    Parameters
    ----------
    lines : sequence of Line, or Plan
        The motions, all of one duration; a plan alone is drawn over the plain cycloid of its
        task.
    title : str, optional
        Title of the picture.

    Returns
    -------
    matplotlib.figure.Figure
        The four panels, in the order of the paper's Figs 2 and 5; time goes on through the
        residual window after arrival.

    Raises
    ------
    ValueError
        When there is no motion, or their durations differ.
    """
    if isinstance(lines, Plan):
        cycloid = evaluate_coefficients(lines.task, [])
        lines = [Line(cycloid, "plain cycloid", "0.55"), Line(lines, "this plan", "tab:blue")]
    if len({line.plan.task.duration for line in lines}) != 1:
        raise ValueError("give one motion or more, all of one duration")
    figure = Figure(figsize=(10, 6.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes: list[Axes] = list(figure.subplots(2, 2, sharex=True).flat)
    for line in lines:
        sampled = line.plan.trajectory
        tips = sampled.tips * 1e3
        panels = [sampled.joint[:, :1], sampled.joint[:, 1:2], tips, sampled.torque[:, None]]
        for axis, values in zip(axes, panels, strict=True):
            for i in range(values.shape[1]):
                axis.plot(
                    sampled.time,
                    values[:, i],
                    _style(line.style, i),
                    color=line.colour,
                    linewidth=1.6,
                    label=line.label if values.shape[1] == 1 else f"{line.label}, tip {i + 1}",
                )
    quantities = [
        ("joint angle", "[rad]"),
        ("angular velocity", "[rad/s]"),
        ("tip displacement", "[mm]"),
        ("motor torque", "[N m]"),
    ]
    arrival = lines[0].plan.task.duration
    for letter, axis, (name, unit) in zip("abcd", axes, quantities, strict=True):
        axis.axvline(arrival, color="0.6", linewidth=0.8, linestyle="--")
        axis.set_title(f"({letter}) {name} {unit}", fontsize=10, loc="left")
        axis.grid(alpha=0.25)
        axis.margins(x=0)
    _leave_out_jolts(axes[3], lines)
    for axis in axes[2:]:
        axis.set_xlabel("time [s]  (dashed: arrival)")
    handles, labels = axes[2].get_legend_handles_labels()
    columns = min(3, len(lines))  # of the tips of one motion each, where there are several
    figure.legend(
        handles, labels, loc="outside lower center", ncols=columns, fontsize=9, frameon=False
    )
    if title:
        figure.suptitle(title, fontsize=12)
    return figure


def _style(of_line: str, tip: int) -> str:
    """The line's own style for its first tip, others for its other tips."""
    others = [style for style in (":", "-.", "--") if style != of_line]
    return of_line if tip == 0 else others[(tip - 1) % len(others)]


def _leave_out_jolts(axis: Axes, lines: Sequence[Line]) -> None:
    """Cut off a floor's jolts: for a moment their torque is a thousand times the rest."""
    peaks, usual = [0.0], [0.0]
    for line in lines:
        sampled = line.plan.trajectory
        torque, held = np.abs(sampled.torque), np.gradient(sampled.time)
        order = np.argsort(torque)
        most_of_the_time = np.searchsorted(np.cumsum(held[order]), _SHOWN * held.sum())
        peaks.append(float(torque.max()))
        usual.append(float(torque[order][min(most_of_the_time, len(order) - 1)]))
    highest = _ABOVE * max(usual)
    if max(peaks) > highest and any(isinstance(line.plan, Floor) for line in lines):
        axis.set_ylim(-highest, highest)
        axis.set_title(f"{axis.get_title(loc='left')}, jolts left out", fontsize=10, loc="left")
