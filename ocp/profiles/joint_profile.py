"""What every joint profile is: theta(t; a) and its time derivatives; one member as a path."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral
from typing import Any, ClassVar

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from models import Expression, JointMotion


class JointProfile(ABC):
    """A family of joint motions from start to target, one for every vector of coefficients.

    A new family is one subclass, a frozen dataclass: it says how many coefficients it has and gives
    theta and its first three time derivatives, in operations that work element by element.
    """

    name: ClassVar[str]
    """The name by which files know the family."""

    _known: ClassVar[dict[str, type[JointProfile]]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if isinstance(cls.__dict__.get("name"), str):
            JointProfile._known[cls.name] = cls

    @property
    @abstractmethod
    def size(self) -> int:
        """How many coefficients the profile has."""

    @abstractmethod
    def derivatives(
        self,
        coefficients: Sequence[Expression],
        fraction: Expression,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> tuple[Expression, Expression, Expression, Expression]:
        """Joint angle and its first three time derivatives.

        Parameters
        ----------
        coefficients : sequence of Expression
            `size` coefficients.
        fraction : Expression
            t / duration, between 0 and 1.
        start, target : Expression
            Joint angles at the ends [rad].
        duration : Expression
            Travelling time [s].

        Returns
        -------
        tuple of Expression
            theta [rad], theta' [rad/s], theta'' [rad/s^2], theta''' [rad/s^3].
        """

    def inner(
        self,
        coefficients: Sequence[Expression],
        fraction: Expression,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> Sequence[Expression]:
        """What the coefficients enter: `outer` makes the joint's motion of these three values.

        A profile whose coefficients enter linearly somewhere on the way to the joint says so by
        these two methods; the gradient is then several times cheaper. By default it is the motion
        itself. Arguments as in `derivatives`.
        """
        return self.derivatives(coefficients, fraction, start, target, duration)[:3]

    def outer(
        self,
        inner: Sequence[Expression],
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> JointMotion:
        """Angle, speed and acceleration of the joint from the values of `inner`."""
        del start, target, duration
        return JointMotion(*inner)

    def motion(
        self,
        coefficients: Sequence[Expression],
        fraction: Expression,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> JointMotion:
        """Angle, speed and acceleration of the joint; arguments as in `derivatives`."""
        return JointMotion(*self.derivatives(coefficients, fraction, start, target, duration)[:3])

    def path(
        self, coefficients: ArrayLike, start: float, target: float, duration: float
    ) -> JointPath:
        """One member of the family, as a callable of time and derivative order.

        Parameters
        ----------
        coefficients : array_like, shape (size,)
            The coefficients.
        start, target : float
            Joint angles at the ends [rad].
        duration : float
            Travelling time [s].

        Returns
        -------
        JointPath
            The callable.

        Raises
        ------
        ValueError
            When a coefficient is missing, superfluous or not finite.
        """
        return JointPath(self, self.checked(coefficients), start, target, duration)

    def checked(self, coefficients: ArrayLike) -> tuple[float, ...]:
        """The coefficients as a tuple of `size` finite floats; ValueError otherwise."""
        try:
            values = np.atleast_1d(np.asarray(coefficients, dtype=float))
        except (TypeError, ValueError, OverflowError):
            raise ValueError(
                f"coefficients are {coefficients!r}; give {self.size} numbers"
            ) from None
        if values.shape != (self.size,):
            raise ValueError(
                f"got {values.size} coefficients for a profile of {self.size}; "
                f"give {self.size} numbers"
            )
        if not np.all(np.isfinite(values)):
            bad = int(np.flatnonzero(~np.isfinite(values))[0])
            raise ValueError(f"coefficient {bad + 1} is {values[bad]}; give a finite number")
        return tuple(float(value) for value in values)


def known_profiles() -> dict[str, type[JointProfile]]:
    """The families that can be found by name, those of the user's own files included."""
    return dict(JointProfile._known)


@dataclass(frozen=True)
class JointPath:
    """One joint motion as a function of time; at rest at the ends before and after the move.

    Attributes
    ----------
    profile : JointProfile
        The family.
    coefficients : tuple of float
        Its member.
    start, target : float
        Joint angles at the ends [rad].
    duration : float
        Travelling time [s].
    """

    profile: JointProfile
    coefficients: tuple[float, ...]
    start: float
    target: float
    duration: float

    def __call__(self, time: ArrayLike, order: int = 0) -> NDArray[np.float64]:
        """Evaluate the path.

        Parameters
        ----------
        time : array_like
            Times [s], any shape.
        order : int
            Derivative order, 0 (angle) to 3 (jerk).

        Returns
        -------
        ndarray
            theta [rad] or its derivative [rad/s^order], in the shape of `time`.

        Raises
        ------
        ValueError
            When `order` is not 0, 1, 2 or 3, or a time is not finite.
        """
        if isinstance(order, bool) or not isinstance(order, Integral) or not 0 <= order <= 3:
            raise ValueError(f"derivative order is {order!r}; give 0, 1, 2 or 3")
        t = np.asarray(time, dtype=float)
        if not np.all(np.isfinite(t)):
            raise ValueError("a time is not finite; give times in seconds")
        fraction: Any = ca.DM(np.clip(t.ravel() / self.duration, 0.0, 1.0))
        values = self.profile.derivatives(
            self.coefficients, fraction, self.start, self.target, self.duration
        )
        result = values[order].full().reshape(t.shape)
        outside = (t < 0) | (t > self.duration)
        return np.where(outside, 0.0, result) if order else result
