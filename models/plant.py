"""The contract that every plant meets: what moves, as equations.

Equations are written once, in operations that work element by element. The same lines then serve
an SX scalar (the gradient), an MX matrix with one candidate in each row (the population) and a
plain number (a table). Use `casadi.sin` and its like, not those of `numpy` or `math`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import Field, field, fields, is_dataclass
from numbers import Real
from typing import Any, ClassVar, NamedTuple

import casadi as ca

Expression = Any
"""An SX scalar, an MX matrix or a number: casadi gives these no common base class."""


class JointMotion(NamedTuple):
    """Angle, speed, acceleration and jerk of the joint: entries of the same shape.

    Attributes
    ----------
    angle : Expression
        theta [rad].
    speed : Expression
        theta' [rad/s].
    acceleration : Expression
        theta'' [rad/s^2].
    jerk : Expression or None
        theta''' [rad/s^3]; None where it is not asked for. No plant's equations may use it.
    """

    angle: Expression
    speed: Expression
    acceleration: Expression
    jerk: Expression = None


def parameter(default: float, unit: str, source: str) -> Any:
    """Declare a parameter of a plant, with its unit and the source of its value.

    Parameters
    ----------
    default : float
        Value in SI units.
    unit : str
        SI unit, ``"-"`` where there is none.
    source : str
        Equation, table or reason.

    Returns
    -------
    dataclasses.Field
        The field, for use in a frozen dataclass.
    """
    return field(default=default, metadata={"unit": unit, "source": source})


class Plant(ABC):
    """A joint with flexible modes: subclass it as a frozen dataclass, in one file.

    A subclass sets `name` and `modes`, declares its parameters as float fields (with `parameter`)
    and gives three equations: `modal_accelerations`, `torque` and `tip_displacements`. For a given
    joint motion the modal accelerations must be affine in the modal amplitudes and their rates, and
    the tip displacements linear in the amplitudes; the structure at rest must stay at rest.
    `validate` checks all of it.

    Raises
    ------
    ValueError
        When a parameter is not a finite number.
    """

    name: ClassVar[str]
    """The name by which commands and files know the plant."""
    modes: ClassVar[int]
    """How many modal amplitudes the plant has."""

    small_deflection: ClassVar[float | None] = None
    """Largest tip displacement that the equations are made for [m]; None where none is stated."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]  # of every subclass
    _known: ClassVar[dict[str, type[Plant]]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if isinstance(cls.__dict__.get("name"), str):
            Plant._known[cls.name] = cls

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            number = isinstance(value, Real) and not isinstance(value, bool)
            if not number or not math.isfinite(value):
                raise ValueError(
                    f"{self.name}: parameter {entry.name} is {value}; give a finite number"
                )
            object.__setattr__(self, entry.name, float(value))

    @abstractmethod
    def modal_accelerations(
        self, joint: JointMotion, W: Sequence[Expression], dW: Sequence[Expression]
    ) -> Sequence[Expression]:
        """Second time derivatives of the modal amplitudes.

        Parameters
        ----------
        joint : JointMotion
            The joint's motion [rad, rad/s, rad/s^2].
        W, dW : sequence of Expression
            Modal amplitudes [m] and their rates [m/s], `modes` of each.

        Returns
        -------
        sequence of Expression
            W'' [m/s^2], `modes` entries.
        """

    @abstractmethod
    def torque(
        self,
        joint: JointMotion,
        W: Sequence[Expression],
        dW: Sequence[Expression],
        ddW: Sequence[Expression],
    ) -> Expression:
        """Joint torque that the motion needs [N m]; arguments as in `modal_accelerations`."""

    @abstractmethod
    def tip_displacements(self, W: Sequence[Expression]) -> Sequence[Expression]:
        """Displacements of the tips that must come to rest [m], linear in `W` [m]."""

    @property
    def parameters(self) -> dict[str, float]:
        """The plant's parameters by name, in SI units."""
        return {entry.name: float(getattr(self, entry.name)) for entry in fields(self)}

    @property
    def tips(self) -> int:
        """How many tip displacements the plant has."""
        return len(self.tip_displacements([0.0] * self.modes))

    def validate(self) -> None:
        """Check the contract that the integrator and the residual rely on.

        Raises
        ------
        ValueError
            When the number of modal accelerations is not `modes`, the equations are not affine in
            the modes, the tip is not linear in them, or the structure does not stay at rest.
        """
        if not is_dataclass(self):
            raise ValueError(
                f"plant {self.name!r} is no dataclass; write @dataclass(frozen=True) above it"
            )
        if isinstance(self.modes, bool) or not isinstance(self.modes, int) or self.modes < 1:
            raise ValueError(f"plant {self.name!r} has {self.modes!r} modes; give it 1 or more")
        try:
            self._validate_equations()
        except IndexError:
            raise ValueError(
                f"plant {self.name!r} says modes = {self.modes} but its equations use more; "
                "set modes to their number"
            ) from None

    def _validate_equations(self) -> None:
        angle, speed, acceleration = ca.SX.sym("q"), ca.SX.sym("dq"), ca.SX.sym("ddq")
        W, dW = ca.SX.sym("W", self.modes), ca.SX.sym("dW", self.modes)
        state = ca.vertcat(W, dW)
        accelerations = self.modal_accelerations(
            JointMotion(angle, speed, acceleration), ca.vertsplit(W), ca.vertsplit(dW)
        )
        if len(accelerations) != self.modes:
            raise ValueError(
                f"plant {self.name!r} says modes = {self.modes} but gives {len(accelerations)} "
                "modal accelerations; return one for each mode"
            )
        if not ca.is_linear(ca.vertcat(*accelerations), state):
            raise ValueError(
                f"plant {self.name!r}: the modal accelerations are not affine in W and W'; "
                "linearise them: quietarm integrates modes that are linear for a given joint motion"
            )
        if self.tips < 1:
            raise ValueError(f"plant {self.name!r} has no tip displacement; give it 1 or more")
        tips = ca.vertcat(*self.tip_displacements(ca.vertsplit(W)))
        if not ca.is_linear(tips, W):
            raise ValueError(f"plant {self.name!r}: the tip displacement is not linear in W")
        at_rest = self.modal_accelerations(
            JointMotion(angle, 0.0, 0.0), [0.0] * self.modes, [0.0] * self.modes
        )
        offset = self.tip_displacements([0.0] * self.modes)
        probe = ca.Function("probe", [angle], [ca.vertcat(*at_rest, *offset)])
        if any(abs(value) > 0 for value in probe(0.7).full().ravel()):
            raise ValueError(
                f"plant {self.name!r} does not stay at rest with the joint at rest and W = 0; "
                "measure W from the static deflection"
            )


def known_plants() -> dict[str, type[Plant]]:
    """Every plant by its name, also those of the user's own files.

    Returns
    -------
    dict
        Class by name; a class is known from the moment its file is imported.
    """
    return dict(Plant._known)
