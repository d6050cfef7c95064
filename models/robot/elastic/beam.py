"""A beam at a robot's link, as rigid pieces between sprung hinges.

The first piece is clamped, and the last one carries the tip. The hinges are where and as stiff as
it takes for the frequencies to be those of the beam.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.polynomial.legendre import legvander

from quietarm.models.beam_modes import beam_modes
from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import finite, not_negative, positive, quoted, whole
from quietarm.models.robot.elastic.hinges import (
    Hinges,
    exact_hinges,
    hinges_in_the_middle,
    masses_of_chain,
)
from quietarm.models.robot.elastic.spectra import spectrum
from quietarm.models.robot.frames import Frame, rotation_about, shortest_turn
from quietarm.models.robot.urdf.read_urdf import Inertia

USUAL_HINGES = 5
"""The least number by which the third frequency is within 2 % as well."""
MOST_PIECES = 20
EXACT = "exact"
MIDDLE = "middle"
"""Where hinges are: such that frequencies are exact, or in the middle of equal parts."""


_SOFTEST = 1e8
_STIFFEST = 1.3e12
"""Young's moduli between which those of bars are: polyethylene has 2e8 Pa, diamond 1.2e12 Pa."""
_LARGE_UNITS = {"GPa": 1e9, "MPa": 1e6}
_ALONG_Z = (0.0, 0.0, 1.0)
_NOWHERE = (0.0, 0.0, 0.0)
_IF_STATED = {"if_stated": True}
_LEAST_DIRECTION = 1e-9


@dataclass(frozen=True)
class Beam:
    """A beam that is clamped at a link, by default at its origin and along its z axis.

    Parameters
    ----------
    at : str
        The link.
    length : float
        From the clamp to the end [m].
    width, height : float, optional
        Size of a rectangular section along the link's y and along its x [m].
    youngs_modulus, density : float, optional
        Of its material [Pa, kg/m^3].
    tip_mass : float
        At its end, a point [kg].
    damping : float
        Damping ratio of its first mode when it is clamped; it is proportional to the stiffness.
    pieces : int, optional
        How many of them hang on hinges: by default five, or as many more as the robot's modes need.
        Whatever it is, from two on its first two frequencies, clamped and with the tip's mass, are
        Euler and Bernoulli's.
    bending_stiffness : float or (float, float), optional
        In place of section and modulus [N m^2]; two where it bends along x otherwise than along y.
    mass_per_length : float, optional
        In place of section and density [kg/m].
    hinges : str
        Where they are: `exact`, or `middle`, as version 2.0.0 had them, in the middle of equal
        parts, which with six pieces are too stiff by 0.4 % in the first frequency.
    direction : (float, float, float)
        Along which it lies, in the link's frame, of any length but 0. The beam is turned there from
        the link's z axis by the shortest turn, and takes its section along: one along x has its
        width along y and its height along z.
    offset : (float, float, float)
        Where it is clamped, in the link's frame [m].
    roll : float
        By which it is turned about itself besides [rad].

    Raises
    ------
    ValueError
        When a value is out of range, or stiffness or mass are given twice or not at all.
    """

    at: str
    length: float
    width: float | None = None
    height: float | None = None
    youngs_modulus: float | None = None
    density: float | None = None
    tip_mass: float = 0.0
    damping: float = 0.0
    pieces: int | None = None
    bending_stiffness: tuple[float, float] | None = None
    mass_per_length: float | None = None
    hinges: Literal["exact", "middle"] = EXACT
    direction: tuple[float, float, float] = field(default=_ALONG_Z, metadata=_IF_STATED)
    offset: tuple[float, float, float] = field(default=_NOWHERE, metadata=_IF_STATED)
    roll: float = field(default=0.0, metadata=_IF_STATED)

    def __post_init__(self) -> None:
        if not isinstance(self.at, str) or not self.at:
            raise ValueError(f"at of the beam is {quoted(self.at)}; give the name of a link")
        object.__setattr__(self, "length", _size("length of the beam", self.length, "m"))
        for name, unit in _OF_MATERIAL.items():
            value = getattr(self, name)
            if value is not None:
                words = f"{name.replace('_', ' ')} of the beam"
                object.__setattr__(self, name, _size(words, value, unit))
        section = (self.width, self.height)
        for name in ("width", "height"):
            size = getattr(self, name)
            if size is not None and size > self.length:
                raise ValueError(
                    f"{name} of the beam is {size:g} m, and its length {self.length:g} m; is it in "
                    f"mm, such as {size:g}mm?"
                )
        by_section = (*section, self.youngs_modulus)
        if self.bending_stiffness is None:
            if None in by_section:
                raise ValueError(
                    "the beam has no stiffness; give width, height and youngs_modulus, or "
                    "bending_stiffness"
                )
        else:
            object.__setattr__(self, "bending_stiffness", _pair(self.bending_stiffness))
            if self.youngs_modulus is not None:
                raise ValueError(
                    "the beam has youngs_modulus and bending_stiffness; give one of them"
                )
        if self.mass_per_length is None and None in (*section, self.density):
            raise ValueError(
                "the beam has no mass; give width, height and density, or mass_per_length"
            )
        if self.mass_per_length is not None and self.density is not None:
            raise ValueError("the beam has density and mass_per_length; give one of them")
        tip_mass = not_negative("tip_mass of the beam", self.tip_mass, "kg")
        if tip_mass > 0:
            tip_mass = _size("tip_mass of the beam", tip_mass, "kg")
        object.__setattr__(self, "tip_mass", tip_mass)
        damping = not_negative("damping of the beam", self.damping)
        if damping >= 1:
            raise ValueError(
                f"damping of the beam is {100 * damping:g} %; give a ratio below 1, such as 0.005"
            )
        object.__setattr__(self, "damping", damping)
        if self.hinges not in (EXACT, MIDDLE):
            raise ValueError(f"hinges of the beam are {quoted(self.hinges)}; give {EXACT}")
        if self.pieces is not None:
            pieces = whole("pieces of the beam", self.pieces, 1, MOST_PIECES)
            object.__setattr__(self, "pieces", pieces)
        self._check_place()

    def _check_place(self) -> None:
        """Check that direction, offset and roll are numbers, and that the direction is one."""
        for name, unit in (("direction", ""), ("offset", "m")):
            object.__setattr__(self, name, _vector(name, getattr(self, name), unit))
        if np.linalg.norm(self.direction) < _LEAST_DIRECTION:
            raise ValueError(
                f"direction of the beam is {list(self.direction)}, none; give one in the frame of "
                "the link, such as [1, 0, 0]"
            )
        roll = finite("roll of the beam", self.roll, "rad")
        if abs(roll) > math.tau:
            raise ValueError(
                f"roll of the beam is {roll:g} rad, more than a turn; were degrees meant? give "
                f"{roll:g}deg"
            )
        object.__setattr__(self, "roll", roll)

    @classmethod
    def of_saved(cls, entries: Any) -> Any:
        """The entries of a saved beam; one of version 2.0.0 has its hinges where they were."""
        if isinstance(entries, dict) and "hinges" not in entries:
            return {**entries, "hinges": MIDDLE}
        return entries

    @property
    def frame(self) -> Frame:
        """Frame of the beam in that of its link: it lies along z."""
        rolled = rotation_about(np.array(_ALONG_Z), self.roll)
        return Frame(shortest_turn(np.array(self.direction)) @ rolled, np.array(self.offset))

    @property
    def stiffness(self) -> tuple[float, float]:
        """Bending stiffness against displacements along x and along y [N m^2]."""
        if self.bending_stiffness is not None:
            return self.bending_stiffness
        assert self.width is not None
        assert self.height is not None
        assert self.youngs_modulus is not None
        along_x = self.width * self.height**3 / 12
        along_y = self.height * self.width**3 / 12
        return (self.youngs_modulus * along_x, self.youngs_modulus * along_y)

    @property
    def hint_of_material(self) -> str:
        """A question where no material is as soft, or as stiff, as stated; else an empty text."""
        modulus = self.youngs_modulus
        if modulus is None or _SOFTEST <= modulus <= _STIFFEST:
            return ""
        what = "softer than any bar" if modulus < _SOFTEST else "stiffer than diamond"
        meant = [
            f"; was {modulus:g}{unit} meant?"
            for unit, size in _LARGE_UNITS.items()
            if _SOFTEST <= size * modulus <= _STIFFEST
        ]
        question = meant[0] if meant else "; give it such as 70GPa"
        return f"youngs_modulus of the beam is {modulus:g} Pa, {what}{question}"

    @property
    def line_mass(self) -> float:
        """Mass per length [kg/m]."""
        if self.mass_per_length is not None:
            return self.mass_per_length
        assert self.width is not None
        assert self.height is not None
        assert self.density is not None
        return self.density * self.width * self.height

    @property
    def count(self) -> int:
        """Number of hinges for each direction."""
        return USUAL_HINGES if self.pieces is None else self.pieces

    @property
    def mass_ratio(self) -> float:
        """The mass at the tip, in shares of the beam's own."""
        return self.tip_mass / (self.line_mass * self.length)

    @property
    def chain(self) -> Hinges:
        """The hinges of a beam of length 1."""
        if self.hinges == MIDDLE:
            return hinges_in_the_middle(self.count)
        return exact_hinges(self.count, self.mass_ratio)

    @property
    def places(self) -> Array:
        """Places of the hinges along the beam [m]."""
        return self.length * self.chain.places

    @property
    def springs(self) -> Array:
        """Springs of the hinges [N m/rad], shape (hinges, 2): about x, to bend along y; about y."""
        along_x, along_y = self.stiffness
        return np.outer(1 / (self.length * self.chain.compliances), [along_y, along_x])

    @property
    def bodies(self) -> list[Inertia]:
        """The pieces, in a frame at the hinge before each; the first hangs on the clamp."""
        ends = [0.0, *self.places, self.length]
        bodies = [self._piece(after - before) for before, after in pairwise(ends)]
        arm = np.array([0.0, 0.0, ends[-1] - ends[-2]])
        bodies[-1] = bodies[-1] + Inertia(self.tip_mass, arm)
        return bodies

    def _piece(self, length: float) -> Inertia:
        """A piece of this length [m], from its beginning.

        Its section turns about the beam alone: Euler and Bernoulli's does not where it bends. Of
        version 2.0.0 it does.
        """
        mass = self.line_mass * length
        width = self.width or 0.0
        height = self.height or 0.0
        across = (0.0, 0.0) if self.hinges == EXACT else (width**2, height**2)
        squares = (length**2 + across[0], length**2 + across[1], width**2 + height**2)
        return Inertia(mass, np.array([0.0, 0.0, length / 2]), np.diag(squares) * mass / 12)

    def frequencies(self, along: int) -> Array:
        """Frequencies of the clamped chain of pieces [rad/s], bent along x (0) or along y (1)."""
        axis = 1 - along
        squares, _ = spectrum(np.diag(self.springs[:, axis]), self._masses(axis))
        return np.sqrt(squares)

    def exact_frequencies(self, along: int) -> Array:
        """The first two of Euler and Bernoulli's beam [rad/s], likewise."""
        modes = beam_modes(2, self.mass_ratio, 0.0)
        scale = math.sqrt(self.stiffness[along] / self.line_mass) / self.length**2
        return scale * np.array(modes.wave_numbers, dtype=float) ** 2

    def for_modes(self, count: int) -> Beam:
        """Return the beam with as many hinges as its modes need, unless their number was given."""
        needed = max(USUAL_HINGES, math.ceil(count / 2) + _HINGES_BEYOND)
        if self.pieces is not None or needed == USUAL_HINGES:
            return self
        return replace(self, pieces=needed)

    @property
    def finer(self) -> Beam:
        """Beam with another number of exact hinges, by which a plan is judged."""
        count = self.count + 1 if self.count < MOST_PIECES else self.count - 1
        return replace(self, pieces=count, hinges=EXACT)

    def angles_of(self, other: Beam) -> Array:
        """Angles of the hinges of another cut of this beam by those of this one.

        Both bend the same: the curvature is a polynomial through this one's hinges.

        Returns
        -------
        ndarray, shape (hinges of the other, hinges of this one)
        """
        mine, others = self.chain, other.chain
        degree = min(self.count, _TERMS) - 1
        here, there = (legvander(2 * chain.places - 1, degree) for chain in (mine, others))
        curvatures = there @ np.linalg.pinv(here)
        return others.compliances[:, None] * curvatures / mine.compliances

    @property
    def damping_time(self) -> float:
        """Damping over stiffness of every hinge [s], by the damping ratio of the first mode."""
        first = min(self.frequencies(along)[0] for along in (0, 1))
        return 2 * self.damping / float(first)

    def _masses(self, axis: int) -> Array:
        """Mass matrix of the hinges' angles about one axis, for small ones [kg m^2]."""
        scale = self.line_mass * self.length**3
        masses = scale * masses_of_chain(self.chain.places, self.mass_ratio)
        if self.hinges == EXACT:
            return masses
        # the sections of each piece turn with it
        size = (self.width or 0.0, self.height or 0.0)[axis]
        of_pieces = self.line_mass * np.diff([*self.places, self.length]) * size**2 / 12
        on = np.tril(np.ones((self.count, self.count)))
        return masses + on.T @ np.diag(of_pieces) @ on


_HINGES_BEYOND = 2
"""More than modes of one plane that are followed."""
_TERMS = 8
"""Of the polynomial of a curvature: the slowest modes need no more."""
_OF_MATERIAL = {
    "width": "m", "height": "m", "youngs_modulus": "Pa", "density": "kg/m^3",
    "mass_per_length": "kg/m",
}  # fmt: skip


def _size(words: str, value: float, unit: str) -> float:
    """A positive number whose powers and products stay numbers."""
    least = 1e-12
    most = 1e15
    number = positive(words, value, unit, most)
    if number < least:
        raise ValueError(f"{words} is {number:g} {unit}; give at least {least:g}")
    return number


def _vector(name: str, values: Any, unit: str) -> tuple[float, float, float]:
    """Return three finite numbers in the frame of the link."""
    words = f"{name} of the beam"
    numbers = [] if isinstance(values, str) or np.ndim(values) != 1 else list(values)
    if len(numbers) != 3:
        raise ValueError(f"{words} is {quoted(values)}; give three numbers, such as [1, 0, 0]")
    x, y, z = (finite(words, value, unit, _MOST) for value in numbers)
    return (x, y, z)


_MOST = 1e3
"""Of a number of direction and offset [m]: beyond, a unit was mistaken."""


def _pair(stiffness: float | Sequence[float]) -> tuple[float, float]:
    """Bending stiffness along x and along y, of one number for both or of two."""
    values = (stiffness, stiffness) if isinstance(stiffness, int | float) else tuple(stiffness)
    if len(values) != 2:
        raise ValueError(
            f"bending_stiffness of the beam has {len(values)} numbers; give one, or two, along x "
            "and along y"
        )
    along_x, along_y = (_size("bending_stiffness of the beam", value, "N m^2") for value in values)
    return (along_x, along_y)
