"""A plan on the screen, and the lines that it shares with a floor."""

from __future__ import annotations

import math

from rich.console import Console
from rich.table import Table

from ocp import Motion, Plan, PointToPoint, ShapedCycloid
from ocp.task.point_to_point import LIMITS
from studies.display.words import millimetres


def print_plan(console: Console, plan: Plan) -> None:
    """Print a plan's coefficients, figures and verification.

    Parameters
    ----------
    console : rich.console.Console
        Where to.
    plan : Plan
        The plan.
    """
    motion, check = plan.motion, plan.verification
    table = upright_table()
    add_move(table, plan.task, motion)
    table.add_row(*_choice(plan))
    table.add_row("energy F2", f"{motion.energy:.6g} J  (net work {motion.net_work:.4g} J)")
    add_figures(table, plan.task, motion)
    table.add_row("status", plan.status.text)
    relative = abs(check.energy_difference) / motion.energy if motion.energy else 0.0
    table.add_row(
        "verified",
        f"by CVODES: {check.steps} fixed steps differ by {relative:.0e} in energy and "
        f"{millimetres(abs(check.residual_difference))} in residual",
    )
    table.add_row("time", f"{plan.provenance.seconds:.2f} s")
    console.print(table, highlight=False)


def upright_table() -> Table:
    """A table of names and their values."""
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(style="bold")
    table.add_column()
    return table


def add_move(table: Table, task: PointToPoint, motion: Motion) -> None:
    """Add the move and its limits, and where the motion breaks one."""
    table.add_row(
        "move",
        f"{task.plant.name}, {_angle(task.start)} to {_angle(task.target)} in {task.duration:g} s",
    )
    limits = ", ".join(
        f"{name} {_quantity(name, value)}{_broken(name, motion.peak(name), value)}"
        for name, value in task.limits.items()
    )
    if limits:
        table.add_row("limits", limits)


def add_figures(table: Table, task: PointToPoint, motion: Motion) -> None:
    """Add a motion's residual, peaks and overshoot."""
    table.add_row(
        "residual F1",
        f"{millimetres(motion.residual)} at the {_tip(task)} within {task.residual_window:g} s",
    )
    table.add_row("peak torque", f"{motion.peak_torque:.4g} N m")
    table.add_row("peak speed", f"{motion.peak_speed:.4g} rad/s")
    table.add_row("peak acceleration", f"{motion.peak_acceleration:.4g} rad/s^2")
    table.add_row("peak deflection", millimetres(motion.peak_deflection))
    table.add_row("overshoot", f"{motion.overshoot:.3g} rad" if motion.overshoot else "none")


def _choice(plan: Plan) -> tuple[str, str]:
    """What tells the motion from others of its task, and its name."""
    if isinstance(plan.profile, ShapedCycloid):
        impulses = len(plan.profile.impulses.times)
        shaper = f"{impulses} impulses within {plan.profile.length:.4g} s"
        return "profile", f"{plan.profile.label}: {shaper}"
    coefficients = ", ".join(f"{value:.6g}" for value in plan.coefficients)
    return "coefficients", coefficients or "none: the plain cycloid"


def _tip(task: PointToPoint) -> str:
    tips = task.plant.tips
    return "tip" if tips == 1 else f"worst of {tips} tips"


def _angle(value: float) -> str:
    return f"{math.degrees(value):.6g}deg"


def _quantity(name: str, value: float) -> str:
    return f"{value:g} {LIMITS[f'{name}_limit']}"


def _broken(name: str, peak: float, limit: float) -> str:
    """How a limit is broken; nothing where it is kept to the README's tolerance."""
    return "" if peak <= limit * 1.001 else f" (broken: {peak:.4g} {LIMITS[f'{name}_limit']})"
