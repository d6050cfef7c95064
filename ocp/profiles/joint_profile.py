"""The base class of joint profiles, theta(t; a) with its time derivatives, and their one check."""

from __future__ import annotations

import math
import reprlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, final

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.models import Expression, JointMotion
from quietarm.models.compiled import Compiled
from quietarm.models.final import refuse_overridden
from quietarm.ocp.checks import finite, hashable, instance

Values = Sequence[Expression]
"""The coefficients, or what follows from them."""

_START, _TARGET, _DURATION = -0.3, 0.9, 1.3
"""A move [rad, s], none of whose numbers is 0 or 1: a factor that is left out then shows."""
_SHARES = np.array([0.0, 1.0, *np.random.default_rng(0).uniform(0.02, 0.98, 15)])
"""Of the duration: both ends, then anywhere between."""
_DIFFERENT = 1e-6
"""Share of a quantity's largest value by which it may differ from what it has to be."""

UNBOUNDED_SPREAD = 0.2
"""Random starts lie within this of the plain cycloid where the coefficients have no bound."""


class JointProfile(ABC):
    """A family of joint motions from start to target, one for every vector of coefficients.

    A new family is a frozen dataclass with a `size` and `derivatives`; casadi derives the jerk.
    `inner` and `outer` may state the same in two steps. `motion` and `path` follow and are final:
    what they return is what was checked.

    Raises
    ------
    TypeError
        When a subclass overrides `motion` or `path`.
    """

    example: ClassVar[str] = "a profile, as CycloidPolynomial(6) or CycloidSpline(12)"
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
    random_starts: ClassVar[int] = 1
    """The gradient's random starts for each that is asked for, several where minima are many."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        refuse_overridden(cls, JointProfile, "derivatives, or inner and outer together")

    @property
    @abstractmethod
    def size(self) -> int:
        """How many coefficients the profile has."""

    @property
    def amount(self) -> str:
        """How large the profile is, as 6 coefficients."""
        return f"{self.size} {self.term}{'s' if self.size != 1 else ''}"

    @property
    def label(self) -> str:
        """What the profile is called in a message."""
        return f"{self.name} of {self.amount}"

    def refuse_no_choice(self) -> None:
        """ValueError where the profile has a single motion, and so nothing to choose."""
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
        """Where the gradient's random starts lie, as `box`, but finite."""
        return self.box(UNBOUNDED_SPREAD if bound is None else bound)

    @property
    def shortest_part(self) -> float:
        """Share of the move within which its acceleration may turn; 1 where it takes longer."""
        return 1.0

    def breaks(self, duration: float) -> tuple[float, ...]:
        """Fractions of the duration, rising between 0 and 1, at which the motion is not smooth."""
        return ()

    @abstractmethod
    def derivatives(
        self,
        coefficients: Values,
        fraction: Expression,
        start: Expression,
        target: Expression,
        duration: Expression,
        /,
    ) -> Values:
        """Joint angle [rad] and its first two time derivatives, computed element by element.

        Parameters
        ----------
        coefficients : sequence of Expression
            `size` coefficients.
        fraction : Expression
            t / duration, between 0 and 1.
        start, target, duration : Expression
            Joint angles at the ends [rad]; travelling time [s].
        """

    def inner(self, coefficients: Values, fraction: Expression, *move: Expression) -> Values:
        """Values that the coefficients enter; `outer` makes the joint's motion of them.

        Where they are linear in the coefficients, by derivatives that depend on neither these nor
        the move, the gradient is several times cheaper. The move is as in `derivatives`.
        """
        return self.derivatives(coefficients, fraction, *move)[:3]

    def outer(self, inner: Values, *move: Expression) -> JointMotion:
        """Angle, speed and acceleration of the joint from the values of `inner`."""
        return JointMotion(*inner)

    @final
    def motion(
        self, coefficients: Values, fraction: Expression, *move: Expression, jerk: bool = False
    ) -> JointMotion:
        """Angle, speed and acceleration of the joint, and its jerk where it is asked for."""
        if not jerk:
            return JointMotion(*self.derivatives(coefficients, fraction, *move)[:3])
        # casadi differentiates by symbols only: the fraction is one first, replaced afterwards
        kinds = {type(one) for one in (*coefficients, fraction, *move)}
        kind: Any = ca.SX if ca.SX in kinds else ca.MX
        place = kind(fraction)
        at, ones = kind.sym("t", *place.shape), kind.ones(*place.shape)
        values = [kind(value) for value in self.derivatives(coefficients, at, *move)[:3]]
        rate = ca.jtimes(values[2], at, ones) * ones / move[-1]
        motion: Any = ca.substitute([*values, rate], [at], [place])
        return JointMotion(*(motion if kinds & {ca.SX, ca.MX} else map(ca.evalf, motion)))

    @final
    def path(
        self, coefficients: ArrayLike, start: float, target: float, duration: float
    ) -> JointPath:
        """One member of the family, from start to target [rad] in the duration [s].

        ValueError where `checked` refuses the coefficients or the duration.
        """
        return JointPath(self, self.checked(coefficients, duration), start, target, duration)

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
        try:
            values = np.atleast_1d(np.asarray(coefficients, dtype=float))
        except (TypeError, ValueError):
            raise ValueError(
                f"coefficients are {reprlib.repr(coefficients)}; give {counted}"
            ) from None
        if values.shape != (self.size,):
            raise ValueError(
                f"got {values.size} coefficients for a profile of {self.size}; give {counted}"
            )
        return tuple(finite(f"coefficient {i}", value) for i, value in enumerate(values, 1))


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

    def __call__(self, time: ArrayLike, order: int = 0) -> NDArray[np.float64]:
        """The angle [rad], or its derivative of an order up to 3 [rad/s^order].

        Times [s] have any shape, as has what is returned.
        """
        if order not in range(4):
            raise ValueError(f"derivative order is {order!r}; give 0, 1, 2 or 3")
        t = np.asarray(time, dtype=float)
        fraction: Any = ca.DM(np.clip(t.ravel() / self.duration, 0.0, 1.0))
        arguments = self.coefficients, fraction, self.start, self.target, self.duration
        motion = self.profile.motion(*arguments, jerk=order == 3)
        values = motion[order].full().reshape(t.shape)
        outside = (t < 0) | (t > self.duration)
        return np.where(outside, 0.0, values) if order else values


def check_profile(profile: JointProfile) -> None:
    """Refuse a profile whose motion is not from rest to rest, or whose derivatives are not.

    The derivatives of the angle are CasADi's, at random coefficients.

    Raises
    ------
    TypeError
        When it is no profile, or one that may change.
    ValueError
        With the value, where it is, and what it has to be.
    """
    instance("profile", profile, JointProfile)
    hashable("profile", profile)
    _check_at_random(profile)


@lru_cache(maxsize=256)
def _check_at_random(profile: JointProfile) -> None:
    within = profile.start_box(profile.default_bound)
    coefficients = np.random.default_rng(1).uniform(*within)
    duration = max(_DURATION, 2 * profile.least_duration)
    table = _compared_values(profile, coefficients, _START, _TARGET, duration)
    _refuse_difference(profile, table, _START, _TARGET)


def check_motion(
    profile: JointProfile, coefficients: ArrayLike, start: float, target: float, duration: float
) -> None:
    """Refuse one motion likewise, at its own coefficients, as every answer's is.

    One that overflows is left to the integrator, which says so.
    """
    table = _compared_values(profile, np.asarray(coefficients, float), start, target, duration)
    if np.isfinite(table).all():
        _refuse_difference(profile, table, start, target)


def _refuse_difference(
    profile: JointProfile, table: NDArray[np.float64], start: float, target: float
) -> None:
    """ValueError where rows of `_compared_values` differ, or are not at rest at the ends."""
    angle, speed, acceleration, angle_rate, speed_rate, *joined = table
    ends = f"its end of a move from {start:.4g} to {target:.4g}"
    compared = [
        ("angle", angle, [start, target], ends),
        ("speed", speed, [0.0, 0.0], "rest at both ends"),
        ("speed", speed, angle_rate, "the derivative of the angle"),
        ("acceleration", acceleration, speed_rate, "the derivative of the speed"),
    ]
    for name, value, other in zip(("angle", "speed", "acceleration"), table[:3], joined):
        compared.append(
            (f"{name} by outer(inner(...))", other, value, f"the {name} of derivatives")
        )
    for name, found, wanted, words in compared:
        allowed = _DIFFERENT * max(float(np.abs(found).max()), 1e-9)
        values = found[: len(wanted)]  # the ends come first
        wrong = ~(np.abs(values - wanted) <= allowed)  # nan is wrong as well
        if wrong.any():
            k = int(wrong.argmax())
            raise ValueError(
                f"profile {profile.name!r}: its {name} is {values[k]:.4g} at {_SHARES[k]:.3g} of "
                f"the duration, where {words} is {wanted[k]:.4g}; check the factors and signs in "
                "derivatives (d/dt is d/dfraction over the duration)"
            )


def _compared_values(
    profile: JointProfile, coefficients: NDArray[np.float64], *move: float
) -> NDArray[np.float64]:
    """What is compared, at `_SHARES` of the duration, a row each.

    Angle, speed and acceleration; CasADi's rates of the first two; all three by `outer` of `inner`.
    """
    function = _comparison(profile)
    columns = np.tile([*coefficients, *move], (len(_SHARES), 1)).T
    return function(np.vstack([_SHARES, columns]))[0]


@lru_cache(maxsize=256)
def _comparison(profile: JointProfile) -> Compiled:
    """What `_compared_values` returns, of columns of a fraction, coefficients and a move."""
    return Compiled(lambda: _build_comparison(profile))


def _build_comparison(profile: JointProfile) -> ca.Function:
    symbols = ca.SX.sym("given", 1 + profile.size + 3)
    fraction, *given = ca.vertsplit(symbols)
    coefficients, move = given[: profile.size], given[profile.size :]
    motion = [ca.SX(x) for x in profile.derivatives(coefficients, fraction, *move)[:3]]
    joined = profile.outer(profile.inner(coefficients, fraction, *move), *move)[:3]
    rates = [ca.jacobian(value, fraction) / move[-1] for value in motion[:2]]
    results = ca.densify(ca.vertcat(*motion, *rates, *joined))
    return ca.Function("motion", [symbols], [results]).map(len(_SHARES))
