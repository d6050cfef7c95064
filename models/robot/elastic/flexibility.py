"""Springs of joints and a base that rocks, which bend beside a beam; and measurements of them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Spring:
    """Stiffness [N m/rad] and damping [N m s/rad] of a passive joint, or N/m and N s/m."""

    stiffness: float
    damping: float = 0.0


@dataclass(frozen=True)
class Base:
    """A pedestal that rocks about x and y of the root link, at a height below it [m].

    Stiffness [N m/rad] and damping [N m s/rad] about these axes; a third about z, by which it
    twists.
    """

    stiffness: tuple[float, ...]
    damping: tuple[float, ...] = (0.0, 0.0)
    height: float = 0.0


@dataclass(frozen=True)
class Measured:
    """A frequency of the first mode [rad/s], and where it was measured: positions of the joints."""

    frequency: float
    at: tuple[float, ...]
