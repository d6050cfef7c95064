"""Executed moves and what a machine left of them: the history in a learned plan's file.

Its values are as measured, in units of the tip, and hold whatever the plant's parameters become.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from quietarm.ocp.checks import NotNegative, finite, instance, not_negative, several
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.task import ModalState


@dataclass(frozen=True)
class ArrivalSwing:
    """The swing of one mode at arrival, by the displacement of the tip that it moves most.

    Attributes
    ----------
    amplitude : float
        In the unit of the tip [m, of a tip that turns rad].
    phase : float
        At arrival [rad]: the displacement is amplitude times its cosine.
    deviation : float
        Standard deviation of each of its two parts by the recording's noise [as the amplitude].
    """

    amplitude: NotNegative
    phase: float
    deviation: NotNegative = 0.0

    def __post_init__(self) -> None:
        for name in ("amplitude", "deviation"):
            object.__setattr__(self, name, not_negative(f"{name} of a swing", getattr(self, name)))
        object.__setattr__(self, "phase", finite("phase of a swing", self.phase, "rad"))

    @classmethod
    def of(cls, complex_amplitude: complex, deviation: float) -> ArrivalSwing:
        """The swing whose displacement is the real part of this at arrival."""
        return cls(abs(complex_amplitude), cmath.phase(complex_amplitude), float(deviation))

    @property
    def complex_amplitude(self) -> complex:
        """Amplitude and phase as one number, whose real part is the displacement at arrival."""
        return cmath.rect(self.amplitude, self.phase)


@dataclass(frozen=True)
class RecordedArrival:
    """One recording of an executed move, by what it tells.

    Attributes
    ----------
    recording : str
        Its name.
    swings : tuple of ArrivalSwing
        Of every mode of the plant at arrival, the slowest first.
    values, deviations : mapping of str to float
        The plant's parameters by this recording alone, and their standard deviations; empty where
        it does not tell them.
    """

    recording: str
    swings: tuple[ArrivalSwing, ...]
    values: Mapping[str, float] = field(default_factory=dict, hash=False)
    deviations: Mapping[str, float] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        swings = tuple(several("swings", self.swings, "swings, one for each mode"))
        for swing in swings:
            instance("a swing", swing, ArrivalSwing)
        object.__setattr__(self, "swings", swings)
        for name in ("values", "deviations"):
            numbers = {
                parameter: finite(f"{name} of {parameter}", value)
                for parameter, value in getattr(self, name).items()
            }
            object.__setattr__(self, name, numbers)
        if self.values.keys() != self.deviations.keys():
            raise ValueError(
                f"{self.recording} has values of {', '.join(self.values) or 'nothing'} and "
                f"deviations of {', '.join(self.deviations) or 'nothing'}; give both of each"
            )


@dataclass(frozen=True)
class ExecutedMove:
    """A move that a machine made, once or several times.

    Attributes
    ----------
    profile : JointProfile
        How the joint was told to move.
    coefficients : tuple of float
        The profile's.
    move : tuple of float
        Start, target and duration [rad, s], of a linear joint in metres.
    measured : tuple of RecordedArrival
        What each recording of it tells.
    """

    profile: JointProfile
    coefficients: tuple[float, ...]
    move: tuple[float, float, float]
    measured: tuple[RecordedArrival, ...]


@dataclass(frozen=True)
class MoveHistory:
    """The moves that a plan was learned from, the first one first, and what arrival was wanted.

    Attributes
    ----------
    moves : tuple of ExecutedMove
        Of one task on one machine.
    wanted : ModalState or None
        The state on arrival that was asked for before anything was learned; None is rest.
    model : mapping of str to float
        The plant's frequencies and dampings before anything was learned.
    """

    example: ClassVar[str] = "the history of a plan that learn made"

    moves: tuple[ExecutedMove, ...] = ()
    wanted: ModalState | None = None
    model: Mapping[str, float] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        model = {name: finite(name, value) for name, value in self.model.items()}
        object.__setattr__(self, "model", model)
