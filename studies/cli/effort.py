"""Estimate how long a line will take: hours need --yes, and minutes are announced."""

from __future__ import annotations

import click

from quietarm.ocp import JointProfile


def refuse_endless(number: int, what: str, seconds: float, *, yes: bool) -> None:
    """Refuse work of more than ten hours, so many seconds each, unless --yes is typed."""
    hours = number * seconds / 3600
    if hours > 10 and not yes:
        raise ValueError(
            f"{number} {what} take some {hours:.3g} hours on a core; give fewer, or --yes"
        )


def seconds_of_solve(profile: JointProfile) -> float:
    """Return roughly how long a solve takes [s].

    Six coefficients take 0.05 s; the time rises with a power of their number: of the square where
    they enter linearly (28 terms of a polynomial take 1 s), and faster where they do not (31
    coefficients of ten nodes take 18 s, of ten Gaussians 9 s; all by processor time).
    """
    power = 3.5 if profile.sharp else 2.0
    return 0.05 * max(1.0, profile.size / 6) ** power


def announce_minutes(profile: JointProfile) -> None:
    """Say that a plan takes minutes where it has many coefficients; of thirty it takes seconds."""
    if profile.size > 40:
        click.echo(
            f"{profile.size} coefficients: a plan takes minutes; with fewer --terms seconds",
            err=True,
        )
