"""A robot with its equations, whatever its joints do."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from quietarm.interrupts import interruptible
from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import has_no
from quietarm.models.robot.dynamics.equations_of_motion import Dynamics
from quietarm.models.robot.dynamics.kinematics import Kinematics
from quietarm.models.robot.dynamics.measured_fit import MeasuredFit, fit_measured
from quietarm.models.robot.dynamics.mechanism import Mechanism, build_mechanism
from quietarm.models.robot.dynamics.modes import modes_at, sag_at, tip_offset
from quietarm.models.robot.dynamics.robot_parts import RobotParts
from quietarm.models.robot.frames import Frame


class MovingRobot(RobotParts):
    """A robot with what follows from its parts: bodies, equations, modes, places of links."""

    @cached_property
    def unscaled(self) -> Mechanism:
        """The bodies, with the springs as they were given."""
        return build_mechanism(self)

    @cached_property
    def mechanism(self) -> Mechanism:
        """The bodies, with the springs as they were measured."""
        return self.dynamics.mechanism

    @cached_property
    def dynamics(self) -> Dynamics:
        """The equations, with the springs as they were measured."""
        dynamics = Dynamics(self.unscaled)
        fit = self.fit
        if fit is None:
            return dynamics
        if fit.payload != 1:
            more = (fit.payload - 1) * self.stated_payload
            dynamics = dynamics.loaded(more, self.of_one_kilogram)
        dynamics = dynamics.stiffened(fit.stiffness)
        return dynamics if fit.damping == 1 else dynamics.damped(fit.damping)

    @cached_property
    def fit(self) -> MeasuredFit | None:
        """Springs and load as measured frequencies tell them; None where none was measured."""
        if not self.measurements:
            return None
        load = (self.stated_payload, self.of_one_kilogram) if self.stated_payload else None
        return fit_measured(Dynamics(self.unscaled), self.measurements, load)

    @property
    def payload(self) -> float:
        """Mass at the end of the beam [kg], as measured frequencies tell it, or as given."""
        return self.stated_payload * (1.0 if self.fit is None else self.fit.payload)

    def dynamics_with(self, stiffness: float, payload: float) -> Dynamics:
        """The equations with so many times the stiffness of all springs, and the mass at the tip.

        Dampers keep the damping ratio where the stiffness changes, and their values where the mass
        does.
        """
        dynamics = self.dynamics
        if payload != 1:
            dynamics = dynamics.loaded((payload - 1) * self.payload, self.of_one_kilogram)
        return dynamics if stiffness == 1 else dynamics.stiffened(stiffness)

    @cached_property
    def of_one_kilogram(self) -> Dynamics:
        """The equations of 1 kg at the end of the beam, without other masses."""
        return Dynamics(self.unscaled.of_one_kilogram)

    @property
    def tip_place(self) -> tuple[int, Frame]:
        """Body and frame of the tip."""
        assert self.tip is not None
        return self.mechanism.links[self.tip]

    @interruptible
    def kinematics(self, link: str | None = None) -> Kinematics:
        """Return the kinematics of a link; by default of that with the beam, or else the tip.

        Raises
        ------
        ValueError
            When the robot has no link of that name.
        """
        if link is None:
            link = self.beam.at if self.beam is not None else self.tip
        assert link is not None
        if link not in self.mechanism.links:
            raise ValueError(has_no("the robot", "link, for a line,", link, self.mechanism.links))
        return Kinematics(self.dynamics, link)

    @interruptible
    def frequencies(self, q: Sequence[float] | Array) -> Array:
        """Frequencies of all modes with the driven joints held at q [rad/s], under gravity.

        ValueError where a spring is too soft to carry its load.
        """
        values, _ = modes_at(self.dynamics, np.asarray(q, float))
        return values

    @interruptible
    def sag(self, q: Sequence[float] | Array) -> Array:
        """Return how far the tip hangs below that of a rigid robot [m], in the tip's frame."""
        dynamics = self.dynamics
        q = np.asarray(q, float)
        p = sag_at(dynamics, q)
        return tip_offset(dynamics, self.tip_place, q, p)
