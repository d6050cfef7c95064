"""A plan on the screen, and the lines that it shares with a floor."""

from __future__ import annotations

from rich.console import Console

from ocp import Motion, Plan, PointToPoint
from ocp.task.point_to_point import LIMITS
from studies.display.tables import print_rows
from studies.display.words import millimetres, move_of

Row = tuple[str, str]


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
    coefficients = ", ".join(f"{value:.6g}" for value in plan.coefficients)
    relative = abs(check.energy_difference) / motion.energy if motion.energy else 0.0
    rows = [
        *move_rows(plan.task, motion),
        ("coefficients", coefficients or "none: the plain cycloid"),
        ("energy F2", f"{motion.energy:.6g} J  (net work {motion.net_work:.4g} J)"),
        *figure_rows(plan.task, motion),
        ("status", plan.status.text),
        (
            "verified",
            f"by CVODES: {check.steps} fixed steps differ by {relative:.0e} in energy and "
            f"{millimetres(abs(check.residual_difference))} in residual",
        ),
        ("time", f"{plan.provenance.seconds:.2f} s"),
    ]
    print_rows(console, rows)


def move_rows(task: PointToPoint, motion: Motion) -> list[Row]:
    """The move and its limits, and where the motion breaks one."""
    limits = ", ".join(
        f"{name} {_quantity(name, value)}{_broken(name, motion.peak(name), value)}"
        for name, value in task.limits.items()
    )
    return [
        ("move", f"{task.plant.name}, {move_of(task)}"),
        *([("limits", limits)] if limits else []),
    ]


def figure_rows(task: PointToPoint, motion: Motion) -> list[Row]:
    """A motion's residual, peaks and overshoot."""
    return [
        (
            "residual F1",
            f"{millimetres(motion.residual)} at the tip within {task.residual_window:g} s",
        ),
        ("peak torque", f"{motion.peak_torque:.4g} N m"),
        ("peak speed", f"{motion.peak_speed:.4g} rad/s"),
        ("peak acceleration", f"{motion.peak_acceleration:.4g} rad/s^2"),
        ("peak deflection", f"{millimetres(motion.peak_deflection)}{_large(task, motion)}"),
        ("overshoot", f"{motion.overshoot:.3g} rad" if motion.overshoot else "none"),
    ]


def _large(task: PointToPoint, motion: Motion) -> str:
    """A warning where the tip leaves what the plant's equations are made for."""
    limit = task.plant.small_deflection
    if limit is None or max(motion.peak_deflection, motion.residual) <= limit:
        return ""
    return (
        f"  (warning: beyond {millimetres(limit)}, up to which the plant's deflections count as "
        "small; its equations are less exact there)"
    )


def _quantity(name: str, value: float) -> str:
    return f"{value:g} {LIMITS[f'{name}_limit']}"


def _broken(name: str, peak: float, limit: float) -> str:
    """How a limit is broken; nothing where it is kept to the README's tolerance."""
    return "" if peak <= limit * 1.001 else f" (broken: {peak:.4g} {LIMITS[f'{name}_limit']})"
