"""Energies of a move that a task may ask for, one class a definition."""

from __future__ import annotations

from abc import ABC
from dataclasses import astuple, dataclass
from functools import lru_cache
from numbers import Real
from typing import Any, ClassVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression
from quietarm.models.compiled import Compiled
from quietarm.ocp.checks import hashable, instance, not_negative, positive, words_of_error


def power_of(torque: Any, speed: Any) -> Any:
    """The joint's mechanical power [W], of any kind: what the net work is the integral of."""
    return torque * speed


class Energy(ABC):
    """The energy of a move [J]: the integral of `absolute` * abs(torque * speed) + `smooth`.

    A new energy is a frozen dataclass of numbers, with a name. They add, and take weights.
    """

    example: ClassVar[str] = "an energy, such as AbsolutePower() or CopperLoss(0.12)"
    """What to give where something else was given."""
    name: ClassVar[str]
    """The name by which files and the command line know the energy."""
    absolute: float = 0.0
    """Weight of the absolute power, 0 or more; its sign changes are found."""
    agreement: ClassVar[float] = 0.0
    """Share by which the steps of a search may miss it: of an integrand with jumps some per cent,
    where 0.001 is usual."""

    def smooth(self, torque: Expression, speed: Expression) -> Expression:
        """The smooth integrand [W], by joint torque [N m] and speed [rad/s].

        In smooth operations that work element by element.
        """
        return 0.0

    @property
    def label(self) -> str:
        """Name of the energy with its numbers, as it is typed, too, such as ``copper:0.12``."""
        energy: Any = self  # every energy is a dataclass
        numbers = ",".join(f"{number:.12g}" for number in astuple(energy))
        return f"{self.name}:{numbers}" if numbers else self.name

    def __add__(self, energy: Energy) -> Mix:
        return Mix((*_parts(self), *_parts(energy)))

    def __mul__(self, weight: float) -> Mix:
        return Mix(tuple((weight * factor, part) for factor, part in _parts(self)))

    __rmul__ = __mul__


@dataclass(frozen=True)
class AbsolutePower(Energy):
    """Integral of abs(torque * speed), eqs (11) and (16): braking costs as much as driving."""

    name = "absolute"
    absolute = 1.0


ABSOLUTE_POWER = AbsolutePower()


@dataclass(frozen=True)
class PositivePower(Energy):
    """Integral of torque * speed where it is positive: braking costs nothing and gives nothing."""

    name = "positive"
    absolute = 0.5

    def smooth(self, torque: Expression, speed: Expression) -> Expression:
        """Half the power: with half its absolute value the positive part."""
        return power_of(torque, speed) / 2


@dataclass(frozen=True)
class CopperLoss(Energy):
    """Integral of (torque / motor constant)^2: the heat of the motor's windings.

    Parameters
    ----------
    motor_constant : float
        Joint torque over the square root of the loss [N m/W^0.5]: the motor's, times the gear
        ratio.
    """

    name = "copper"
    motor_constant: float

    def __post_init__(self) -> None:
        constant = positive("motor constant", self.motor_constant, "N m/W^0.5")
        object.__setattr__(self, "motor_constant", constant)

    def smooth(self, torque: Expression, speed: Expression) -> Expression:
        """The loss at one time."""
        return torque * torque / self.motor_constant**2


@dataclass(frozen=True)
class Mix(Energy):
    """A weighted sum of energies, as ``0.5 * AbsolutePower() + CopperLoss(0.12)``.

    Parameters
    ----------
    parts : tuple of (float, Energy)
        Weights, positive, and energies.
    """

    name = "mix"
    parts: tuple[tuple[float, Energy], ...]

    def __post_init__(self) -> None:
        parts = tuple(
            (positive("weight", weight), instance("part of a mix", part, Energy))
            for weight, part in self.parts
        )
        object.__setattr__(self, "parts", parts)
        object.__setattr__(
            self,
            "absolute",
            sum(weight * part.absolute for weight, part in parts),
        )

    def smooth(self, torque: Expression, speed: Expression) -> Expression:
        """The weighted sum of the parts'."""
        return sum(weight * part.smooth(torque, speed) for weight, part in self.parts)

    @property
    def label(self) -> str:
        """The labels of the parts with their weights, as they are typed."""
        weights = ("" if weight == 1 else f"{weight:.12g}*" for weight, _ in self.parts)
        labels = (part.label for _, part in self.parts)
        return "+".join(map("".join, zip(weights, labels)))


def check_energy(energy: Energy) -> None:
    """Refuse an energy whose integrand is no number, fails on symbols or mixes candidates.

    Raises
    ------
    TypeError
        When it is no energy, or one that may change.
    ValueError
        With what is wrong, and what to write.
    """
    instance("energy", energy, Energy)
    hashable("energy", energy)
    _check_integrand(energy)


@lru_cache(maxsize=64)
def _check_integrand(energy: Energy) -> None:
    name = f"absolute of energy {energy.name!r}"
    if not isinstance(energy.absolute, Real):
        raise ValueError(f"{name} is {energy.absolute!r}; give a number, 0 or more")
    not_negative(name, energy.absolute)
    # Candidates at which an energy is looked at.
    rows = 7
    torques, speeds = np.random.default_rng(0).uniform(-2.0, 2.0, (2, rows))
    together = _integrand(energy, torques, speeds)
    pairs = zip(torques[:, None], speeds[:, None])
    alone = np.concatenate([_integrand(energy, torque, speed) for torque, speed in pairs])
    # Share by which an integrand of one candidate may differ from that among others.
    tolerance = 1e-9
    wrong = ~(np.abs(together - alone) <= tolerance * np.abs(alone).max())  # nan is wrong as well
    if wrong.any():
        k = int(wrong.argmax())
        raise ValueError(
            f"energy {energy.name!r}: at {torques[k]:.4g} N m and {speeds[k]:.4g} rad/s its smooth "
            f"is {together[k]:.4g} W among other candidates and {alone[k]:.4g} W alone; write "
            "operations with finite values that work element by element"
        )


def _integrand(energy: Energy, torques: NDArray[np.float64], speeds: NDArray[np.float64]) -> Any:
    """The smooth integrand of candidates [W], by symbols, as the solvers evaluate it."""
    torque, speed = (ca.MX.sym(name, len(torques)) for name in ("torque", "speed"))
    try:
        integrand = ca.MX.zeros(len(torques)) + energy.smooth(torque, speed)
        outputs = [ca.densify(integrand)]
        smooth = Compiled(lambda: ca.Function("smooth", [torque, speed], outputs))
        return smooth(torques, speeds)[0].ravel()
    except (Exception, SystemExit) as error:  # of any kind: a user's own lines
        text = words_of_error(error)
        raise ValueError(
            f"energy {energy.name!r}: its smooth fails ({text}); write (self, torque, speed) that "
            "returns one expression, with casadi.exp and its like"
        ) from None


def _parts(energy: Energy) -> tuple[tuple[float, Energy], ...]:
    return energy.parts if isinstance(energy, Mix) else ((1.0, energy),)
