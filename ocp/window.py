"""The time after arrival in which the residual is measured, if nobody says it."""

from __future__ import annotations

import math
from collections.abc import Iterable

from quietarm.models import Plant
from quietarm.models.validation import eigenvalues_at_rest

EQ_11 = 1.0
"""The paper's residual window [s], equation (11)."""
MOST_RADIANS = 4000
"""Of the fastest mode within a window: to resolve more takes too much memory."""


class DefaultWindow(float):
    """A residual window [s] that nobody gave, and that a task works out (`default_window`).

    `dataclasses.replace` hands it on to a task with another plant or target, which works it out
    again. In a file it is a number like any other.
    """

    def __repr__(self) -> str:
        return f"DefaultWindow({float(self)!r})"


def default_window(moves: Iterable[tuple[Plant, float]]) -> DefaultWindow:
    """The residual window [s] of moves, given by plant and target [rad]; the longest of all.

    1 s as in equation (11), or two periods of the slowest mode that oscillates, with the joint held
    at the target, where these are longer. A plant that has a far faster mode as well has fewer, as
    many as can be resolved; of a mode too fast for 1 s the window is shorter.
    """
    longest = EQ_11
    most = math.inf
    # Of the slowest mode: a whole swing also where an error of 50 % makes it slower.
    periods = 2
    # A default is this much shorter than these, for plants whose errors make them faster.
    spare = 2
    for plant, target in moves:
        modes = eigenvalues_at_rest(plant, target)
        swinging = [abs(mode) for mode in modes if mode.imag > 0]
        longest = max([longest, *(periods * math.tau / frequency for frequency in swinging)])
        most = min(most, MOST_RADIANS / max(map(abs, modes)))
    if most < EQ_11:
        return DefaultWindow(most / spare)
    return DefaultWindow(max(EQ_11, min(longest, most / spare)))


def longest_window(moves: Iterable[tuple[Plant, float]]) -> float:
    """The longest residual window [s] that can be resolved for each of these plants and targets."""
    rounding = 1e-9
    fastest = (
        max(map(abs, eigenvalues_at_rest(plant, target)), default=0.0) for plant, target in moves
    )
    return MOST_RADIANS * (1 - rounding) / max(fastest)
