"""A beam at a robot's link, as rigid pieces between sprung hinges.

A hinge in the middle of each of equal parts bends as that part does; half a part is clamped, and
half of one carries the tip. The chain is a little too stiff: by a share of the square of a part.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from quietarm.models.beam_modes import beam_modes
from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import not_negative, positive, quoted, whole
from quietarm.models.robot.elastic.spectra import spectrum
from quietarm.models.robot.urdf.read_urdf import Inertia

USUAL_PIECES = 6
MOST_PIECES = 20
_ACCURATE = 0.005
"""Share by which a frequency of the chain may be another than the beam's."""


@dataclass(frozen=True)
class Beam:
    """A beam that is clamped at a link's frame, and lies along its z axis.

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
        How many parts; by default six, or as many more as bring its first two frequencies, clamped
        and with the tip's mass, within 0.5 % of Euler and Bernoulli's.
    bending_stiffness : float or (float, float), optional
        In place of section and modulus [N m^2]; two where it bends along x otherwise than along y.
    mass_per_length : float, optional
        In place of section and density [kg/m].

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
                    f"mm, as {size:g}mm?"
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
                f"damping of the beam is {100 * damping:g} %; give a ratio below 1, as 0.005"
            )
        object.__setattr__(self, "damping", damping)
        pieces = self._enough() if self.pieces is None else self.pieces
        object.__setattr__(self, "pieces", whole("pieces of the beam", pieces, 1, MOST_PIECES))

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
        """Number of parts of the beam."""
        assert self.pieces is not None
        return self.pieces

    @property
    def places(self) -> Array:
        """Places of the hinges along the beam [m]."""
        return self.length * (np.arange(self.count) + 0.5) / self.count

    @property
    def springs(self) -> Array:
        """Springs of the hinges [N m/rad], shape (pieces, 2): about x, to bend along y; about y."""
        along_x, along_y = self.stiffness
        return np.tile([along_y, along_x], (self.count, 1)) * self.count / self.length

    @property
    def bodies(self) -> list[Inertia]:
        """The pieces, in a frame at the hinge before each; the first hangs on the clamp."""
        ends = [0.0, *self.places, self.length]
        bodies = [self._piece(after - before) for before, after in pairwise(ends)]
        arm = np.array([0.0, 0.0, ends[-1] - ends[-2]])
        bodies[-1] = bodies[-1] + Inertia(self.tip_mass, arm)
        return bodies

    def _piece(self, length: float) -> Inertia:
        """A piece of this length [m], from its beginning."""
        mass = self.line_mass * length
        width = self.width or 0.0
        height = self.height or 0.0
        squares = (length**2 + width**2, length**2 + height**2, width**2 + height**2)
        return Inertia(mass, np.array([0.0, 0.0, length / 2]), np.diag(squares) * mass / 12)

    def frequencies(self, along: int) -> Array:
        """Frequencies of the clamped chain of pieces [rad/s], bent along x (0) or along y (1)."""
        axis = 1 - along
        squares, _ = spectrum(np.diag(self.springs[:, axis]), self._masses(axis))
        return np.sqrt(squares)

    def exact_frequencies(self, along: int) -> Array:
        """The first two of Euler and Bernoulli's beam [rad/s], likewise."""
        modes = beam_modes(2, self.tip_mass / (self.line_mass * self.length), 0.0)
        scale = math.sqrt(self.stiffness[along] / self.line_mass) / self.length**2
        return scale * np.array(modes.wave_numbers, dtype=float) ** 2

    @property
    def excess(self) -> float:
        """Largest share by which the first two frequencies, of both planes, are not exact."""
        chain = np.concatenate([self.frequencies(along)[:2] for along in (0, 1)])
        exact = np.concatenate(
            [self.exact_frequencies(along)[: len(chain) // 2] for along in (0, 1)]
        )
        first_two = np.argsort(exact)[:2]
        return float(np.abs(chain / exact - 1)[first_two].max())

    def _enough(self) -> int:
        """The least number of pieces from six on that is accurate."""
        numbers = range(USUAL_PIECES, MOST_PIECES + 1)
        accurate = (number for number in numbers if replace(self, pieces=number).excess < _ACCURATE)
        return next(accurate, MOST_PIECES)

    @property
    def damping_time(self) -> float:
        """Damping over stiffness of every hinge [s], by the damping ratio of the first mode."""
        first = min(self.frequencies(along)[0] for along in (0, 1))
        return 2 * self.damping / float(first)

    def _masses(self, axis: int) -> Array:
        """Mass matrix of the hinges' angles about one axis, for small ones [kg m^2]."""
        places = self.places
        masses = np.zeros((self.count, self.count))
        for count, (place, body) in enumerate(zip(places, self.bodies[1:]), start=1):
            arms = place + body.centre[2] - places[:count]
            turning = np.full((count, count), body.moments[axis, axis])
            masses[:count, :count] += body.mass * np.outer(arms, arms) + turning
        return masses


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
