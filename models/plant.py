"""The contract that every plant meets: what moves, as equations.

They are written once, in casadi's operations, element by element: the same lines serve symbols,
matrices with a candidate in each row, and numbers.
"""

from __future__ import annotations

import reprlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import Field, dataclass, field, fields
from importlib import import_module
from inspect import get_annotations
from numbers import Real
from pathlib import Path
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, final

import casadi as ca
import numpy as np

from quietarm.models.drawing import Body, rigid_link
from quietarm.models.drive import Drive
from quietarm.models.final import refuse_overridden
from quietarm.models.joint_motion import LINEAR, ROTARY, Expression, JointMotion, Modes
from quietarm.models.notes import Note
from quietarm.models.rates import rates_along
from quietarm.models.validation import check_contract, check_drive, check_passive

if TYPE_CHECKING:
    from quietarm.ocp import PointToPoint

COUNT = "count"
"""Unit of a parameter that is a whole number."""
TIP = "displacement of the tip per modal amplitude"
"""Meaning of a plant's phi, the mode shape at its tip."""
FREQUENCY = "frequency"
"""The kind of a parameter that is the frequency of a mode [rad/s]."""
DAMPING = "damping"
"""The kind of a parameter that is the damping ratio of a mode."""
OTHER = "other"
"""The kind of all other parameters."""


def parameter(
    default: float, unit: str, source: str, meaning: str = "", kind: str | None = None
) -> Any:
    """Declare a parameter of a plant, a field of its frozen dataclass.

    Parameters
    ----------
    default : float
        In SI units.
    unit : str
        ``"-"`` where there is none.
    source, meaning : str
        An equation, a table or a reason; what it is, in words.
    kind : str, optional
        ``"frequency"`` or ``"damping"``, the damping ratio of a mode, which recordings of a swing
        tell; ``"other"``. By default a frequency where the unit is rad/s, and else other.
    """
    if kind not in (None, FREQUENCY, DAMPING, OTHER):
        raise ValueError(f"kind is {kind!r}; give {FREQUENCY!r}, {DAMPING!r} or {OTHER!r}")
    metadata = {"unit": unit, "source": source, "meaning": meaning, "kind": kind}
    return field(default=default, metadata=metadata)


def content(meaning: str) -> Any:
    """Declare a part of a plant that is no number, as a robot: a value that is saved with it."""
    return field(metadata={"content": True, "meaning": meaning})


class SprungEquations(Protocol):
    """Equations of what moves without a reduction: every spring by itself.

    The state is the angles of `springs` [rad] and their rates. Motions are those along a path, or
    columns of all joints; expressions are symbols of CasADi.
    """

    springs: int

    def at_rest(self, place: Any) -> Any:
        """Angles at rest at a place of the path, or with the joints at positions, an array."""
        ...

    def joints(self, path: JointMotion) -> Sequence[JointMotion]:
        """Motion of every joint."""
        ...

    def accelerations(self, path: JointMotion, angles: Any, rates: Any) -> Any:
        """Return the accelerations of the angles, a column."""
        ...

    def torques(self, path: JointMotion, angles: Any, rates: Any) -> Any:
        """Return the torque of every joint [N m], a column."""
        ...

    def tip(self, path: JointMotion, angles: Any) -> Any:
        """Position of the tip [m], a column."""
        ...


class FullEquations(SprungEquations, Protocol):
    """Equations of a plant without the reduction by which its motions are planned.

    Motions along the path are those of `Plant`.
    """

    def modal_state(self, place: float, state: np.ndarray) -> np.ndarray:
        """W [m], then W' [m/s] of the plant that a state of angles and rates comes nearest to."""
        ...


class Follower(Protocol):
    """A joint that moves as another one does."""

    def motion(self, leading: JointMotion) -> JointMotion:
        """Motion of a joint by that of the joint that it follows."""
        ...


if TYPE_CHECKING:

    @dataclass(frozen=True)
    class _Driven:
        """Declaration of the keyword `drive` of every plant, for editors."""

        drive: Drive | None = field(default=None, kw_only=True)

else:

    class _Driven:
        """A plant gets its field when it is defined: `Plant` itself is no dataclass."""

        drive = None


class Plant(_Driven, ABC):
    """Joints with flexible modes: subclass it as a frozen dataclass, in one file.

    A subclass sets `name` and `modes`, declares its parameters as float fields (with `parameter`)
    and gives three equations: `modal_accelerations`, `torque` and `tip_displacements`; see
    `validate`. Their derivatives are CasADi's. They may have no value at some angles; a move must
    not pass these.

    A plant of several joints moves along a path. What the equations are then given as the joint's
    angle is the place on the path; it gives `joints`, and `torques` in place of `torque`. Where the
    tips' displacements depend on the place it gives `tips_at` in place of `tip_displacements`.

    Parameters
    ----------
    drive : Drive, optional
        The drive of the joint, a keyword of every plant of one joint.

    Raises
    ------
    ValueError
        When a parameter is not a finite number, or beyond all scale.
    TypeError
        When a subclass overrides `parameters`, `units`, `tips` or `validate`.
    """

    example: ClassVar[str] = "a plant, such as SingleLinkManipulator() or LinearAxis()"
    """What to give where something else was given."""
    name: ClassVar[str]
    """The name by which commands and files know the plant."""
    modes: ClassVar[int]
    """How many modal amplitudes the plant has."""

    joint: ClassVar[str] = ROTARY
    """The kind of joint: rotary, in rad and N m, or linear, in m and N (`Unit`). Of several
    joints theirs, or mixed; `joint_kinds` has each."""
    tip_unit: ClassVar[str] = "m"
    """Unit of the tips' displacements: m, or rad where they turn, as the load of a shaft does."""
    small_deflection: ClassVar[float | None] = None
    """Largest tip displacement that the equations are made for; None where none is stated."""
    steps_at_once: ClassVar[int] = 1
    """A solver takes a multiple of so many steps: where equations take long to compile, moves that
    last nearly as long share them."""
    path_range: ClassVar[tuple[float, float] | None] = None
    """Least and largest joint angle, or place on the path, that the equations are made for; None
    where they hold at any. A move must begin and end within it."""
    in_space: ClassVar[bool] = False
    """Whether its `structure` is in space; else it is in a plane, seen from above."""
    along_path: ClassVar[bool] = False
    """Whether the joint's angle is a place on a path from 0 to 1 although there is one joint."""
    is_kept: ClassVar[bool] = False
    """Whether functions of it are left to the next process; see `kept_functions`."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]  # of every subclass
    _known: ClassVar[dict[str, type[Plant]]] = {}

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        _declare_drive(cls)
        refuse_overridden(
            cls,
            Plant,
            "the three equations; other checks belong into __post_init__",
        )
        choices = {"joint": (ROTARY, LINEAR), "tip_unit": ("m", "rad")}
        for entry, kinds in choices.items():
            stated = getattr(cls, entry)
            if not isinstance(stated, property) and stated not in kinds:
                raise ValueError(
                    f"{entry} of {cls.__name__} is {stated!r}; give {' or '.join(map(repr, kinds))}"
                )
        if not isinstance(name := cls.__dict__.get("name"), str):
            return
        belongs_to_quietarm = cls.__module__.startswith(f"{__package__}.")
        if not belongs_to_quietarm and name in _shipped_plants():
            raise ValueError(f"plant name {name!r} is quietarm's own; give {cls.__name__} another")
        Plant._known[name] = cls

    def __post_init__(self) -> None:
        # Powers of larger ones are beyond double precision.
        largest = 1e100
        for name, value in self.parameters.items():
            number = isinstance(value, Real) and not isinstance(value, bool)
            if not (number and abs(value) <= largest):
                raise ValueError(
                    f"{self.name}: parameter {name} is {reprlib.repr(value)}; give a finite number "
                    f"of at most {largest:g} in size, in SI units"
                )
            object.__setattr__(self, name, float(value))

    @abstractmethod
    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """Second time derivatives of the modal amplitudes [m/s^2], `modes` of them.

        By the joint's motion [rad, rad/s, rad/s^2], the amplitudes W [m] and their rates [m/s].
        An amplitude that is an angle, of a shaft or a rope, is in rad: see docs/own_plant.md.
        """

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque that the motion needs [N m]; arguments as in `modal_accelerations`.

        Of several joints by default what their `torques` come to along the path, sum of q' torque.
        """
        slopes = [motion.speed for motion in self.joints(JointMotion(joint.angle, 1.0, 0.0))]
        torques = self.torques(joint, W, dW, ddW)
        return sum(slope * torque for slope, torque in zip(slopes, torques, strict=True))

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """Displacements of the tips that must come to rest [`tip_unit`], linear in `W`.

        By default those at the place 0 of the path.
        """
        return self.tips_at(JointMotion(0.0, 0.0, 0.0), W)

    def joints(self, path: JointMotion) -> Sequence[JointMotion]:
        """Motion of every joint by the motion along the path; by default the one joint's.

        Speeds, accelerations and jerks are time derivatives of the angles. Where the path has no
        jerk (None), nor have the joints.
        """
        return [path]

    def torques(self, path: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Sequence[Expression]:
        """Torque of every one of the `joints` [N m]; by default the one joint's."""
        return [self.torque(path, W, dW, ddW)]

    @final
    def driving_torques(
        self, path: JointMotion, W: Modes, dW: Modes, ddW: Modes
    ) -> Sequence[Expression]:
        """Torque that every drive gives [N m]: `torques`, and Coulomb friction of the `drive`."""
        torques = self.torques(path, W, dW, ddW)
        if self.drive is None or not self.drive.coulomb:
            return torques
        joints = self.joints(path)
        return [torque + self.drive.friction(j.speed) for torque, j in zip(torques, joints)]

    def tips_at(self, path: JointMotion, W: Modes) -> Sequence[Expression]:
        """Displacements of the tips at a place of the path; by default the same everywhere."""
        return self.tip_displacements(W)

    @property
    def tip_reach(self) -> float | None:
        """Distance of the tips by the joint's way [m/rad, or 1 if it slides]; None if not known.

        In the direction of their displacements; by default it is not known.
        """
        return None

    def tip_deviations(
        self, places: np.ndarray, tips: np.ndarray, target: float
    ) -> np.ndarray | None:
        """Return where the tips are, as seen from where they rest with the joint at the target [m].

        By the joint's angle or its place on the path, shape (samples,), and the tips' displacements
        there, shape (tips, samples). A row for each tip; where `tip_lines` are of one tip that
        moves in space, a row for each axis. None where `tip_reach` is not known: the tips are then
        taken to arrive with the joint.
        """
        reach = self.tip_reach
        return None if reach is None else reach * (places - target) + tips

    def tip_speeds(self, path: JointMotion, W: Modes, dW: Modes) -> Sequence[Expression]:
        """Time derivatives of `tips_at` [`tip_unit`/s], by default by CasADi.

        Formulas of a plant's own may be faster; they are checked against CasADi's.
        """
        if self._tips_follow_the_modes:
            return self.tip_displacements(dW)

        def tips(path: JointMotion, W: Modes, _: Modes) -> Sequence[Expression]:
            return self.tips_at(path, W)

        return rates_along(tips, path, W, dW, [0.0] * self.modes)

    def tip_accelerations(
        self, path: JointMotion, W: Modes, dW: Modes, ddW: Modes
    ) -> Sequence[Expression]:
        """Time derivatives of `tip_speeds` [`tip_unit`/s^2], likewise."""
        if self._tips_follow_the_modes:
            return self.tip_displacements(ddW)
        return rates_along(self.tip_speeds, path, W, dW, ddW)

    @property
    def _tips_follow_the_modes(self) -> bool:
        """Return whether the tips' displacements are the same everywhere on the path."""
        return type(self).tips_at is Plant.tips_at

    @property
    def in_full(self) -> FullEquations | None:
        """The equations by which plans are verified where the plant's own are a reduction.

        None, the default, where they are not.
        """
        return None

    @property
    @final
    def has_path(self) -> bool:
        """Return whether the joint's angle in the equations is a place on a path."""
        return self.along_path or len(self.joint_names) > 1

    @property
    def followers(self) -> Mapping[str, tuple[int, Follower]]:
        """Joints beside `joints` that follow one of them: by name its number, and how.

        None, by default. Exports have their motion; they have no torque of their own.
        """
        return {}

    @property
    def notes(self) -> Sequence[Note]:
        """Warnings that stand beside its figures, by default none."""
        return ()

    @property
    def tip_names(self) -> tuple[str, ...]:
        """Names of the tips' displacements in tables: tip_1 and tip_2, or tip if there is one."""
        numbers = range(1, self.tips + 1)
        return ("tip",) if self.tips == 1 else tuple(f"tip_{number}" for number in numbers)

    @property
    def tip_lines(self) -> np.ndarray | None:
        """Lines along which displacements count as residual, shape (lines, tips), unit vectors.

        Each tip for itself where there are none (None, the default). A tip that moves in a plane or
        in space has lines that are so many that none of its displacements is much longer.
        """
        return None

    def with_frequency(self, factor: Expression) -> Plant | None:
        """The plant with natural frequencies so many times as high.

        None, the default, where no more changes than the terms of the modes at rest.
        """
        return None

    @property
    def label(self) -> str:
        """Name of the plant in reports; by default its `name`."""
        return self.name

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, in the order of `joints`, by which limits and columns name them."""
        count = len(self.joints(JointMotion(ca.SX.sym("angle"), 0.0, 0.0)))
        return ("joint",) if count == 1 else tuple(f"joint_{i}" for i in range(1, count + 1))

    @property
    def joint_kinds(self) -> tuple[str, ...]:
        """The kind of each of the joints, by default `joint`."""
        return (self.joint,) * len(self.joint_names)

    def kind_of(self, joint: str) -> str:
        """Return the kind of a joint by its name, also of one that follows another."""
        return dict(zip(self.joint_names, self.joint_kinds)).get(joint, self.joint)

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """The structure seen from above, by default a straight link of 1 m for each tip.

        Of a plant `in_space` points have a third coordinate, upwards. The joint's angle is in rad;
        the tips are `tip_displacements` [m], scaled for the picture.
        """
        shapes = [rigid_link(1.0, angle, tip) for tip in tips]
        links = [Body(shape, rigid=True, tip=True) for shape in shapes]
        return [*links, Body(np.zeros((1, 2)), rigid=True)]

    @property
    def seen_from(self) -> float:
        """Direction of the ground from which a structure in space is seen at first [rad]."""
        return 0.0

    @property
    @final
    def parameters(self) -> dict[str, float]:
        """The plant's parameters by name, in SI units."""
        return {entry.name: getattr(self, entry.name) for entry in self.parameter_fields()}

    @classmethod
    @final
    def units(cls) -> dict[str, str]:
        """The parameters' units by name, "-" where there is none."""
        return {entry.name: entry.metadata.get("unit", "-") for entry in cls.parameter_fields()}

    @classmethod
    @final
    def parameter_kinds(cls) -> dict[str, str]:
        """The parameters' kinds by name: frequency, damping or other."""
        return {entry.name: _kind_of(entry) for entry in cls.parameter_fields()}

    @classmethod
    @final
    def parameter_fields(cls) -> tuple[Field[Any], ...]:
        """Return the fields that are parameters: all but a drive and the like."""
        return tuple(entry for entry in fields(cls) if "content" not in entry.metadata)

    @property
    def limits(self) -> Mapping[str, Any]:
        """Limits that its tasks have, by quantity ({"speed": 3.0}) or by joint; none by default.

        Each is as of `PointToPoint`.
        """
        return {}

    @final
    def task(self, target: float, duration: float, **others: Any) -> PointToPoint:
        """The move to a target within the plant's own limits; other keywords of `PointToPoint`.

        A limit that is given is in the place of the plant's own of that quantity.
        One that is given by joint is in the place of those joints' own: all others keep theirs.
        """
        import quietarm  # the name over all packages: models know of tasks what they are called

        return quietarm.PointToPoint.of(self, target, duration, **others)

    @property
    def measured(self) -> dict[str, float]:
        """The parameters that may have relative errors: all but counts."""
        units = self.units()
        return {name: value for name, value in self.parameters.items() if units[name] != COUNT}

    @property
    def as_checked(self) -> Plant:
        """The plant whose equations are checked for this one: itself.

        One that quietarm makes for many values of its parameters names another, checked once.
        """
        return self

    @property
    @final
    def tips(self) -> int:
        """Number of tip displacements of the plant."""
        return len(self.tips_at(JointMotion(ca.SX.sym("angle"), 0.0, 0.0), [0.0] * self.modes))

    @final
    def validate(self) -> None:
        """Check what integrator and residual rely on; every task does.

        Raises
        ------
        ValueError
            When an equation fails, mixes candidates or is not finite; the modes are not affine in
            their amplitudes and rates, not at rest with the joint, or unstable; the joint has no
            inertia, or yields work from rest; rates of several joints or of tips are not those of
            their angles or displacements.
        """
        check_contract(self)
        check_passive(self)
        check_drive(self)


def _declare_drive(kind: type[Plant]) -> None:
    """Give a class of plants the keyword `drive`, which its decorator makes a field of."""
    if any(hasattr(base, "__dataclass_fields__") for base in kind.__mro__[1:]):
        return
    metadata = {"content": True, "if_stated": True, "meaning": "servo, transmission, friction"}
    kind.__annotations__ = {**get_annotations(kind), "drive": Drive | None}
    kind.drive = field(default=None, kw_only=True, metadata=metadata)


def _kind_of(entry: Field[Any]) -> str:
    """The kind of a parameter, as its field declares it."""
    declared = entry.metadata.get("kind")
    if declared is None:
        return FREQUENCY if entry.metadata.get("unit") == "rad/s" else OTHER
    return declared


def known_plants() -> dict[str, type[Plant]]:
    """Every plant by its name: quietarm's own, and those of files that were imported."""
    _import_shipped_plants()
    return dict(Plant._known)


def _shipped_plants() -> set[str]:
    """The names of the plants that come with quietarm."""
    shipped = f"{__package__}."
    return {name for name, plant in known_plants().items() if plant.__module__.startswith(shipped)}


def _import_shipped_plants() -> None:
    for module in iter_modules([str(Path(__file__).parent)]):
        import_module(f"{__package__}.{module.name}")
