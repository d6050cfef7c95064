"""A floor as a picture, over the plan of six terms."""

from __future__ import annotations

from matplotlib.figure import Figure

from ocp import Floor, Plan
from studies.reports.floor import TERMS
from studies.reports.motion_figure import Line, four_panels


def floor_figure(floor: Floor, plan: Plan | None) -> Figure:
    """The four panels of a floor, over the plan."""
    lines = [Line(floor, f"floor, {floor.energy:.4g} J", "tab:blue")]
    if plan is not None:
        lines.insert(0, Line(plan, f"plan of {TERMS} terms, {plan.energy:.4g} J", "tab:orange"))
    task = floor.task
    return four_panels(
        lines,
        f"{task.plant.name}, {task.start:.4g} to {task.target:.4g} rad in {task.duration:g} s",
    )
