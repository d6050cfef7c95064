"""What is asked: a move in a given time within limits; and in what two tasks differ."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from math import isclose
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Plant, known_plants
from quietarm.models.joint_motion import LINEAR, joint_unit
from quietarm.models.validation import check_along, check_contract
from quietarm.ocp.checks import finite, has_no, instance, numbers, positive, quoted, several, takes
from quietarm.ocp.energy import ABSOLUTE_POWER, Energy, check_energy
from quietarm.ocp.limits import (
    QUANTITIES,
    Bounds,
    ByJoint,
    Limit,
    Quantity,
    Sides,
    TorqueSpeedLine,
    quantities_of,
    units_of_joints,
)
from quietarm.ocp.uncertainty import Scenario, Uncertainty, check_ranges, perturb_plant
from quietarm.ocp.window import EQ_11, DefaultWindow, default_window, longest_window


@dataclass(frozen=True)
class ModalState:
    """Modal amplitudes and their rates at one time.

    Parameters
    ----------
    W, dW : sequence of float
        Amplitudes [m] and their rates W' [m/s], one for each mode of the plant.

    Raises
    ------
    ValueError
        When a number is not finite, or the rates do not match the amplitudes.
    """

    example: ClassVar[str] = "a state, as ModalState(W=[0.01], dW=[0.0])"

    W: tuple[float, ...]
    dW: tuple[float, ...]

    def __post_init__(self) -> None:
        for name, unit in (("W", "m"), ("dW", "m/s")):
            modes = several(name, getattr(self, name), "numbers, one for each mode")
            numbers = tuple(
                finite(f"{name} of mode {i}", number, unit)
                for i, number in enumerate(modes, start=1)
            )
            object.__setattr__(self, name, numbers)
        if len(self.W) != len(self.dW):
            raise ValueError(
                f"the state has {len(self.W)} amplitudes and {len(self.dW)} rates; give one of "
                "each for every mode"
            )


OF_MOVES = {"start": "rad", "target": "rad", "duration": "s"}
"""What a move has, by name, with its unit."""
_UNITS = (
    OF_MOVES
    | {"residual window": "s"}
    | {f"{quantity.name} limit": quantity.unit for quantity in QUANTITIES.values()}
)
LEAST_DURATION = 1e-6
LEAST_MOVE = 1e-9
"""Below these [s, rad or m] the integrators' absolute tolerances do not suffice."""
_SMALL_MOVE = 1e-3
"""A shorter move [rad or m] has absolute tolerances that are smaller in proportion."""


@dataclass(frozen=True)
class PointToPoint:
    """A point-to-point move of a plant's joint.

    Parameters
    ----------
    plant : Plant
        What moves.
    target, duration, start : float
        Joint angle at the end [rad], travelling time [s], joint angle at the beginning [rad]; of a
        linear joint, here and below, positions [m] and forces [N].
    torque_limit, speed_limit, acceleration_limit, deflection_limit, jerk_limit : optional
        Largest absolute joint torque [N m], speed [rad/s], acceleration [rad/s^2], tip displacement
        [m] and rate of change of the joint's acceleration [rad/s^3] on the way; or of each the
        least value and the largest one, as (-30, 40). Those of joints may be by name, each as
        above: ``{"joint_1": 16.0, "joint_2": (-30, 40)}``; joints without a name have no limit.
    torque_speed : sequence of (float, float), optional
        Largest torque [N m] of the drive at speeds [rad/s], as [(1.5, 0), (0.8, 20)]; of a linear
        joint forces [N] at speeds [m/s]. See `TorqueSpeedLine`.
    residual_window : float, optional
        Time after arrival in which the residual is measured [s]. By default, or None, eq (11)'s
        1 s, or two periods of the nominal plant's slowest mode at the target where these are
        longer, and less where a mode is too fast for 1 s; `dataclasses.replace` with another plant
        or target then works it out again.
    initial, final : ModalState, optional
        States at the start (of every scenario) and wanted on arrival; at rest by default. The
        residual is measured from the free vibration that begins with `final`.
    energy : Energy, optional
        What counts as F2; the paper's absolute power by default.
    uncertainty : Uncertainty, optional
        Ranges of the plant's parameter errors; none by default.

    Raises
    ------
    ValueError
        When a value is out of range, or the plant breaks its contract.

    Warns
    -----
    UserWarning
        When an angle beyond a turn looks like degrees, as 30 or 22.5.
    """

    example: ClassVar[str] = (
        "a task, as PointToPoint(SingleLinkManipulator(), target=deg(30), duration=0.8)"
    )

    plant: Plant
    target: float
    duration: float
    start: float = 0.0
    torque_limit: Bounds | None = None
    speed_limit: Bounds | None = None
    acceleration_limit: Bounds | None = None
    deflection_limit: Bounds | None = None
    residual_window: float = DefaultWindow(EQ_11)
    jerk_limit: Bounds | None = None
    initial: ModalState | None = None
    final: ModalState | None = None
    energy: Energy = ABSOLUTE_POWER
    uncertainty: Uncertainty | None = None
    torque_speed: tuple[tuple[float, float], ...] | None = None

    @classmethod
    def of(cls, plant: Plant, target: float, duration: float, **others: Any) -> PointToPoint:
        """The move of a plant within limits of its own, `Plant.limits`; with other keywords.

        A limit that is given is in the place of the plant's own of that quantity, and None is none.

        Raises
        ------
        ValueError
            As of the class, and when the plant has a limit of something else.
        """
        instance("plant", plant, Plant)
        own = dict[str, Any]()
        for name, bounds in plant.limits.items():
            if name not in QUANTITIES:
                raise ValueError(has_no(plant.name, "limit of", name, QUANTITIES))
            if bounds:
                own[QUANTITIES[name].limit] = bounds
        return cls(plant, target, duration, **{**own, **others})

    def __post_init__(self) -> None:
        if not isinstance(self.plant, Plant):
            known_plants()  # so that each is known by its name
            instance("plant", self.plant, Plant)
        self.plant.validate()
        check_energy(self.energy)
        optional = {"initial": ModalState, "final": ModalState, "uncertainty": Uncertainty}
        for name, kind in optional.items():
            if getattr(self, name) is not None:
                instance(name, getattr(self, name), kind)
        if self.uncertainty is not None:
            check_ranges(self.plant, self.ranges)
        follows = _is_default(self.residual_window)
        unit = joint_unit("rad", self.plant.joint)
        # Beyond this [rad, m, s] no joint moves, and double precision does not follow.
        most = 1e6
        for name in ("start", "target"):
            number = finite(name, getattr(self, name), unit, most)
            object.__setattr__(self, name, number)
        for name in ("duration",) if follows else ("duration", "residual_window"):
            number = positive(name.replace("_", " "), getattr(self, name), "s", most)
            object.__setattr__(self, name, number)
        self._check_limits()
        for name, angle in (("start", self.start), ("target", self.target)):
            more = unit == "rad" and abs(angle) > 2 * math.pi
            if more and (2 * angle).is_integer():  # no multiple of pi is
                warnings.warn(
                    f"{name} is {angle:g} rad, more than a turn; were degrees meant? give "
                    f"quietarm.deg({angle:g})",
                    stacklevel=3,
                )
        self._check_move(unit)
        for plant in self.perturbed_plants:
            check_contract(plant)
            check_along(plant, self.start, self.target)
        if follows:
            window = min(default_window([(self.plant, self.target)]), DefaultWindow(most))
            resolved = longest_window((plant, self.target) for plant in self.perturbed_plants)
            window = min(window, DefaultWindow(resolved))
            object.__setattr__(self, "residual_window", window)

    def _check_limits(self) -> None:
        """Read the limits; ValueError where one is out of range."""
        for quantity in quantities_of(self.plant.joint, self.plant.tip_unit).values():
            if getattr(self, quantity.limit) is not None:
                bounds = _check_bounds(quantity, getattr(self, quantity.limit), self.plant)
                object.__setattr__(self, quantity.limit, bounds)
        if self.torque_speed is not None:
            line = TorqueSpeedLine(self.torque_speed, self.plant.joint)
            object.__setattr__(self, "torque_speed", line.points)

    def _check_move(self, unit: str) -> None:
        """Refuse a move that is too small, too quick, or beyond the plant's path or modes."""
        if abs(self.span) < LEAST_MOVE:
            raise ValueError(
                f"target - start is {self.span:g} {unit}: there is no move; change one of them by "
                f"{LEAST_MOVE:g} {unit} or more"
            )
        if self.plant.path_range is not None:
            least, largest = self.plant.path_range
            for name, place in (("start", self.start), ("target", self.target)):
                if not least <= place <= largest:
                    raise ValueError(
                        f"{name} is {place:g} and {self.plant.name} is defined from {least:g} to "
                        f"{largest:g}; give one within that range"
                    )
        if self.duration < LEAST_DURATION:
            raise ValueError(f"duration is {self.duration:g} s; give at least {LEAST_DURATION:g} s")
        modes = self.plant.modes
        for name, state in (("initial", self.initial), ("final", self.final)):
            if state is not None and len(state.W) != modes:
                raise ValueError(
                    f"the {name} state has {len(state.W)} modes and {self.plant.name} has {modes}; "
                    "give W and W' of each"
                )

    @property
    def span(self) -> float:
        """Target - start [rad]."""
        return self.target - self.start

    @property
    def smallness(self) -> float:
        """What absolute tolerances are multiplied by: 1, and less for a move below 1 mm or mrad."""
        return min(1.0, abs(self.span) / _SMALL_MOVE)

    @property
    def ends(self) -> str:
        """From where to where in words: "0 to 30 deg", of joints on a path places on it."""
        if self.plant.has_path:
            whole = (self.start, self.target) == (0.0, 1.0)
            return (
                "along its path" if whole else f"{self.start:.6g} to {self.target:.6g} of the path"
            )
        factor, unit = (1e3, "mm") if self.plant.joint == LINEAR else (math.degrees(1.0), "deg")
        places = [factor * self.start, factor * self.target]
        longest = max(map(abs, places))
        # 0.5236 rad are 30 deg: five figures of the longer of both, and none of rounding errors
        decimals = 5 - math.ceil(math.log10(longest)) if longest > 0 else 0
        first, last = (round(place, decimals) + 0.0 for place in places)  # never a negative zero
        return f"{first:.6g} to {last:.6g} {unit}"

    @property
    def move(self) -> tuple[float, float, float]:
        """(start, target, duration)."""
        return (self.start, self.target, self.duration)

    @property
    def row(self) -> tuple[float, ...]:
        """The move, then W and W' at the start, the parameters of every compiled function."""
        return (*self.move, *self.initial_state)

    @property
    def initial_state(self) -> tuple[float, ...]:
        """W [m], then W' [m/s] at the start."""
        return self._numbers_of(self.initial)

    @property
    def final_state(self) -> tuple[float, ...]:
        """W [m], then W' [m/s] wanted on arrival."""
        return self._numbers_of(self.final)

    def _numbers_of(self, state: ModalState | None) -> tuple[float, ...]:
        return (0.0,) * (2 * self.plant.modes) if state is None else (*state.W, *state.dW)

    def missed(self, arrival: ArrayLike) -> NDArray[np.float64]:
        """States on arrival less the wanted one."""
        states = numbers("states on arrival", arrival, "numbers in m and m/s", infinite=True)
        count = len(self.final_state)
        if not states.ndim or states.shape[-1] != count:
            raise ValueError(
                f"states on arrival have shape {states.shape}; give (states, {count}), W and W' of "
                "each mode"
            )
        return states - self.final_state

    @property
    def ranges(self) -> Mapping[str, float]:
        """Largest relative errors of the plant's parameters by name; may be empty."""
        return {} if self.uncertainty is None else self.uncertainty.ranges

    @property
    def error_names(self) -> tuple[str, ...]:
        """Names of the errors that a scenario has."""
        return tuple(self.ranges)

    @property
    def scenarios(self) -> tuple[Scenario, ...]:
        """Errors of the plants whose residual counts; the first are none, of the nominal plant."""
        samples = () if self.uncertainty is None else self.uncertainty.samples
        return ((0.0,) * len(self.ranges), *samples)

    @cached_property
    def perturbed_plants(self) -> tuple[Plant, ...]:
        """The plant in every scenario, the nominal one first."""
        by_name = (dict(zip(self.ranges, errors)) for errors in self.scenarios[1:])
        return (self.plant, *(perturb_plant(self.plant, errors) for errors in by_name))

    @property
    def certain(self) -> PointToPoint:
        """The move of the nominal plant alone."""
        return self if self.uncertainty is None else replace(self, uncertainty=None)

    def with_samples(self, samples: Iterable[Sequence[float]]) -> PointToPoint:
        """The move with these samples of its uncertainty."""
        rows = tuple(several("samples", samples, "rows of errors, one for each scenario"))
        return replace(self, uncertainty=Uncertainty(self.ranges, rows))

    @property
    def limits(self) -> tuple[Limit, ...]:
        """The limits that are set."""
        quantities = quantities_of(self.plant.joint, self.plant.tip_unit).values()
        stated = [(quantity, getattr(self, quantity.limit)) for quantity in quantities]
        limits = [
            Limit.within(quantity, bounds, self.plant)
            for quantity, bounds in stated
            if bounds is not None
        ]
        if self.torque_speed is not None:
            line = TorqueSpeedLine(self.torque_speed, self.plant.joint)
            limits.append(Limit.of_line(line))
        return tuple(limits)

    def limit_of(self, name: str) -> Limit | None:
        """The limit of a quantity by name; None where it has none."""
        return next((limit for limit in self.limits if limit.name == name), None)


def _is_default(window: object) -> bool:
    """Whether a residual window was not given: it was worked out for another task, or for none."""
    return window is None or isinstance(window, DefaultWindow)


def _check_bounds(quantity: Quantity, value: Any, plant: Plant) -> Bounds:
    """A positive number, or a negative and a positive one; or such of joints by name."""
    name = quantity.limit.replace("_", " ")
    if not isinstance(value, Mapping):
        return _check_sides(name, quantity.unit, value)
    if not quantity.of_joints:
        raise ValueError(
            f"{name} is {quoted(value)}; give one for all, as {quantity.label}s have no joint"
        )
    if not value:
        raise ValueError(f"{name} is {quoted(value)}; give a limit of one joint or more, by name")
    for joint in value:
        if joint not in plant.joint_names:
            raise ValueError(has_no(plant.name, "joint", joint, plant.joint_names))
    units = units_of_joints(quantity.name, plant)
    return ByJoint(
        {
            joint: _check_sides(f"{name} of {joint}", units[joint], bounds)
            for joint, bounds in value.items()
        }
    )


def _check_sides(name: str, unit: str, value: Any) -> Sides:
    """A positive number, or a negative and a positive one."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        return positive(name, value, unit)
    bounds: list[Any] = list(value)
    if len(bounds) != 2:
        raise ValueError(
            f"{name} is {quoted(value)}; give one number, or the least and the largest"
        )
    lower, upper = (finite(name, side, unit) for side in bounds)
    if not lower < 0 < upper:
        raise ValueError(
            f"{name} is {lower:g} to {upper:g} {unit}; give a negative and a positive number"
        )
    return upper if lower == -upper else (lower, upper)


@takes(task=PointToPoint, reference=PointToPoint)
def task_difference(task: PointToPoint, reference: PointToPoint) -> str:
    """Every entry in which two tasks differ, in words; empty where they are the same.

    Numbers are the same within rounding; states of rest are the same, given or not.
    """
    if task.plant.name != reference.plant.name:
        return f"plant is {task.plant.name}, not {reference.plant.name}"
    entries = dict(_entries(_stated(task)))
    expected = dict(_entries(_stated(reference)))
    joint = task.plant.joint
    return ", ".join(
        f"{name} is {_words(name, entries.get(name), joint)}, "
        f"not {_words(name, expected.get(name), joint)}"
        for name in entries | expected
        if not _same(entries.get(name), expected.get(name))
    )


def _stated(task: PointToPoint) -> dict[str, object]:
    """All that a task has, by words; states are numbers, given or not."""
    # Fields that are told in another way.
    apart = "plant", "initial", "final", "energy", "uncertainty"
    plain = (entry.name for entry in fields(task) if entry.name not in apart)
    return {
        "plant parameter": task.plant.parameters,
        **{name.replace("_", " "): getattr(task, name) for name in plain},
        "initial state": task.initial_state,
        "final state": task.final_state,
        "energy": task.energy.label,
        "error of": task.ranges,
        "scenario": task.scenarios[1:],
    }


def _entries(value: object, name: str = "") -> Iterator[tuple[str, object]]:
    """Names and values of numbers and words in mappings and sequences."""
    match value:
        case Mapping():
            for key, entry in value.items():
                yield from _entries(entry, f"{name} {key}".strip())
        case list() | tuple():
            for place, entry in enumerate(value, start=1):
                yield from _entries(entry, f"{name} {place}")
        case _:
            yield name, value


def _same(first: object, second: object) -> bool:
    # Relative and absolute difference below which numbers are one: 30deg and pi/6.
    relative = 1e-9
    absolute = 1e-15
    if isinstance(first, float | int) and isinstance(second, float | int):
        return isclose(first, second, rel_tol=relative, abs_tol=absolute)
    return first == second


def _words(name: str, value: object, joint: str) -> str:
    if value is None:
        return "none"
    unit = joint_unit(_UNITS.get(name, ""), joint)
    return f"{value:.10g} {unit}".strip() if isinstance(value, float) else str(value)
