"""The motion of a particle: the constants of its velocity, and what happens at the bounds.

References
----------
.. [1] Parsopoulos and Vrahatis, ACM Symposium on Applied Computing, 2002, pp. 603-607.
.. [2] Clerc and Kennedy, IEEE Transactions on Evolutionary Computation 6(1), 2002, pp. 58-73.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from quietarm.ocp.checks import not_negative, positive

Array = np.ndarray


@dataclass(frozen=True)
class VelocityRule:
    """Constants of the velocity, v <- chi*(w*v + c1*r1*(own best - x) + c2*r2*(next best - x)).

    Parameters
    ----------
    inertia_start, inertia_end : float
        w of the first and of the last move, linear in between.
    constriction, cognitive, social : float
        chi, c1 and c2. ValueError when one is negative or not finite, or chi is zero.
    """

    inertia_start: float
    inertia_end: float
    constriction: float
    cognitive: float
    social: float

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            check = positive if name == "constriction" else not_negative
            object.__setattr__(self, name, check(name, value))


INERTIA_2002 = VelocityRule(1.0, 0.4, 1.0, 0.5, 0.5)
"""Of Parsopoulos and Vrahatis (2002), whose inertia falls; it needs the number of iterations."""
CONSTRICTION = VelocityRule(1.0, 1.0, 0.729, 2.05, 2.05)
"""Of Clerc and Kennedy (2002)."""
PAPER_GROUP = VelocityRule(
    1.0,
    1.0,
    0.73,
    2.05,
    2.05,
)
"""As the paper's group states elsewhere."""


def clip(x: Array, v: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Put each coordinate that leaves the bounds on its bound, with velocity zero."""
    inside = np.clip(x, lower, upper)
    return inside, np.where(inside == x, v, 0.0)


def reflect(x: Array, v: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Mirror each coordinate that leaves the bounds at its bound, with its velocity reversed."""
    mirrored = np.where(
        x < lower,
        2 * lower - x,
        np.where(x > upper, 2 * upper - x, x),
    )
    # a jump of more than the box would leave it on the other side
    return np.clip(mirrored, lower, upper), np.where(mirrored == x, v, -v)


BOUNDARIES = {"clip": clip, "reflect": reflect}
