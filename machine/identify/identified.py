"""An identified plant, the intervals of its parameters, and what kinds of parameters there are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion, Plant
from quietarm.models.drive import Recorded
from quietarm.models.plant import DAMPING, FREQUENCY
from quietarm.ocp.checks import IF_STATED
from quietarm.ocp.saved import Answer
from quietarm.ocp.uncertainty import with_values

Array = NDArray[np.float64]

LEAST_OF_FREQUENCY = 0.02
"""Least error of a frequency for which plans are made, whatever the recordings show."""


@dataclass(frozen=True)
class Estimate:
    """A parameter that recordings identify.

    Attributes
    ----------
    parameter : str
        Its name.
    value : float
        The mean over the parts, weighted by their accuracy [SI units].
    low, high : float
        Ends of the interval that covers the mean in 95 of 100 cases; where the parameter changes
        with the amplitude, all that it is along the swings, and where it drifts from one recording
        to the next, all of the drift.
    next_low, next_high : float or None
        Ends of the interval that covers the next swing's in 95 of 100 cases, from the scatter
        of the parts beyond their own uncertainty; likewise. None with one part.
    """

    parameter: str
    value: float
    low: float
    high: float
    next_low: float | None = None
    next_high: float | None = None

    @property
    def widest(self) -> tuple[float, float]:
        """The interval of the next swing, or where there is none that of the mean."""
        if self.next_low is None or self.next_high is None:
            return self.low, self.high
        return self.next_low, self.next_high

    @property
    def error(self) -> float:
        """The larger distance to an end of either interval, as a share of the value."""
        ends = (self.low, self.high, *self.widest)
        return max(abs(end - self.value) for end in ends) / abs(self.value)

    @property
    def varies(self) -> bool:
        """Return whether the parts differ by more than their own uncertainty, twice and more."""
        low, high = self.widest
        return high - low > 2 * (self.high - self.low)


@dataclass(frozen=True)
class Part:
    """A part of a recording, fitted alone.

    Attributes
    ----------
    recording : str
        Name of the recording.
    begin, end : float
        The part of it [s].
    values, deviations : dict of str to float
        The parameters by this part alone, and their standard deviations.
    amplitude : float
        Of the vibration at the begin, in the signal's unit.
    misfit : float
        Root mean square of the residuals, as a share of the vibration's.
    noise : float
        The recording's own noise, as a share of the same.
    cause, warning : str
        Why the part is doubted: a word, and a sentence; empty where it is not.
    saturated : int
        Samples at the sensor's limit, which are excluded.
    drifts : bool
        Whether a slow drift of the signal is excluded.
    spread : dict of str to (float, float)
        Least and largest of parameters that change with the amplitude, by fits of pieces of the
        swing at small and at large amplitudes.
    largest : float
        Of a swing that is fitted only where its amplitude is smaller, the amplitude at its begin,
        in the signal's unit; else 0.
    hub : str
        How the joint's recorded motion is met: not at all where it is empty, ``"creeps"`` beside a
        free decay, ``"moves"`` all of it.
    """

    recording: str
    begin: float
    end: float
    values: dict[str, float] = field(default_factory=dict)
    deviations: dict[str, float] = field(default_factory=dict)
    amplitude: float = 0.0
    misfit: float = 0.0
    noise: float = 0.0
    cause: str = ""
    warning: str = ""
    saturated: int = 0
    drifts: bool = False
    hub: str = ""
    spread: dict[str, tuple[float, float]] = field(default_factory=dict)
    largest: float = 0.0

    @property
    def unexplained(self) -> float:
        """Misfit beside the noise, as a share of the vibration."""
        return float(max(self.misfit**2 - self.noise**2, 0.0)) ** 0.5

    @property
    def vector(self) -> NDArray[np.float64]:
        """The values of its parameters."""
        return np.array([*self.values.values()])


@dataclass(frozen=True)
class Identified(Answer):
    """A plant that is identified from recordings.

    Attributes
    ----------
    plant : Plant
        With the identified parameters and the rough ones; all others are as given.
    estimates : tuple of Estimate
        The identified parameters.
    not_identifiable : dict of str to str
        Parameters that are not identifiable by the recordings, and why.
    parts : tuple of Part
        The fitted parts.
    left_out : dict of str to str
        Recordings that were not fitted, and why.
    warnings : tuple of str
        Doubts about the recordings, such as their units or a drift from one to the next.
    versions : dict of str to str
        Of what identified it.
    rough : dict of str to float
        The values of parameters that are not identifiable but told roughly: with an interval as
        wide as they are.
    recorded : str, optional
        How the joint was while it was recorded, as of a `Drive`: "held" also where its recorded
        motion is an input of the fit, so that the frequencies are those of a held one.
    """

    kind: ClassVar[str] = "machine"
    version: ClassVar[int] = 2
    sealed: ClassVar[bool] = False

    plant: Plant
    estimates: tuple[Estimate, ...]
    not_identifiable: dict[str, str]
    parts: tuple[Part, ...]
    left_out: dict[str, str]
    warnings: tuple[str, ...]
    versions: dict[str, str]
    rough: dict[str, float] = field(default_factory=dict, metadata=IF_STATED)
    recorded: Recorded | None = field(default=None, metadata=IF_STATED)

    @property
    def untold(self) -> tuple[str, ...]:
        """The parameters of which the recordings tell nothing: the plant keeps what it had."""
        told = {estimate.parameter for estimate in self.estimates} | self.rough.keys()
        return tuple(name for name in self.plant.measured if name not in told)

    def with_given(self, plant: Plant, names: Iterable[str]) -> Identified:
        """Return this machine with a plant's values in place of those that are told but roughly."""
        given = {name: getattr(plant, name) for name in names if name in self.rough}
        rough = {name: value for name, value in self.rough.items() if name not in given}
        return replace(self, plant=replace(self.plant, **given), rough=rough)

    @property
    def errors(self) -> dict[str, float]:
        """Relative errors by the intervals of the next swing, for an `Uncertainty`.

        Raises
        ------
        ValueError
            When a parameter is not identifiable, the plant does not move as what was recorded, or
            one part alone does not tell how much the machine varies.
        """
        remedy = "state errors of your own, such as --error frequency=5%"
        doubtful = [part for part in self.parts if part.warning]
        if 2 * len(doubtful) >= len(self.parts):
            raise ValueError(f"{doubtful[0].recording}: {doubtful[0].warning}; or {remedy}")
        if self.not_identifiable:
            name, why = next(iter(self.not_identifiable.items()))
            known = " and ".join(estimate.parameter for estimate in self.estimates) or "omega"
            raise ValueError(
                f"{name} is not identifiable by the recordings ({why}); {remedy}, or identify "
                f"again with {known} alone, by --free"
            )
        moving = [
            estimate
            for estimate in self.estimates
            if not in_torque_alone(self.plant, estimate.parameter)
        ]
        if len(self.parts) == 1:
            beyond = ""
            if moving:
                widest = max(moving, key=lambda estimate: estimate.error)
                beyond = f", beyond {100 * widest.error:.2g} % of {widest.parameter} by its fit"
            raise ValueError(
                f"one ring-down does not tell how much the machine varies{beyond}; record "
                f"several, or {remedy}"
            )
        least = 1e-6  # of a simulation without noise: a range of none is no range
        return {estimate.parameter: max(estimate.error, least) for estimate in moving}

    @property
    def ranges(self) -> dict[str, float]:
        """Relative errors to plan for, for an `Uncertainty`.

        They are the `errors`, of a frequency `LEAST_OF_FREQUENCY` at least: recordings of one hour
        show how one push differs from the next, and not what a recording of another day shows, at
        another temperature, or under the servo in place of the brake. Errors that `errors` raises.
        """
        return {
            name: max(error, LEAST_OF_FREQUENCY) if is_frequency(self.plant, name) else error
            for name, error in self.errors.items()
        }

    @property
    def error_of_frequency(self) -> float:
        """The largest relative error of a frequency by its intervals, doubtful or not; else 0."""
        errors = (
            estimate.error
            for estimate in self.estimates
            if is_frequency(self.plant, estimate.parameter)
        )
        return max(errors, default=0.0)

    def check_unchanged(self, names: Iterable[str]) -> None:
        """Refuse to change parameters on which the measured intervals rest.

        Parameters
        ----------
        names : iterable of str
            Those that are set anew.

        Raises
        ------
        ValueError
            When one affects the vibration of the plant, and not its torque alone.
        """
        for name in names:
            if name in self.plant.measured and not in_torque_alone(self.plant, name):
                value = getattr(self.plant, name)
                raise ValueError(
                    f"the measured intervals are of the machine with {name} {value:.6g}; identify "
                    f"it with the other {name}, or state errors of your own, such as frequency=5%"
                )


def in_torque_alone(plant: Plant, name: str) -> bool:
    """Return whether a parameter shows in the torque, and neither in the modes nor at the tips."""
    symbol = ca.SX.sym(name)
    joint = JointMotion(*(ca.SX.sym("joint") for _ in range(3)))
    W = [ca.SX.sym("W") for _ in range(plant.modes)]
    dW = [ca.SX.sym("dW") for _ in range(plant.modes)]
    changed = with_values(plant, {name: symbol})
    ddW = changed.modal_accelerations(joint, W, dW)
    moves = ca.SX(ca.vertcat(*ddW, *changed.tips_at(joint, W)))
    torque = ca.SX(changed.torque(joint, W, dW, ddW))
    return not ca.depends_on(moves, symbol) and ca.depends_on(torque, symbol)


def is_frequency(plant: Plant, name: str) -> bool:
    """Return whether a parameter is the frequency of a mode."""
    return plant.parameter_kinds()[name] == FREQUENCY


def is_modal(plant: Plant, name: str) -> bool:
    """Return whether a parameter is the frequency or the damping ratio of a mode."""
    return is_frequency(plant, name) or is_damping(plant, name)


def is_damping(plant: Plant, name: str) -> bool:
    """Return whether a parameter is the damping ratio of a mode."""
    return plant.parameter_kinds()[name] == DAMPING


def values_of(plant: Plant, names: Sequence[str]) -> Array:
    """The values of some parameters."""
    return np.array([getattr(plant, name) for name in names])


def bounds_of(
    plant: Plant, names: Sequence[str], start: Array, seconds: float
) -> tuple[Array, Array]:
    """Return bounds of parameters about a start: dampings go a little below 0, as estimates may.

    No swing of so many seconds grows beyond what numbers can hold.
    """
    most_growth = 100.0  # as a logarithm
    least_damping = 0.3  # below 0
    most_damping = 0.9
    lower = np.full(len(names), -np.inf)
    upper = np.full(len(names), np.inf)
    for k, name in enumerate(names):
        if is_frequency(plant, name):
            lower[k] = 0.3 * start[k]
            upper[k] = 3 * start[k]
    fastest = float(upper[np.isfinite(upper)].max(initial=0.0)) or 1.0
    for k, name in enumerate(names):
        if is_damping(plant, name):
            lower[k] = -min(least_damping, most_growth / (fastest * seconds))
            upper[k] = most_damping
    return lower, upper
