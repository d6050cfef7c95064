"""A floor as a picture, over the plan of six terms."""

from __future__ import annotations

from matplotlib.figure import Figure

from ocp import Floor, Plan
from studies.display.words import plant_words
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
        f"{plant_words(task.plant)}, {task.start:.4g} to {task.target:.4g} rad "
        f"in {task.duration:g} s",
    )
