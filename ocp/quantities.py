"""The one table of the quantities that a task may limit: name, unit, label, what they follow from.

The options of the command line, the peaks among the diagnostics, the rows of the nonlinear programs
and the constraints of the searches are read from here. A new quantity is one line of the table, and
a field for its limit in `PointToPoint` and for its peak in `Motion`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from quietarm.models import Expression, JointMotion, Plant

_JERK = 3


@dataclass(frozen=True)
class Quantity:
    """A quantity whose largest absolute value on the way a task may limit.

    Attributes
    ----------
    name : str
        Its name; ``torque`` has the limit `torque_limit` and the peak `peak_torque`.
    unit : str
        SI unit.
    label : str
        What it is, in words.
    of : callable
        (joint's motion, tip displacements, joint torque) -> its values, of any kind that casadi or
        NumPy computes with.
    derivative : int or None
        Which time derivative of the joint's angle it is; None where it follows from the modes.
    """

    name: str
    unit: str
    label: str
    of: Callable[[JointMotion, Sequence[Expression], Expression], Sequence[Expression]]
    derivative: int | None = None

    @property
    def limit(self) -> str:
        """Name of its limit in a task."""
        return f"{self.name}_limit"

    @property
    def peak(self) -> str:
        """Name of its largest absolute value among a motion's diagnostics."""
        return f"peak_{self.name}"

    def rows(self, plant: Plant) -> int:
        """How many values it has at one time."""
        still = JointMotion(0.0, 0.0, 0.0, 0.0)
        return len(self.of(still, plant.tip_displacements([0.0] * plant.modes), 0.0))


def _of_joint(name: str, unit: str, label: str, derivative: int) -> Quantity:
    return Quantity(name, unit, label, lambda joint, tips, torque: [joint[derivative]], derivative)


QUANTITIES: Mapping[str, Quantity] = MappingProxyType({
    quantity.name: quantity
    for quantity in (
        Quantity("torque", "N m", "joint torque", lambda joint, tips, torque: [torque]),
        _of_joint("speed", "rad/s", "joint speed", 1),
        _of_joint("acceleration", "rad/s^2", "joint acceleration", 2),
        _of_joint("jerk", "rad/s^3", "joint jerk", _JERK),
        Quantity("deflection", "m", "tip displacement", lambda joint, tips, torque: tips),
    )
})  # fmt: skip
"""Every quantity by its name."""


def ask_for_jerk(names: Iterable[str]) -> bool:
    """Whether any of these quantities follows from the joint's jerk, which no plant needs."""
    return any(name in QUANTITIES and QUANTITIES[name].derivative == _JERK for name in names)
