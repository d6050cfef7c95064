"""A beam on a motor's hub, in terms that are measured: frequency, lengths and masses.

Its stiffening by rotation is Southwell and Gough's, ARC R&M 766 (1921); docs/physics.md derives the
equations, `beam_modes` has the modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from operator import mul
from typing import Any, ClassVar

from quietarm.models.beam_modes import BeamModes, beam_modes
from quietarm.models.drawing import Body, flexible_link
from quietarm.models.joint_motion import Expression, JointMotion, Modes
from quietarm.models.plant import COUNT, DAMPING, Plant, parameter

_MOST_MODES = 6
_NONE = "none by default"
_PAPERS = "the paper's plate, section 3.1"
_modes_of_numbers = lru_cache(maxsize=256)(beam_modes)


@dataclass(frozen=True)
class FlexibleBeam(Plant):
    """A flexible beam with a tip mass on a motor's hub, with measurable parameters.

    Measure `omega` with the hub held: push the tip and count its swings, `--set omega=3.2Hz`. The
    amplitude of each mode is the displacement of the tip by it.

    Raises
    ------
    ValueError
        When a length, a mass or a frequency is not positive, or the number of modes is none.
    """

    name: ClassVar[str] = "flexible-beam"

    omega: float = parameter(10.43, "rad/s", "eq (10)", "first frequency, hub held, as measured")
    zeta: float = parameter(9.636e-3, "-", "eq (10)", "damping ratio of every mode", DAMPING)
    hub_inertia: float = parameter(
        5.0e-4, "kg m^2", "alpha1 of eq (10) less plate and tip", "of rotor, hub and the like"
    )
    friction: float = parameter(3.091e-2, "N m s", "eq (10)", "viscous friction of the joint")
    length: float = parameter(0.475, "m", _PAPERS, "of the beam, from the hub to the tip")
    mass_per_length: float = parameter(
        0.425, "kg/m", f"{_PAPERS}: brass of 8500 kg/m^3", "width times thickness times density"
    )
    tip_mass: float = parameter(0.036, "kg", _PAPERS, "at the tip")
    hub_radius: float = parameter(0.0, "m", _NONE, "from the axis to the clamp")
    mode_count: float = parameter(1.0, COUNT, _NONE, f"how many modes, up to {_MOST_MODES}")

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, value in self.parameters.items():
            positive = name in ("omega", "length", "mass_per_length")
            if value < 0 or (positive and value == 0):
                least = "more than 0" if positive else "0 or more"
                unit = self.units()[name].strip("-")
                raise ValueError(f"{name} is {f'{value:g} {unit}'.strip()}; give {least}")
        # A longer beam [m] was typed in other units.
        longest = 100.0
        if self.length > longest:
            raise ValueError(f"length is {self.length:g} m, of no joint; give metres, or 475mm")
        if (count := self.mode_count) not in range(1, _MOST_MODES + 1):
            raise ValueError(
                f"mode_count is {count:g}; give a whole number from 1 to {_MOST_MODES}"
            )

    @property
    def modes(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Number of modal amplitudes of the beam."""
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
        **parameters: Any,
    ) -> FlexibleBeam:
        """A beam whose frequency is not measured, from its section [m] and material [kg/m^3, Pa].

        It bends across its thickness; the other parameters are those of the class.
        """
        per_length = width * thickness * density
        (k,), *_ = beam_modes(1, tip_mass / (per_length * length), 0.0)
        stiffness = youngs_modulus * width * thickness**3 / 12
        omega = k**2 * (stiffness / per_length) ** 0.5 / length**2
        return cls(
            omega=omega, length=length, mass_per_length=per_length, tip_mass=tip_mass, **parameters
        )

    def carrying(self, tip_mass: float) -> FlexibleBeam:
        """Return this beam with another mass [kg] at its tip and the same stiffness."""
        (before,), *_ = beam_modes(1, self.tip_mass / self._mass, 0.0)
        (after,), *_ = beam_modes(1, tip_mass / self._mass, 0.0)
        return replace(
            self,
            tip_mass=tip_mass,
            omega=self.omega * (after / before) ** 2,
        )

    @property
    def _mass(self) -> Expression:
        return self.mass_per_length * self.length

    @property
    def _modes(self) -> BeamModes:
        ratio = self.tip_mass / self._mass
        radius = self.hub_radius / self.length
        are_numbers = isinstance(ratio, float) and isinstance(radius, float)
        return (_modes_of_numbers if are_numbers else beam_modes)(self.modes, ratio, radius)

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """Second derivatives of what each mode displaces the tip by [m/s^2]."""
        first, *_ = self._modes.wave_numbers
        accelerations: list[Expression] = []
        for i, (k, mass, push, stiffening) in enumerate(zip(*self._modes)):
            omega = self.omega * (k / first) ** 2
            by_speed = sum(map(mul, stiffening, W)) / mass - W[i]
            vibration = -2 * self.zeta * omega * dW[i] - omega**2 * W[i]
            pushed = joint.speed**2 * by_speed + self.length * push / mass * joint.acceleration
            accelerations.append(vibration - pushed)
        return accelerations

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque [N m]."""
        radius = self.hub_radius
        end = self.hub_radius + self.length
        of_beam = self.mass_per_length * (end**3 - radius**3) / 3
        inertia = self.hub_inertia + of_beam + self.tip_mass * end**2
        bending = self._mass * self.length * sum(map(mul, self._modes.pushes, ddW))
        return inertia * joint.acceleration + bending + self.friction * joint.speed

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """Displacement of the tip, the sum of its modes [m]."""
        return [sum(W[1:], W[0])]

    @property
    def tip_reach(self) -> float:
        """Distance from the axis to the tip."""
        return self.hub_radius + self.length

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The beam on its hub."""
        plate = flexible_link(self.length, angle, tips[0])
        return [Body(plate, tip=True), Body(plate[:1], rigid=True)]
