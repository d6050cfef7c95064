"""The base class of joint profiles, theta(t; a), and a member of the family in time."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self, final

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.models import Expression, JointMotion
from quietarm.models.final import refuse_overridden
from quietarm.ocp.checks import finite, numbers, positive, whole
from quietarm.ocp.profiles.differentiate import Slopes, differentiate

Values = Sequence[Expression]
"""The coefficients."""


class JointProfile(ABC):
    """A family of joint motions from start to target, one for every vector of coefficients.

    A new family is a frozen dataclass with a `size` and an `angle`; speed, acceleration and jerk
    are CasADi's derivatives. `derivatives` may give formulas that are faster, which are checked
    against CasADi's. `motion` and `path` are final: what they return is what was checked.

    Raises
    ------
    TypeError
        When a subclass overrides `motion` or `path`.
    """

    example: ClassVar[str] = "a profile, such as CycloidPolynomial(6) or CycloidSpline(12)"
    """What to give where something else was given."""
    name: ClassVar[str]
    """The name by which files know the family."""
    term: ClassVar[str] = "coefficient"
    """What there is more of in a larger profile."""
    default_bound: ClassVar[float | None] = None
    """Bound of a search where the user gives none; None where one must be given."""
    sharp: ClassVar[bool] = False
    """Whether a motion may turn within a hundredth of the move without a break."""
    steps_of_a_piece: ClassVar[int] = 6
    """Steps that resolve the motion between two of its `breaks`."""
    energy_agreement: ClassVar[float] = 0.0
    """Share by which the energy of a plan's steps may differ from CVODES' before these are doubled,
    where that is more than any plan's."""
    unbounded_spread: ClassVar[float] = 0.2
    """Random starts lie within this of the plain cycloid where the coefficients have no bound."""
    random_starts: ClassVar[int] = 1
    """The gradient's random starts for each that is asked for, several where minima are many."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        refuse_overridden(cls, JointProfile, "angle, or derivatives")

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of coefficients of the profile."""

    @property
    def amount(self) -> str:
        """Size of the profile in words, such as 6 coefficients."""
        return f"{self.size} {self.term}{'s' if self.size != 1 else ''}"

    def steps_between_breaks(self, steps: int) -> int:
        """Return how many steps of the move lie between its two nearest `breaks`."""
        del steps
        return self.steps_of_a_piece

    @property
    def label(self) -> str:
        """Name of the profile with its size, for messages."""
        return f"{self.name} of {self.amount}"

    def refuse_no_choice(self) -> None:
        """Refuse a profile that has a single motion, and so nothing to choose."""
        if self.size == 0:
            raise ValueError(
                f"the {self.label} has one motion for a move, and nothing to choose; give a "
                "profile with coefficients"
            )

    @property
    def least_duration(self) -> float:
        """The shortest duration for which the profile has a motion [s]; 0 where any will do."""
        return 0.0

    @property
    def plain(self) -> NDArray[np.float64]:
        """Coefficients of the first start, shape (size,), a motion like the plain cycloid."""
        return np.zeros(self.size)

    def box(self, bound: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Least and largest coefficients, each of shape (size,), infinite without a bound.

        `bound` is the largest absolute value, of the kind of coefficients that it makes sense for.
        """
        largest = np.full(self.size, np.inf if bound is None else bound)
        return -largest, largest

    def start_box(self, bound: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the bounds of the gradient's random starts, like `box` but finite."""
        return self.box(self.unbounded_spread if bound is None else bound)

    @property
    def shortest_part(self) -> float:
        """Share of the move within which its acceleration may turn; 1 where it takes longer."""
        return 1.0

    def breaks(self, duration: float) -> tuple[float, ...]:
        """Fractions of the duration, rising between 0 and 1, at which the motion is not smooth."""
        return ()

    @abstractmethod
    def angle(self, coefficients: Values, fraction: Expression) -> Expression:
        """Share of the way that the joint has gone, computed element by element.

        Parameters
        ----------
        coefficients : sequence of Expression
            `size` coefficients.
        fraction : Expression
            t / duration, between 0 and 1.

        Returns
        -------
        Expression
            0 at the fraction 0 and 1 at the fraction 1, with no slope at both. Where it is linear
            in the coefficients, the gradient is several times cheaper.
        """

    def derivatives(self, coefficients: Values, fraction: Expression) -> Slopes:
        """The angle, and its first two derivatives by the fraction; CasADi's by default."""
        share, rate, bend = differentiate(
            lambda at: [self.angle(coefficients, at)], fraction, coefficients, order=2
        )
        return share, rate, bend

    def table(self, fractions: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """The share of the way and its first three derivatives, if linear in the coefficients.

        Shape (1 + size, 4, fractions): of no coefficients, and what a unit of each adds. None where
        there are no numbers for it, or none that save anything.
        """
        del fractions
        return None

    def motion_of(
        self,
        derivatives: Slopes,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> JointMotion:
        """The joint from start to target [rad] in the duration [s], by what `derivatives` gives."""
        share, rate, bend = derivatives
        span = target - start
        return JointMotion(
            start + span * share,
            span * rate / duration,
            span * bend / duration**2,
        )

    def at_duration(self, duration: Expression) -> Self:
        """The profile in a move that takes so long [s], where its angle depends on that."""
        return self

    @final
    def motion(
        self,
        coefficients: Values,
        fraction: Expression,
        *move: Expression,
        jerk: bool = False,
    ) -> JointMotion:
        """Angle, speed and acceleration of the joint, and its jerk where it is asked for.

        The move is start, target and duration.
        """
        start, target, duration = move
        profile = self.at_duration(duration)

        def without_jerk(at: Expression) -> JointMotion:
            derivatives = profile.derivatives(coefficients, at)
            return profile.motion_of(derivatives, start, target, duration)

        if not jerk:
            return without_jerk(fraction)
        angle, speed, acceleration, rate = differentiate(
            lambda at: without_jerk(at)[:3], fraction, [*coefficients, *move], order=1
        )
        return JointMotion(angle, speed, acceleration, rate / duration)

    @final
    def path(
        self, coefficients: ArrayLike, start: float, target: float, duration: float
    ) -> JointPath:
        """One member of the family, from start to target [rad] in the duration [s].

        ValueError where `checked` refuses the coefficients or the duration.
        """
        begin, end = finite("start", start), finite("target", target)
        lasting = positive("duration", duration, "s")
        return JointPath(self, self.checked(coefficients, lasting), begin, end, lasting)

    def checked(self, coefficients: ArrayLike, duration: float | None = None) -> tuple[float, ...]:
        """The coefficients as a tuple of `size` finite floats; ValueError otherwise.

        ValueError, too, where a duration [s] is given that is below `least_duration`.
        """
        if duration is not None and duration < self.least_duration:
            raise ValueError(
                f"duration is {duration:g} s, too short for the {self.label}; give "
                f"{math.ceil(1e4 * self.least_duration) / 1e4:g} s or more"
            )
        counted = f"{self.size} number{'s' if self.size != 1 else ''}"
        values = np.atleast_1d(numbers("coefficients", coefficients, counted, infinite=True))
        if values.shape != (self.size,):
            raise ValueError(
                f"got {values.size} coefficients for a profile of {self.size}; give {counted}"
            )
        for i in np.flatnonzero(~np.isfinite(values)):
            finite(f"coefficient {i + 1}", values[i])
        return tuple(values.tolist())


@dataclass(frozen=True)
class JointPath:
    """One joint motion as a function of time; at rest at the ends before and after the move.

    Attributes
    ----------
    start, target, duration : float
        Joint angles at the ends [rad], and travelling time [s].
    """

    profile: JointProfile
    coefficients: tuple[float, ...]
    start: float
    target: float
    duration: float

    @interruptible
    def __call__(self, time: ArrayLike, order: int = 0) -> NDArray[np.float64]:
        """The angle [rad], or its derivative of an order up to 3 [rad/s^order].

        Times [s] have any shape, as has what is returned.
        """
        if whole("derivative order", order, 0) not in range(4):
            raise ValueError(f"derivative order is {order!r}; give 0, 1, 2 or 3")
        t = numbers("times", time, "numbers in s")
        fraction: Any = ca.DM(np.clip(t.ravel() / self.duration, 0.0, 1.0))
        arguments = self.coefficients, fraction, self.start, self.target, self.duration
        motion = self.profile.motion(*arguments, jerk=order == 3)
        values = motion[order].full().reshape(t.shape)
        outside = (t < 0) | (t > self.duration)
        return np.where(outside, 0.0, values) if order else values
