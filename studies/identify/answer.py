"""A plant with the parameters that recordings tell, and how sure they are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
from quietarm.models import JointMotion, Plant
from quietarm.ocp.saved import Saved
from quietarm.ocp.uncertainty import with_values

POOR = 0.25
"""Share of a recording that a fit may leave; with more the plant is not what was recorded."""


@dataclass(frozen=True)
class Estimate:
    """A parameter that recordings tell.

    Attributes
    ----------
    parameter : str
        Its name.
    value : float
        By least squares [SI units].
    low, high : float
        Ends of the interval that covers the truth in 95 of 100 cases.
    by : str
        What the interval is of: ``"fit"``, or ``"spread"`` where ring-downs differ by more.
    """

    parameter: str
    value: float
    low: float
    high: float
    by: str

    @property
    def error(self) -> float:
        """The larger distance to an end, as a share of the value."""
        return max(self.high - self.value, self.value - self.low) / self.value


@dataclass(frozen=True)
class Fitted:
    """A part of a recording, and how it is met.

    Attributes
    ----------
    recording : str
        Name of the recording.
    begin, end : float
        The part of it [s].
    values : tuple of float
        The parameters by this part alone, those told and then those not.
    misfit : float
        Root mean square of what the fit leaves, as a share of the signals'.
    held_back : float or None
        The same where this part was not fitted, but the others; None where there are none.
    """

    recording: str
    begin: float
    end: float
    values: tuple[float, ...]
    misfit: float
    held_back: float | None


@dataclass(frozen=True)
class Identified(Saved):
    """A plant as recordings tell it.

    Attributes
    ----------
    plant : Plant
        With what is told; all else is as it was given.
    fitted : dict of str to float
        What least squares made of the parameters, also of those not told.
    told : tuple of Estimate
        The parameters that the recordings tell.
    untold : dict of str to str
        Those asked for that they do not tell, and why.
    parts : tuple of Fitted
        What was fitted.
    left_out : tuple of str
        Recordings without a ring-down.
    versions : dict of str to str
        Of what identified it.
    """

    kind: ClassVar[str] = "machine"
    version: ClassVar[int] = 1

    plant: Plant
    fitted: dict[str, float]
    told: tuple[Estimate, ...]
    untold: dict[str, str]
    parts: tuple[Fitted, ...]
    left_out: tuple[str, ...]
    versions: dict[str, str]

    @property
    def errors(self) -> dict[str, float]:
        """Relative errors of the plant by the intervals, for an `Uncertainty`.

        Raises
        ------
        ValueError
            When a parameter is not told, or the plant does not move as what was recorded.
        """
        if (left := min(part.misfit for part in self.parts)) > POOR:
            raise ValueError(
                f"{left:.0%} and more of the recordings is left by the plant, so that the "
                "intervals say nothing; state errors of your own, as frequency=5%, or record anew"
            )
        if self.untold:
            name, told = next(iter(self.untold)), [one.parameter for one in self.told]
            raise ValueError(
                f"{name} was not told by the recordings ({self.untold[name]}); state errors of "
                f"your own, as frequency=5%, or identify again with "
                f"{' and '.join(told) or 'omega'} alone, by --free"
            )
        return {
            one.parameter: one.error
            for one in self.told
            if not in_torque_alone(self.plant, one.parameter)
        }

    def check_unchanged(self, names: Iterable[str]) -> None:
        """Refuse to change parameters on which the measured intervals rest.

        Parameters
        ----------
        names : iterable of str
            Those that are set anew.

        Raises
        ------
        ValueError
            When one shows in how the plant swings, and not in its torque alone.
        """
        for name in names:
            if name in self.plant.measured and not in_torque_alone(self.plant, name):
                value = getattr(self.plant, name)
                raise ValueError(
                    f"the measured intervals are of the machine with {name} {value:.6g}; identify "
                    f"it with the other {name}, or state errors of your own, as frequency=5%"
                )


def in_torque_alone(plant: Plant, name: str) -> bool:
    """Whether a parameter shows in the torque, and neither in the modes nor at the tips."""
    symbol, joint = ca.SX.sym(name), JointMotion(*(ca.SX.sym("joint") for _ in range(3)))
    W, dW = ([ca.SX.sym("W") for _ in range(plant.modes)] for _ in range(2))
    changed = with_values(plant, {name: symbol})
    ddW = changed.modal_accelerations(joint, W, dW)
    moves = ca.SX(ca.vertcat(*ddW, *changed.tip_displacements(W)))
    torque = ca.SX(changed.torque(joint, W, dW, ddW))
    return not ca.depends_on(moves, symbol) and ca.depends_on(torque, symbol)
