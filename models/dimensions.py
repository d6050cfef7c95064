"""Units and words of a plant's quantities, as values: each is shown as its joints and tips have it.

A joint turns, in rad and N m, or slides, in m and N; a tip moves, in m, or turns, in rad.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

from quietarm.models.joint_motion import LINEAR, MIXED, ROTARY
from quietarm.models.number_checks import quoted

_OF_WAY = "way of the joint"
_OF_EFFORT = "effort of the joint"
_OF_INERTIA = "inertia of the joint"
_OF_TIP = "way of the tip"
Powers = tuple[tuple[str, int], ...]
_SHOWN: Mapping[str, Mapping[str, Powers]] = {
    ROTARY: {
        _OF_WAY: (("rad", 1),),
        _OF_EFFORT: (("N", 1), ("m", 1)),
        _OF_INERTIA: (("kg", 1), ("m", 2)),
    },
    LINEAR: {_OF_WAY: (("m", 1),), _OF_EFFORT: (("N", 1),), _OF_INERTIA: (("kg", 1),)},
}
_SUPERSCRIPTS = str.maketrans(
    "0123456789", "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"
)
_LETTERS = re.compile(r"[^\W\d_]+|[%°-]")


@dataclass(frozen=True)
class Unit:
    """A unit as a product of powers of others, for a kind of joint and of tip.

    Products and quotients of units are units: ``WAY / SECOND**2`` is an acceleration's. Its text is
    that of a joint that turns and a tip that moves, unless `on` says of which.

    Parameters
    ----------
    powers : tuple of (str, int)
        What it is made of, each with its exponent.
    joint, tip : str
        The kind of joint, and the unit of the tip's way, that its text is for.
    """

    example: ClassVar[str] = "a unit, as WAY / SECOND or Unit.named('K')"

    powers: Powers = ()
    joint: str = ROTARY
    tip: str = "m"

    @classmethod
    def named(cls, symbol: str) -> Unit:
        """Return the unit of a symbol, whatever the plant.

        ValueError where it is no symbol: what has powers is a product of units.
        """
        if not _LETTERS.fullmatch(symbol):
            raise ValueError(
                f"the symbol of a unit is {quoted(symbol)}; give letters, and products of units, "
                "as Unit.named('K') / SECOND"
            )
        return cls(((symbol, 1),))

    def on(self, joint: str, tip: str = "m") -> Unit:
        """Return this unit for a kind of joint, and a unit of the tip's way."""
        return replace(self, joint=joint, tip=tip)

    def of(self, joint: str, tip: str = "m") -> str:
        """Return its text for a kind of joint, and a unit of the tip's way."""
        return str(self.on(joint, tip))

    @property
    def is_tip_way(self) -> bool:
        """Return whether this is the unit of a tip's displacement, shown in millimetres."""
        return self.powers == TIP.powers

    def __mul__(self, other: Unit) -> Unit:
        return replace(self, powers=_merged((*self.powers, *other.powers)))

    def __truediv__(self, other: Unit) -> Unit:
        return self * other**-1

    def __pow__(self, exponent: int) -> Unit:
        return replace(self, powers=tuple((name, n * exponent) for name, n in self.powers))

    def spelt(self, times: str, over: str, power: Callable[[int], str], either: str) -> str:
        """Return its text with signs between units, a power's, and one between kinds of joint."""
        if self.joint == MIXED:
            kinds = (self.on(kind, self.tip) for kind in (ROTARY, LINEAR))
            texts = dict.fromkeys(one.spelt(times, over, power, either) for one in kinds)
            return either.join(texts)
        shown = {**_SHOWN[self.joint], _OF_TIP: ((self.tip, 1),)}
        symbols = _merged(
            (symbol, n * exponent)
            for name, exponent in self.powers
            for symbol, n in shown.get(name, ((name, 1),))
        )
        above = [_power(symbol, n, power) for symbol, n in symbols if n > 0]
        below = [_power(symbol, -n, power) for symbol, n in symbols if n < 0]
        return over.join([times.join(above) or "1", *below]) if symbols else ""

    @property
    def in_heading(self) -> str:
        """The text in the heading of a column: rad_s2, Nm."""
        return self.spelt("", "_", str, "_or_")

    @property
    def typed(self) -> str:
        """The text as it is typed: Nm, rad/s^2."""
        return self.spelt("", "/", _caret, " or ")

    @property
    def drawn(self) -> str:
        """The text as it is drawn, and in HTML: rad/s\u00b2."""
        return self.spelt(" ", "/", _raised, " or ")

    def __str__(self) -> str:
        return self.spelt(" ", "/", _caret, " or ")

    def __format__(self, form: str) -> str:
        return format(str(self), form)


def _merged(powers: Iterable[tuple[str, int]]) -> Powers:
    """Powers of each unit once, without those that cancel out."""
    exponents = dict[str, int]()
    for name, exponent in powers:
        exponents[name] = exponents.get(name, 0) + exponent
    return tuple((name, n) for name, n in exponents.items() if n)


def _power(symbol: str, exponent: int, power: Callable[[int], str]) -> str:
    return symbol if exponent == 1 else symbol + power(exponent)


def _caret(exponent: int) -> str:
    return f"^{exponent}"


def _raised(exponent: int) -> str:
    return str(exponent).translate(_SUPERSCRIPTS)


NONE = Unit()
"""Of a number: its text is empty."""
WAY = Unit(((_OF_WAY, 1),))
"""Of the joint's angle, or position."""
EFFORT = Unit(((_OF_EFFORT, 1),))
"""Of the joint's torque, or force."""
INERTIA = Unit(((_OF_INERTIA, 1),))
"""Of the joint's rotor, or its mass."""
TIP = Unit(((_OF_TIP, 1),))
"""Of the tip's displacement."""
SECOND = Unit.named("s")
JOULE = Unit.named("J")
WATT = Unit.named("W")
SPEED = WAY / SECOND
ACCELERATION = WAY / SECOND**2
JERK = WAY / SECOND**3
"""Of the joint's motion."""
STIFFNESS = EFFORT / WAY
DAMPING = EFFORT * SECOND / WAY
"""Of the joint's springs."""


@dataclass(frozen=True)
class Words:
    """Words for a quantity of a joint that turns, and for one that slides if these differ.

    Of joints of both kinds it is called by both words.
    """

    example: ClassVar[str] = "words, such as Words('tip acceleration')"

    rotary: str
    linear: str = ""
    joint: str = ROTARY

    def __post_init__(self) -> None:
        object.__setattr__(self, "linear", self.linear or self.rotary)

    def on(self, joint: str) -> Words:
        """Return these words for a kind of joint."""
        return replace(self, joint=joint)

    def of(self, joint: str) -> str:
        """The word for a kind of joint."""
        return str(self.on(joint))

    def within(self, form: str) -> Words:
        """The words within a form, such as "peak {}"."""
        return replace(self, rotary=form.format(self.rotary), linear=form.format(self.linear))

    def __str__(self) -> str:
        if self.joint == MIXED:
            return " or ".join(dict.fromkeys([self.rotary, self.linear]))
        return self.rotary if self.joint == ROTARY else self.linear

    def __format__(self, form: str) -> str:
        return format(str(self), form)


NO_WORDS = Words("")
ANGLE = Words("angle", "position")
TORQUE = Words("torque", "force")
_BY_NAME = {words.rotary: words for words in (ANGLE, TORQUE)}


def words_of(name: str) -> Words:
    """Return the words of a known name: two for `angle` and `torque`, the name for others."""
    return _BY_NAME.get(name, Words(name))
