"""The contract that every plant meets: what moves, as equations.

Equations are written once, in operations that work element by element. The same lines then serve
an SX scalar (the gradient), an MX matrix with one candidate in each row (the population) and a
plain number (a table). Use `casadi.sin` and its like, not those of `numpy` or `math`.
"""

from __future__ import annotations

import reprlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import Field, field, fields
from importlib import import_module
from numbers import Real
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, ClassVar

from quietarm.models.drawing import Body, rigid_link
from quietarm.models.joint_motion import Expression, JointMotion, Modes
from quietarm.models.validation import check_contract, check_passive

COUNT = "count"
"""Unit of a parameter that is a whole number."""
TIP = "displacement of the tip per modal amplitude"
"""Meaning of a plant's phi, the mode shape at its tip."""


def parameter(default: float, unit: str, source: str, meaning: str = "") -> Any:
    """Declare a parameter of a plant, with its unit and the source of its value.

    Parameters
    ----------
    default : float
        Value in SI units.
    unit : str
        SI unit, ``"-"`` where there is none.
    source : str
        Equation, table or reason.
    meaning : str, optional
        What it is, in words.

    Returns
    -------
    dataclasses.Field
        The field, for use in a frozen dataclass.
    """
    return field(default=default, metadata={"unit": unit, "source": source, "meaning": meaning})


class Plant(ABC):
    """A joint with flexible modes: subclass it as a frozen dataclass, in one file.

    A subclass sets `name` and `modes`, declares its parameters as float fields (with `parameter`)
    and gives three equations: `modal_accelerations`, `torque` and `tip_displacements`. For a given
    joint motion the modal accelerations must be affine in the modal amplitudes and their rates, and
    the tip displacements linear in the amplitudes; with the joint at rest the structure must stay
    at rest, and no mode may grow; the joint must have inertia, and yield no work from rest.
    `validate` checks all of it. The equations may have no value at some angles; a move must not
    pass these.

    Raises
    ------
    ValueError
        When a parameter is not a finite number, or beyond all scale.
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
        if not isinstance(name := cls.__dict__.get("name"), str):
            return
        taken = Plant._known.get(name, cls)
        if taken.__module__ != cls.__module__ and taken.__module__.startswith(f"{__package__}."):
            raise ValueError(
                f"plant name {name!r} is that of quietarm's own {taken.__name__}; give class "
                f"{cls.__name__} another"
            )
        Plant._known[name] = cls

    def __post_init__(self) -> None:
        for name, value in self.parameters.items():
            number = isinstance(value, Real) and not isinstance(value, bool)
            if not (number and abs(value) <= _MOST_PARAMETER):
                raise ValueError(
                    f"{self.name}: parameter {name} is {reprlib.repr(value)}; give a finite number "
                    f"of at most {_MOST_PARAMETER:g} in size, in SI units"
                )
            object.__setattr__(self, name, float(value))

    @abstractmethod
    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
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
    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque that the motion needs [N m]; arguments as in `modal_accelerations`."""

    @abstractmethod
    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """Displacements of the tips that must come to rest [m], linear in `W` [m]."""

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The structure as it is drawn, seen from above; give your own where it looks otherwise.

        Parameters
        ----------
        angle : float
            Joint angle [rad].
        tips : sequence of float
            Tip displacements [m], those of `tip_displacements` times the scale of the picture.

        Returns
        -------
        sequence of Body
            Its parts. Unless a plant says otherwise: for each tip a straight link of 1 m from the
            joint, displaced across at its end.
        """
        return [
            *(Body(rigid_link(1.0, angle, tip), rigid=True, tip=True) for tip in tips),
            Body(rigid_link(1.0, angle)[:1], rigid=True),
        ]

    @property
    def parameters(self) -> dict[str, float]:
        """The plant's parameters by name, in SI units."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self)}

    @property
    def measured(self) -> dict[str, float]:
        """The parameters that may be wrong by a share, all but counts."""
        counts = [entry.name for entry in fields(self) if entry.metadata.get("unit") == COUNT]
        return {name: value for name, value in self.parameters.items() if name not in counts}

    @property
    def tips(self) -> int:
        """How many tip displacements the plant has."""
        return len(self.tip_displacements([0.0] * self.modes))

    def validate(self) -> None:
        """Check the contract that the integrator and the residual rely on.

        Raises
        ------
        ValueError
            When the class lacks its modes or the dataclass above it, a method takes other arguments
            or returns something else than it should, does not take symbols or mixes them, is not
            finite at rest, or the modes are not affine, not at rest with the joint, or unstable;
            when the joint has no positive inertia, or yields work from rest.
        """
        check_contract(self)
        check_passive(self)


_MOST_PARAMETER = 1e100
"""Powers of larger ones are beyond double precision."""


def known_plants() -> dict[str, type[Plant]]:
    """Every plant by its name, also those of the user's own files.

    Returns
    -------
    dict
        Class by name: those of the files of this package, and any whose file was imported.
    """
    for module in iter_modules([str(Path(__file__).parent)]):
        import_module(f"{__package__}.{module.name}")
    return dict(Plant._known)
