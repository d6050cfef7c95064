"""Limits of a task: quantities on the way and the residual after it, with their bounds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression, Plant, SingleLinkManipulator
from quietarm.models.dimensions import (
    ACCELERATION,
    EFFORT,
    JERK,
    NO_WORDS,
    NONE,
    SPEED,
    TIP,
    TORQUE,
    Unit,
    Words,
    words_of,
)
from quietarm.models.joint_motion import MIXED, ROTARY
from quietarm.models.plant_file import note_added
from quietarm.ocp.checks import instance, not_negative, quoted, takes, words_of_error
from quietarm.ocp.sample import Sample, symbolic_sample

if TYPE_CHECKING:
    from quietarm.ocp.figures import Figures

REPORT = "report"
NOTEBOOK = "notebook"
PAGE = "page"
COMPARISON = "comparison"
FRONT = "front"
FILE = "file"
EXPORT = "export"
CAPTION = "caption"
SWEEP = "sweep"
PLACES = frozenset(
    {REPORT, NOTEBOOK, PAGE, COMPARISON, FRONT, FILE, EXPORT, CAPTION, SWEEP},
)
"""Where figures stand: rows of a command, a notebook's table, the page to drag, the table of
motions in `compare`, csv and tables of fronts and of a bench, `stated` of a file, source that is
exported, captions, the dataset of a sweep with its tables and pictures."""
ValuesOf = Callable[[Sample], Sequence[Expression]]
"""A quantity's values by the sample of a plant."""


@dataclass(frozen=True)
class Quantity:
    """A quantity that a task may limit: an entry of `QUANTITIES`, and one's own by `add_quantity`.

    Attributes
    ----------
    name : str
        Its name: its limit is ``<name>_limit``, its peak ``peak_<name>``.
    unit : Unit
        Its SI unit, as `WAY / SECOND**2`.
    label : Words
        What it is, where the joint turns and where it slides.
    values : callable
        Its values by the sample of a plant.
    words : Words
        What messages call it; by default its name.
    derivative : int or None
        Which time derivative of the joint's angle it is; None where it follows from the modes.
    of_joints : bool
        Whether it has a value for each joint, so that a task may limit joints by name.
    in_scenarios : bool
        Whether its limit holds in all scenarios of an uncertain task; else for the nominal plant.
    panel : int
        Its place among the panels of a picture, from the joint's motion to the torque.
    always_drawn : bool
        Whether a picture of a motion has it where no task limits it, too.
    shown : frozenset of str
        Where its peak stands, some of `PLACES`.
    """

    example: ClassVar[str] = (
        "a quantity, such as Quantity('tip_haste', TIP / SECOND, Words('tip haste'), lambda "
        "sample: sample.tip_speeds), with unit and words of quietarm.models.dimensions"
    )

    name: str
    unit: Unit
    label: Words
    values: ValuesOf
    words: Words = NO_WORDS
    derivative: int | None = None
    of_joints: bool = False
    in_scenarios: bool = False
    panel: int = 5
    always_drawn: bool = False
    shown: frozenset[str] = frozenset({REPORT, NOTEBOOK, PAGE, COMPARISON})

    def __post_init__(self) -> None:
        instance("unit", self.unit, Unit)
        instance("label", self.label, Words)
        if self.words == NO_WORDS:
            object.__setattr__(self, "words", words_of(self.name.replace("_", " ")))

    @property
    def limit(self) -> str:
        """Name of its limit in a task."""
        return f"{self.name}_limit"

    @property
    def option(self) -> str:
        """Name of the option that limits the quantity on the command line."""
        return f"--{self.name.replace('_', '-')}-limit"

    @property
    def peak(self) -> str:
        """Name of its largest absolute value among the figures of a motion."""
        return f"peak_{self.name}"

    @property
    def joint(self) -> str:
        """The kind of joint whose unit and words these are."""
        return self.unit.joint

    def rows(self, plant: Plant) -> int:
        """Return the number of values at one time."""
        return len(self.values(symbolic_sample(plant)))

    @lru_cache(maxsize=256)  # noqa: B019 (of few values, which are kept anyway)
    def on(self, joint: str, tip_unit: str) -> Quantity:
        """Return this quantity in the units and words of a kind of joint, and of tip."""
        return replace(
            self,
            unit=self.unit.on(joint, tip_unit),
            label=self.label.on(joint),
            words=self.words.on(joint),
        )


_quantities: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity(
            name="torque",
            unit=EFFORT,
            label=Words("joint torque", "drive force"),
            values=lambda sample: sample.torques,
            of_joints=True,
            panel=6,
            always_drawn=True,
            shown=frozenset({REPORT, NOTEBOOK, PAGE, COMPARISON}),
        ),
        Quantity(
            name="speed",
            unit=SPEED,
            label=Words("joint speed"),
            values=lambda sample: [joint.speed for joint in sample.joints],
            derivative=1,
            of_joints=True,
            panel=1,
            always_drawn=True,
            shown=frozenset({REPORT, NOTEBOOK}),
        ),
        Quantity(
            name="acceleration",
            unit=ACCELERATION,
            label=Words("joint acceleration"),
            values=lambda sample: [joint.acceleration for joint in sample.joints],
            derivative=2,
            of_joints=True,
            panel=2,
            always_drawn=True,
            shown=frozenset({REPORT, NOTEBOOK, COMPARISON}),
        ),
        Quantity(
            name="jerk",
            unit=JERK,
            label=Words("joint jerk"),
            values=lambda sample: [joint.jerk for joint in sample.joints],
            derivative=3,
            of_joints=True,
            panel=3,
            shown=frozenset({REPORT}),
        ),
        Quantity(
            name="deflection",
            unit=TIP,
            label=Words("tip displacement"),
            values=lambda sample: sample.tips,
            in_scenarios=True,
            panel=4,
            always_drawn=True,
            shown=frozenset({REPORT, PAGE}),
        ),
    )
}
_OWN = frozenset(_quantities)
QUANTITIES: Mapping[str, Quantity] = MappingProxyType(_quantities)
"""Every quantity by its name. A new one is one entry here, or `add_quantity` in a file of one's
own: tasks, solvers, checks, options, objectives, figures, pictures, reports and files read it."""


@takes(quantity=Quantity)
def add_quantity(quantity: Quantity) -> Quantity:
    """Make a quantity of one's own known: to tasks, commands, fronts, pictures, reports and files.

    A file of one's own, as of ``--plant-file``, calls it; whatever loads files of such a task does
    so first. An entry of the same name that was added before is replaced.

    Raises
    ------
    ValueError
        When the name is taken by quietarm, or is none of Python, or its function fails.
    """
    name = quantity.name
    if name in _OWN or name in _RESERVED:
        raise ValueError(f"the quantity {name!r} is quietarm's own; give yours another name")
    if not name.isidentifier() or name != name.lower():
        raise ValueError(
            f"the name of a quantity is {quoted(name)}; give letters, digits and _, such as "
            "tip_speed"
        )
    _check_values(quantity)
    _quantities[name] = quantity
    note_added(quantity)
    return quantity


def _check_values(quantity: Quantity) -> None:
    """Refuse a quantity whose function fails, or gives no values; ValueError says where."""
    try:
        values = list(quantity.values(symbolic_sample(SingleLinkManipulator())))
    except Exception as error:  # of a function of one's own
        raise ValueError(
            f"the quantity {quantity.name!r} fails for a plant of one joint and one tip "
            f"({words_of_error(error)}); give a function of a Sample, as "
            "lambda sample: sample.tip_speeds"
        ) from None
    if not values or not all(isinstance(value, ca.SX | float | int) for value in values):
        raise ValueError(
            f"the quantity {quantity.name!r} returns {quoted(values)}; give a list of values, as "
            "sample.tip_speeds"
        )


@takes()
def remove_quantity(name: str) -> None:
    """Forget a quantity that was added, as at the end of a test; nothing where there is none."""
    if name not in _OWN:
        _quantities.pop(name, None)


def quantities_of(joint: str, tip_unit: str) -> Mapping[str, Quantity]:
    """Return `QUANTITIES` in a plant's units: m and N of a linear joint, rad if a tip turns."""
    return {name: quantity.on(joint, tip_unit) for name, quantity in QUANTITIES.items()}


def units_of_joints(name: str, plant: Plant) -> dict[str, str]:
    """Return the unit of a quantity for each joint of a plant, by the joint's name."""
    unit = QUANTITIES[name].unit
    joints = zip(plant.joint_names, plant.joint_kinds)
    return {joint: unit.of(kind, plant.tip_unit) for joint, kind in joints}


RESIDUAL = "residual"
TORQUE_SPEED = "torque_speed"
_RESERVED = (RESIDUAL, TORQUE_SPEED, "energy")
"""Names of what is limited, or shown, in other ways."""
OF_THIRD_ORDER = 3
"""The derivative of the angle that no plant needs, and that is nowhere where the acceleration
jumps."""
_RESIDUAL = Quantity(RESIDUAL, TIP, Words("residual vibration"), lambda _: [], in_scenarios=True)
"""It has no values on the way, and follows from the state on arrival."""
_OF_LINE = Words("share of the drive's torque", "share of the drive's force")
_LINE = Words("torque-speed", "force-speed")
Sides = float | tuple[float, float]
"""The largest absolute value, or the least and the largest one."""
Bounds = Sides | Mapping[str, Sides]
"""The same for all joints, or of some joints by name."""


class ByJoint(Mapping[str, Any]):
    """Values of some joints by name, as one value that does not change."""

    def __init__(self, entries: Mapping[str, Any]) -> None:
        self._entries = dict(entries)

    def __getitem__(self, name: str) -> Any:
        return self._entries[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __hash__(self) -> int:
        return hash(frozenset(self._entries.items()))

    def __repr__(self) -> str:
        return repr(self._entries)


class JointBounds(NamedTuple):
    """The bounds of a joint: its name, place among the joints, least and largest value, unit."""

    name: str
    place: int
    lower: float
    upper: float
    unit: str

    @property
    def text(self) -> str:
        """The bounds in words, as 50 N m."""
        return f"{_ends(self.lower, self.upper)} {self.unit}"

    def value(self, share: float) -> float:
        """Return the value that is such a share: -1 the least, 1 the largest."""
        return (self.upper + self.lower) / 2 + share * (self.upper - self.lower) / 2


@dataclass(frozen=True)
class Shares:
    """Values of a quantity of the joints, each between -1 at its least and 1 at its largest."""

    values: ValuesOf
    bounds: tuple[JointBounds, ...]

    def __call__(self, sample: Sample) -> Sequence[Expression]:
        """The shares, of the joints that have bounds."""
        values = self.values(sample)
        shares = list[Expression]()
        for bound in self.bounds:
            middle = (bound.upper + bound.lower) / 2
            half = (bound.upper - bound.lower) / 2
            shares.append((values[bound.place] - middle) / half)
        return shares

    def __str__(self) -> str:
        names = dict[str, list[str]]()
        for bound in self.bounds:
            names.setdefault(bound.text, []).append(bound.name)
        return "; ".join(f"{', '.join(joints)} {ends}" for ends, joints in names.items())


def sides_of(bounds: Sides) -> tuple[float, float]:
    """The least and the largest value."""
    return bounds if isinstance(bounds, tuple) else (-bounds, bounds)


def _ends(lower: float, upper: float) -> str:
    return f"{upper:g}" if lower == -upper else f"{lower:g} to {upper:g}"


def ask_for_jerk(quantities: Iterable[Quantity]) -> bool:
    """Return whether any of these quantities follows from the joint's jerk; no plant needs it."""
    return any(quantity.derivative == OF_THIRD_ORDER for quantity in quantities)


@dataclass(frozen=True)
class TorqueSpeedLine:
    """The torque that a drive gives at each speed; as values shares of it that are asked for.

    It falls with the speed, ever steeper; before the first point it is even, beyond the last it
    goes on as it fell. A torque is within a piece a - b |speed| where torque + b speed and
    torque - b speed both are within a, which is smooth.

    Parameters
    ----------
    points : tuple of (float, float)
        Torques [N m] at speeds [rad/s] that rise.
    joint : str
        The kind of joint; of a linear one they are forces [N] and speeds [m/s].

    Raises
    ------
    ValueError
        When there are fewer than two points, or the torque does not fall ever steeper.
    """

    points: tuple[tuple[float, float], ...]
    joint: str = ROTARY

    def __post_init__(self) -> None:
        words = TORQUE.of(self.joint)
        try:
            pairs = [(torque, speed) for torque, speed in self.points]
        except (TypeError, ValueError):
            raise ValueError(
                f"torque-speed line is {quoted(self.points)}; give pairs of a {words} and a speed, "
                "as [(1.5, 0), (0.8, 20)]"
            ) from None
        most_points = 50  # each is two limits at every node
        if len(pairs) > most_points:
            raise ValueError(
                f"torque-speed line has {len(pairs)} points; give at most {most_points}"
            )
        unit, unit_of_speed = (unit.of(self.joint) for unit in (EFFORT, SPEED))
        points = tuple(
            (not_negative(f"{words} of the line", torque, unit),
             not_negative("speed of the line", speed, unit_of_speed))
            for torque, speed in pairs
        )  # fmt: skip
        object.__setattr__(self, "points", points)
        rises = len(points) > 1 and all(first[1] < second[1] for first, second in pairwise(points))
        falls = [fall for _, fall in self._pieces] if rises else [0.0]
        if falls[-1] <= 0 or falls != sorted(falls) or falls[0] < 0:
            example = TorqueSpeedLine(((1.5, 0.0), (0.8, 20.0)), self.joint)
            raise ValueError(
                f"torque-speed line is {self}; give two points or more by rising speed, between "
                f"which the {words} falls ever steeper, such as {example}"
            )

    @property
    def _pieces(self) -> list[tuple[float, float]]:
        """Torque at no speed [N m], and its fall with the speed [N m s], of each piece."""
        pieces = [(self.points[0][0], 0.0)] if self.points[0][1] > 0 else []
        for (above, before), (below, after) in pairwise(self.points):
            fall = (above - below) / (after - before)
            pieces.append((above + fall * before, fall))
        return pieces

    @property
    def largest_speed(self) -> float:
        """The speed at which no torque is left [rad/s]."""
        return min(torque / fall for torque, fall in self._pieces if fall)

    def __call__(self, sample: Sample) -> Sequence[Expression]:
        """Each joint's torque as shares of what a piece gives, in both directions of the speed."""
        signs = {True: (1, -1), False: (1,)}
        return [
            (torque + sign * fall * joint.speed) / most
            for torque, joint in zip(sample.torques, sample.joints)
            for most, fall in self._pieces
            for sign in signs[fall > 0]
        ]

    def __str__(self) -> str:
        unit = "" if self.joint == MIXED else EFFORT.on(self.joint).typed
        return ",".join(f"{torque:g}{unit}@{speed:g}" for torque, speed in self.points)


@dataclass(frozen=True)
class Limit:
    """Bounds on a quantity on the way, or on the residual after it.

    Attributes
    ----------
    quantity : Quantity
        What is bounded.
    lower, upper : float
        Least and largest value [SI unit]; 0 lies between them, and both are infinite where nothing
        is bounded.
    """

    quantity: Quantity
    lower: float
    upper: float

    @classmethod
    def within(cls, quantity: Quantity, bounds: Bounds, plant: Plant) -> Limit:
        """Make the limit of a task's entry; joints' own bounds become shares of these."""
        if not isinstance(bounds, Mapping):
            return cls(quantity, *sides_of(bounds))
        units = units_of_joints(quantity.name, plant)
        by_joint = tuple(
            JointBounds(name, list(units).index(name), *sides_of(sides), units[name])
            for name, sides in bounds.items()
        )
        shares = Shares(quantity.values, by_joint)
        return cls(replace(quantity, unit=NONE.on(plant.joint), values=shares), -1.0, 1.0)

    @classmethod
    def of_residual(cls, largest: float, tip_unit: str = "m") -> Limit:
        """Make the limit of the residual, in the tip's unit: 0 asks for rest on arrival."""
        return cls(_RESIDUAL.on(ROTARY, tip_unit), -largest, largest)

    @classmethod
    def of_line(cls, line: TorqueSpeedLine) -> Limit:
        """Make the limit of the torque by a torque-speed line."""
        return cls(
            Quantity(
                TORQUE_SPEED,
                NONE.on(line.joint),
                _OF_LINE,
                line,
                words=_LINE.on(line.joint),
            ),
            -1.0,
            1.0,
        )

    @property
    def name(self) -> str:
        """Name of the quantity."""
        return self.quantity.name

    @property
    def label(self) -> str:
        """Name in messages: torque-speed, or the quantity; of a linear joint a force."""
        return str(self.quantity.words)

    @property
    def both_ways(self) -> bool:
        """Return whether the limit is the same in both directions."""
        return self.lower == -self.upper

    @property
    def is_of_shares(self) -> bool:
        """Return whether it has bounds for each joint, so that its values are shares of these."""
        return isinstance(self.quantity.values, Shares)

    @property
    def is_peak(self) -> bool:
        """Return whether it limits the largest absolute value of a quantity in the diagnostics."""
        alike = not self.is_of_shares and self.both_ways
        return alike and self.name in (RESIDUAL, *QUANTITIES)

    def bounds_of_joints(self, plant: Plant) -> tuple[JointBounds, ...]:
        """Return the bounds of each joint that it limits; none of a plant of one joint.

        They are in the order of its values. What is limited beside the joints has none either.
        """
        if isinstance(self.quantity.values, Shares):
            return self.quantity.values.bounds
        if len(plant.joint_names) < 2 or not self.quantity.of_joints:
            return ()
        units = units_of_joints(self.name, plant)
        return tuple(
            JointBounds(joint, place, self.lower, self.upper, unit)
            for place, (joint, unit) in enumerate(units.items())
        )

    @property
    def size(self) -> float:
        """The larger bound."""
        return max(-self.lower, self.upper)

    @property
    def sides(self) -> tuple[float, float]:
        """Both bounds as shares of the size."""
        return (-1.0, 1.0) if self.both_ways else (self.lower / self.size, self.upper / self.size)

    def peak(self, least: Any, largest: Any) -> Any:
        """Return how large values from the least to the largest are, to compare with the size.

        The largest absolute one; of a direction with a smaller bound values count for more.
        """
        below, above = self.sides
        return np.maximum(least / below, largest / above)

    def peak_of(self, figures: Figures) -> float:
        """The quantity's peak by a motion's figures, to compare with `size`."""
        return float(self.peak(*figures.range_of(self.quantity)))

    def keeps(self, peak: float, tolerance: float = 0.0, at_rest: float = 0.0) -> bool:
        """Return whether a peak is within the limit, by a share, or a residual counts as rest."""
        return peak <= max(self.size * (1 + tolerance), at_rest if self.name == RESIDUAL else 0.0)

    def price(self, multipliers: NDArray[np.float64]) -> float:
        """Return how far the objective falls if the limit widens, by its values' multipliers."""
        below, above = self.sides
        return float(np.where(multipliers > 0, above, below) @ multipliers)

    def tightened(self, ratio: float) -> Limit:
        """The limit divided by a ratio."""
        return Limit(self.quantity, self.lower / ratio, self.upper / ratio)

    def widened_to(self, size: float) -> Limit:
        """The limit with another size; the same in both directions where it has none."""
        below, above = self.sides if self.size > 0 else (-1.0, 1.0)
        return Limit(self.quantity, below * size, above * size)

    def describe(self, peak: float) -> str:
        """A peak in words: in its unit, or where no single number tells, in times of the limit."""
        if self.is_peak:
            return f"{peak:.4g} {self.quantity.unit}"
        whole = "the line" if self.name == TORQUE_SPEED else "that"
        return f"{peak / self.size:.4g} times {whole}"

    @property
    def bounds(self) -> str:
        """The bounds in words, such as 0.3 N m or -30 to 40 rad/s^2."""
        if isinstance(self.quantity.values, TorqueSpeedLine | Shares):
            return str(self.quantity.values)
        return f"{_ends(self.lower, self.upper)} {self.quantity.unit}"

    def __str__(self) -> str:
        return f"{self.label} {self.bounds}"
