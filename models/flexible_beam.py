"""A beam on a motor's hub, in terms that are measured: frequency, lengths and masses.

The beam is Euler and Bernoulli's, clamped to the hub, with a mass at its tip. Its modes, their
orthogonality and the stiffening by rotation are in Meirovitch, Fundamentals of Vibrations (2001),
ch. 8, and Southwell and Gough, ARC R&M 766 (1921); docs/physics.md derives the equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import pi
from numbers import Real
from typing import Any, ClassVar, NamedTuple

import casadi as ca
import numpy as np
from quietarm.models.drawing import Body, flexible_link
from quietarm.models.joint_motion import Expression, JointMotion, Modes
from quietarm.models.plant import COUNT, Plant, parameter

MOST_MODES = 6
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_PLACES = [(float(x + 1) / 2, float(w) / 2) for x, w in zip(_NODES, _WEIGHTS, strict=True)]
"""Places along the beam, as shares of its length, and their weights in integrals."""
_NEWTON = 12
"""Newton's iterations for a wave number: from its bounds it takes six."""
_LONGEST = 100.0
"""A longer beam [m] was typed in other units."""
_NONE = "none by default"
_PAPERS = "the paper's plate, section 3.1"


class BeamModes(NamedTuple):
    """Modes of a beam with a tip mass, without dimensions; each is 1 at the tip.

    Attributes
    ----------
    wave_numbers : list
        k of each mode: its frequency is that of the first times (k / k of the first)^2.
    masses : list
        Modal mass over the beam's mass.
    pushes : list
        Integral of distance from the axis times mode shape: what a turning hub moves.
    stiffenings : list of lists
        By the centrifugal tension, for a joint speed of 1, over the beam's mass.
    """

    wave_numbers: list[Expression]
    masses: list[Expression]
    pushes: list[Expression]
    stiffenings: list[list[Expression]]


def _wave_number(index: int, ratio: Expression) -> Expression:
    """The root of 1 + cos k cosh k + ratio k (cos k sinh k - sin k cosh k) = 0 of a mode.

    It lies between those of a mode with a pinned and with a free tip.
    """
    if index == 0:  # Rayleigh's estimate, within 2 % for any mass
        k: Expression = ca.sqrt(ca.sqrt(3 / (ratio + 33 / 140)))
    else:
        free, pinned = (index + 0.5) * pi, (index + 0.25) * pi
        k = pinned + (free - pinned) / (1 + 4 * index * ratio)
    for _ in range(_NEWTON):  # the equation over cosh k, which keeps its numbers small
        sine, cosine, tangent = ca.sin(k), ca.cos(k), ca.tanh(k)
        value = 1 / ca.cosh(k) + cosine + ratio * k * (cosine * tangent - sine)
        slope = (
            -tangent / ca.cosh(k) - sine + ratio * (cosine * tangent - sine)
            + ratio * k * (-sine * tangent + cosine / ca.cosh(k) ** 2 - cosine)
        )  # fmt: skip
        k = k - value / slope
    return k


def _shape(k: Expression, place: float) -> tuple[Expression, Expression]:
    """A mode and its slope at a place, of any size."""
    sigma = (ca.cosh(k) + ca.cos(k)) / (ca.sinh(k) + ca.sin(k))
    x = k * place
    value = ca.cosh(x) - ca.cos(x) - sigma * (ca.sinh(x) - ca.sin(x))
    slope = k * (ca.sinh(x) + ca.sin(x) - sigma * (ca.cosh(x) - ca.cos(x)))
    return value, slope


def beam_modes(count: int, ratio: Expression, radius: Expression) -> BeamModes:
    """The first modes of a beam, by tip mass over the beam's and hub's radius over its length."""
    if isinstance(ratio, Real) and isinstance(radius, Real):
        return _known_modes(count, float(ratio), float(radius))
    return _beam_modes(count, ratio, radius)


def _beam_modes(count: int, ratio: Expression, radius: Expression) -> BeamModes:
    waves = [_wave_number(i, ratio) for i in range(count)]
    tips = [_shape(k, 1.0)[0] for k in waves]
    along = [
        [tuple(part / tip for part in _shape(k, place)) for place, _ in _PLACES]
        for k, tip in zip(waves, tips, strict=True)
    ]

    def integral(values: Sequence[Expression]) -> Expression:
        return sum((w * value for (_, w), value in zip(_PLACES, values, strict=True)), 0.0)

    masses = [ratio + integral([value**2 for value, _ in mode]) for mode in along]
    pushes = [
        ratio * (radius + 1)
        + integral([
            (radius + place) * value for (place, _), (value, _) in zip(_PLACES, mode, strict=True)
        ])
        for mode in along
    ]  # fmt: skip
    tension = [
        (1 - place) * (radius + (1 + place) / 2) + ratio * (radius + 1) for place, _ in _PLACES
    ]
    stiffenings = [
        [
            integral([f * a * b for f, (_, a), (_, b) in zip(tension, one, other, strict=True)])
            for other in along
        ]
        for one in along
    ]
    return BeamModes(waves, masses, pushes, stiffenings)


@lru_cache(maxsize=256)
def _known_modes(count: int, ratio: float, radius: float) -> BeamModes:
    def numbers(of: Any) -> Any:
        return [numbers(one) for one in of] if isinstance(of, list) else float(of)

    return BeamModes(*map(numbers, _beam_modes(count, ratio, radius)))


@dataclass(frozen=True)
class FlexibleBeam(Plant):
    """A flexible beam with a tip mass on a motor's hub, in measured terms.

    Measure `omega` with the hub held: push the tip and count its swings, `--set omega=3.2Hz`. The
    amplitude of each mode is the displacement of the tip by it.

    Raises
    ------
    ValueError
        When a length, a mass or a frequency is not positive, or the number of modes is none.
    """

    name: ClassVar[str] = "flexible-beam"

    omega: float = parameter(10.43, "rad/s", "eq (10)", "first frequency, hub held, as measured")
    zeta: float = parameter(9.636e-3, "-", "eq (10)", "damping ratio of every mode")
    hub_inertia: float = parameter(
        5.0e-4, "kg m^2", "alpha1 of eq (10) less plate and tip mass",
        "of all that turns without the beam: rotor, hub",
    )  # fmt: skip
    friction: float = parameter(3.091e-2, "N m s", "eq (10)", "viscous friction of the joint")
    length: float = parameter(0.475, "m", _PAPERS, "of the beam, from the hub to the tip")
    mass_per_length: float = parameter(
        0.425, "kg/m", f"{_PAPERS}: 50 mm x 1 mm of brass of 8500 kg/m^3",
        "width times thickness times density",
    )  # fmt: skip
    tip_mass: float = parameter(0.036, "kg", _PAPERS, "at the tip")
    hub_radius: float = parameter(0.0, "m", _NONE, "from the axis to the clamp")
    mode_count: float = parameter(1.0, COUNT, _NONE, f"how many modes, up to {MOST_MODES}")

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("omega", "length", "mass_per_length"):
            if getattr(self, name) <= 0:
                raise ValueError(f"{name} is {getattr(self, name):g}; give more than 0")
        for name in ("zeta", "hub_inertia", "friction", "tip_mass", "hub_radius"):
            if getattr(self, name) < 0:
                raise ValueError(f"{name} is {getattr(self, name):g}; give 0 or more")
        if self.length > _LONGEST:
            raise ValueError(
                f"length is {self.length:g} m, more than {_LONGEST:g}; are these millimetres? give "
                "metres, or 475mm"
            )
        if self.mode_count not in range(1, MOST_MODES + 1):
            raise ValueError(
                f"mode_count is {self.mode_count:g}; give a whole number from 1 to {MOST_MODES}"
            )

    @property
    def modes(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How many modal amplitudes it has."""
        return int(self.mode_count)

    @property
    def small_deflection(self) -> float:  # pyright: ignore[reportIncompatibleVariableOverride]
        """A tenth of the length; see `SingleLinkManipulator`."""
        return 0.1 * self.length

    @classmethod
    def of_section(
        cls,
        *,
        width: float,
        thickness: float,
        density: float,
        youngs_modulus: float,
        length: float,
        tip_mass: float = 0.0,
        **others: float,
    ) -> FlexibleBeam:
        """A beam whose frequency is not measured, from its section and material.

        Parameters
        ----------
        width, thickness : float
            Of the section [m]; it bends across its thickness.
        density : float
            Of the material [kg/m^3].
        youngs_modulus : float
            Of the material [Pa].
        length, tip_mass, **others
            As of the class.
        """
        per_length = width * thickness * density
        (k,), *_ = beam_modes(1, tip_mass / (per_length * length), 0.0)
        stiffness = youngs_modulus * width * thickness**3 / 12
        omega = float(k) ** 2 * (stiffness / per_length) ** 0.5 / length**2
        return cls(
            omega=omega, length=length, mass_per_length=per_length, tip_mass=tip_mass, **others
        )

    def carrying(self, tip_mass: float) -> FlexibleBeam:
        """The same beam, of the same stiffness, with another mass at its tip.

        Parameters
        ----------
        tip_mass : float
            The mass [kg].

        Returns
        -------
        FlexibleBeam
            Its frequency is the one that the beam's equation makes of this one's.
        """
        before, after = (
            float(beam_modes(1, mass / self._mass, 0.0).wave_numbers[0])
            for mass in (self.tip_mass, tip_mass)
        )
        return replace(self, tip_mass=tip_mass, omega=self.omega * (after / before) ** 2)

    @property
    def _mass(self) -> Expression:
        return self.mass_per_length * self.length

    @property
    def _modes(self) -> BeamModes:
        return beam_modes(self.modes, self.tip_mass / self._mass, self.hub_radius / self.length)

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """Second derivatives of what each mode displaces the tip by [m/s^2]."""
        beam = self._modes
        found: list[Expression] = []
        for i, k in enumerate(beam.wave_numbers):
            omega = self.omega * (k / beam.wave_numbers[0]) ** 2
            tension = sum((s * w for s, w in zip(beam.stiffenings[i], W, strict=True)), 0.0)
            by_speed = tension / beam.masses[i] - W[i]
            push = self.length * beam.pushes[i] / beam.masses[i]
            found.append(
                -2 * self.zeta * omega * dW[i] - omega**2 * W[i]
                - joint.speed**2 * by_speed - push * joint.acceleration
            )  # fmt: skip
        return found

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque [N m]."""
        radius, end = self.hub_radius, self.hub_radius + self.length
        of_beam = self.mass_per_length * (end**3 - radius**3) / 3
        inertia = self.hub_inertia + of_beam + self.tip_mass * end**2
        of_modes = sum((p * a for p, a in zip(self._modes.pushes, ddW, strict=True)), 0.0)
        bending = self._mass * self.length * of_modes
        return inertia * joint.acceleration + bending + self.friction * joint.speed

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """Displacement of the tip, the sum of its modes [m]."""
        return [sum(W[1:], W[0])]

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The beam on its hub."""
        plate = flexible_link(self.length, angle, tips[0])
        return [Body(plate, tip=True), Body(plate[:1], rigid=True)]
