"""Springs of joints and a base that rocks, which bend beside a beam; and measurements of them."""

from __future__ import annotations

from dataclasses import dataclass, field


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
    """A frequency that was measured, and where: positions of the held joints [rad or m].

    Parameters
    ----------
    frequency : float
        [rad/s].
    at : tuple of float
        Positions of the driven joints.
    mode : int
        Which mode it is of: 1 is the slowest.
    damping : float, optional
        Damping ratio of that mode.
    within : float
        By what share the frequency may be wrong, in 95 of 100 cases.
    """

    frequency: float
    at: tuple[float, ...]
    mode: int = field(default=1, metadata={"if_stated": True})
    damping: float | None = field(default=None, metadata={"if_stated": True})
    within: float = field(default=0.005, metadata={"if_stated": True})
