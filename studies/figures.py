"""Pictures: the paper's four panels."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ocp import Plan, evaluate_coefficients
from ocp.files import write_whole
from studies.picture_names import check_figure

_SAMPLES = 1500


@dataclass(frozen=True)
class Line:
    """One motion in a picture: its plan, label, colour and matplotlib line style."""

    plan: Plan
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
        task = line.plan.task
        end = task.duration + task.residual_window
        times = np.union1d(np.linspace(0.0, end, _SAMPLES), [task.duration])
        sampled = line.plan.trajectory(times)
        tips = sampled.tips * 1e3
        panels = [sampled.joint[:, :1], sampled.joint[:, 1:2], tips, sampled.torque[:, None]]
        for axis, values in zip(axes, panels, strict=True):
            for i in range(values.shape[1]):
                axis.plot(
                    sampled.time,
                    values[:, i],
                    line.style if i == 0 else ":",
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
    for axis in axes[2:]:
        axis.set_xlabel("time [s]  (dashed: arrival)")
    handles, labels = axes[2].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=9, frameon=False)
    if title:
        figure.suptitle(title, fontsize=12)
    return figure


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a picture whole or not at all.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The picture.
    path : str or Path
        The file; its ending, .png, .pdf or .svg, says the format.

    Raises
    ------
    ValueError
        When the file cannot be written or its ending is unknown.
    """
    target = check_figure(path)
    content = io.BytesIO()
    figure.savefig(content, format=target.suffix[1:].lower(), dpi=150)
    write_whole(target, content.getvalue())
