"""The task: a move in a given time within limits; and the differences of two tasks."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from math import isclose
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Plant, known_plants
from quietarm.models.dimensions import EFFORT, NONE, SECOND, TIP, TORQUE, WAY, Unit
from quietarm.models.joint_motion import LINEAR
from quietarm.models.validation import check_along, check_contract
from quietarm.ocp.checks import (
    IF_STATED,
    finite,
    has_no,
    instance,
    numbers,
    positive,
    quoted,
    several,
    takes,
    unknown,
)
from quietarm.ocp.energy import ABSOLUTE_POWER, Energy, check_energy
from quietarm.ocp.limits import (
    QUANTITIES,
    Bounds,
    ByJoint,
    Limit,
    Quantity,
    Sides,
    TorqueSpeedLine,
    sides_of,
    units_of_joints,
)
from quietarm.ocp.uncertainty import (
    FREQUENCY,
    Scenario,
    Uncertainty,
    check_ranges,
    perturb_plant,
)
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

    example: ClassVar[str] = "a state, such as ModalState(W=[0.01], dW=[0.0])"

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


OF_MOVES: Mapping[str, Unit] = {"start": WAY, "target": WAY, "duration": SECOND}
"""What a move has, by name, with its unit."""
LEAST_DURATION = 1e-6
LEAST_MOVE = 1e-9
"""Below these [s, rad or m] the integrators' absolute tolerances do not suffice."""
MARGIN = 3.0
"""A band is so many times the residual limit: servo, dry friction and backlash of a machine, which
no plant has, leave as much again and more. docs/drive_margin.md has what they leave."""
RANGE_OF_BAND: Mapping[str, float] = {FREQUENCY: 0.05}
"""Errors within which the tip stays in a band where nobody says them."""
_SMALL_MOVE = 1e-3
"""A shorter move [rad or m] has absolute tolerances that are smaller in proportion."""
_LIMIT = "_limit"
"""How the keyword of a quantity's limit ends."""


class _NotGiven:
    """The default of a limit: `replace` keeps what the task has, where None takes it away."""

    def __repr__(self) -> str:
        return "None"


_NOT_GIVEN: Any = _NotGiven()


@dataclass(frozen=True, init=False)
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
    **limits : optional
        The same of every other quantity of `QUANTITIES`, as ``tip_acceleration_limit=3.0``.
    torque_speed : sequence of (float, float), optional
        Largest torque [N m] of the drive at speeds [rad/s], as [(1.5, 0), (0.8, 20)]; of a linear
        joint forces [N] at speeds [m/s]. See `TorqueSpeedLine`.
    band : float, optional
        Largest distance of the tip from its target after arrival [m], static sag included, for all
        errors of the `uncertainty`; it is less than the tip moves. The residual limit of plans and
        fronts is then by default the band over the `margin`, and their figure `acts_after` is the
        time until the tip stays within the band. A band is for a range of errors: where no
        uncertainty is given, or None, by a `replace` as well, it is 5 % of the frequency.
    margin : float, optional
        How many times the residual limit the band is, 1 or more; 3 by default, for what servo and
        dry friction of a machine leave beside the plant's vibration.
    residual_window : float, optional
        Time after arrival in which the residual is measured [s]. By default, or None, eq (11)'s
        1 s, or two periods of the nominal plant's slowest mode at the target where these are
        longer, and less where a mode is too fast for 1 s; `dataclasses.replace` with another plant
        or target then works it out again.
    initial, final : ModalState, optional
        States at the start (of every scenario) and wanted on arrival; at rest by default. The
        residual is measured from the free vibration that begins with `final`.
    energy : Energy, optional
        What counts as energy; the paper's absolute power by default.
    uncertainty : Uncertainty, optional
        Ranges of the plant's parameter errors; none by default.
    bounds : mapping of str to bounds, optional
        The limits by the names of their quantities, ``{"torque": 0.2}``; `replace` with an empty
        one takes all away. A keyword of a limit counts for more.

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
        "a task, such as PointToPoint(SingleLinkManipulator(), target=deg(30), duration=0.8)"
    )

    plant: Plant
    target: float
    duration: float
    start: float = 0.0
    bounds: Mapping[str, Bounds] = field(default_factory=dict)
    residual_window: float = DefaultWindow(EQ_11)
    initial: ModalState | None = None
    final: ModalState | None = None
    energy: Energy = ABSOLUTE_POWER
    uncertainty: Uncertainty | None = None
    torque_speed: tuple[tuple[float, float], ...] | None = None
    band: float | None = field(default=None, metadata=IF_STATED)
    margin: float = field(default=MARGIN, metadata=IF_STATED)

    @classmethod
    def of(cls, plant: Plant, target: float, duration: float, **others: Any) -> PointToPoint:
        """The move of a plant within limits of its own, `Plant.limits`; with other keywords.

        A limit that is given is in the place of the plant's own of that quantity, and None is none.
        One that is given by joint is in the place of those joints' own: all others keep theirs.

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
        limits = {
            name: _joined(plant, own.get(name), given) if name.endswith(_LIMIT) else given
            for name, given in others.items()
        }
        return cls(plant, target, duration, **{**own, **limits})

    def __init__(
        self,
        plant: Plant,
        target: float,
        duration: float,
        start: float = 0.0,
        torque_limit: Bounds | None = _NOT_GIVEN,
        speed_limit: Bounds | None = _NOT_GIVEN,
        acceleration_limit: Bounds | None = _NOT_GIVEN,
        deflection_limit: Bounds | None = _NOT_GIVEN,
        residual_window: float | None = DefaultWindow(EQ_11),
        jerk_limit: Bounds | None = _NOT_GIVEN,
        initial: ModalState | None = None,
        final: ModalState | None = None,
        energy: Energy = ABSOLUTE_POWER,
        uncertainty: Uncertainty | None = None,
        torque_speed: Sequence[tuple[float, float]] | None = None,
        *,
        bounds: Mapping[str, Bounds] | None = None,
        band: float | None = None,
        margin: float = MARGIN,
        **limits: Bounds | None,
    ) -> None:
        if uncertainty is None and band is not None:
            uncertainty = Uncertainty(RANGE_OF_BAND)
        given = {
            "torque_limit": torque_limit,
            "speed_limit": speed_limit,
            "acceleration_limit": acceleration_limit,
            "deflection_limit": deflection_limit,
            "jerk_limit": jerk_limit,
            **limits,
        }
        entries = {
            "plant": plant,
            "target": target,
            "duration": duration,
            "start": start,
            "bounds": _merged(bounds, given),
            "residual_window": residual_window,
            "initial": initial,
            "final": final,
            "energy": energy,
            "uncertainty": uncertainty,
            "torque_speed": torque_speed,
            "band": band,
            "margin": margin,
        }
        for name, value in entries.items():
            object.__setattr__(self, name, value)
        self.__post_init__()

    if TYPE_CHECKING:  # names that editors know; at run time there is one for every quantity

        @property
        def torque_limit(self) -> Bounds | None:
            """Bounds of the joint's torque; None where it has none."""
            ...

        @property
        def speed_limit(self) -> Bounds | None:
            """Bounds of the joint's speed; None where it has none."""
            ...

        @property
        def acceleration_limit(self) -> Bounds | None:
            """Bounds of the joint's acceleration; None where it has none."""
            ...

        @property
        def deflection_limit(self) -> Bounds | None:
            """Bounds of the tip's displacement; None where it has none."""
            ...

        @property
        def jerk_limit(self) -> Bounds | None:
            """Bounds of the joint's jerk; None where it has none."""
            ...

    else:

        def __getattr__(self, name: str) -> Bounds | None:
            """Return the bounds of a quantity by its limit's keyword; None where it has none."""
            quantity = name.removesuffix(_LIMIT)
            if quantity == name or quantity not in QUANTITIES or "bounds" not in vars(self):
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            return self.bounds.get(quantity)

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
        unit = WAY.of(self.plant.joint)
        # Beyond this [rad, m, s] no joint moves, and double precision does not follow.
        most = 1e6
        for name in ("start", "target"):
            number = finite(name, getattr(self, name), unit, most)
            object.__setattr__(self, name, number)
        for name in ("duration",) if follows else ("duration", "residual_window"):
            number = positive(name.replace("_", " "), getattr(self, name), "s", most)
            object.__setattr__(self, name, number)
        self._check_limits()
        self._check_band()
        for name, angle in (("start", self.start), ("target", self.target)):
            more = unit == "rad" and abs(angle) > 2 * math.pi
            if more and (2 * angle).is_integer():  # no multiple of pi is
                warnings.warn(
                    f"{name} is {angle:g} rad, more than a turn; were degrees meant? give "
                    f"quietarm.deg({angle:g})",
                    stacklevel=3,
                )
        self._check_move(unit)
        self._check_band_of_move()
        self._check_friction()
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
        for name in self.bounds:
            if name not in QUANTITIES:
                raise ValueError(unknown("limit", name, QUANTITIES))
        bounds = {
            quantity.name: _check_bounds(quantity, self.bounds[quantity.name], self.plant)
            for quantity in self._limited
        }
        object.__setattr__(self, "bounds", ByJoint(bounds))
        if self.torque_speed is not None:
            line = TorqueSpeedLine(self.torque_speed, self.plant.joint)
            object.__setattr__(self, "torque_speed", line.points)

    def _check_band(self) -> None:
        """Read band and margin; ValueError where there is no such band."""
        margin = finite("margin", self.margin)
        if margin < 1:
            raise ValueError(
                f"margin is {margin:g}, so that the residual limit would be beyond the band; give "
                f"1 or more, such as {MARGIN:g}"
            )
        object.__setattr__(self, "margin", margin)
        if self.band is None:
            return
        if self.plant.tip_unit != "m":
            raise ValueError(
                f"band is {quoted(self.band)} m, and the tip of {self.plant.name} turns, in "
                f"{self.plant.tip_unit}; give a residual limit and an uncertainty in its place"
            )
        object.__setattr__(self, "band", positive("band", self.band, "m"))

    def _check_band_of_move(self) -> None:
        """Refuse a band that the tip is within before it moves, where its way is known."""
        reach = self.plant.tip_reach
        if reach is None and self.plant.joint == LINEAR:
            reach = 1.0
        if self.band is None or reach is None or self.plant.has_path:
            return
        way = abs(reach * self.span)
        if self.band >= way:
            raise ValueError(
                f"band is {self.band:g} m, and the tip moves {way:.4g} m; give a band below it"
            )

    @property
    def band_limit(self) -> float | None:
        """The residual limit by the band [m], its share by the margin; None without a band."""
        return None if self.band is None else self.band / self.margin

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

    def _check_friction(self) -> None:
        """Refuse a limit of the torque that dry friction takes whole."""
        drive = self.plant.drive
        bounds = self.bounds.get("torque")
        if isinstance(bounds, Mapping):
            bounds = bounds.get(self.plant.joint_names[0])
        if drive is None or bounds is None:
            return
        lower, upper = sides_of(bounds)
        given = upper if self.span > 0 else -lower
        if given <= drive.coulomb:
            unit = EFFORT.of(self.plant.joint)
            raise ValueError(
                f"{TORQUE.of(self.plant.joint)} limit is {given:g} {unit} and dry friction takes "
                f"{drive.coulomb:g} {unit}; give a larger limit, or the friction as it is"
            )

    @property
    def span(self) -> float:
        """Target - start [rad]."""
        return self.target - self.start

    @property
    def smallness(self) -> float:
        """Factor of absolute tolerances: 1, and less for a move below 1 mm or mrad."""
        return min(1.0, abs(self.span) / _SMALL_MOVE)

    @property
    def ends(self) -> str:
        """Start and target in words: "0 to 30 deg", of joints on a path places on it."""
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
        """The move of the nominal plant alone, without a band, which is for a range of errors."""
        if self.uncertainty is None:
            return self
        return replace(self, uncertainty=None, band=None, margin=MARGIN)

    def with_samples(self, samples: Iterable[Sequence[float]]) -> PointToPoint:
        """The move with these samples of its uncertainty."""
        rows = tuple(several("samples", samples, "rows of errors, one for each scenario"))
        return replace(self, uncertainty=Uncertainty(self.ranges, rows))

    @property
    def limits(self) -> tuple[Limit, ...]:
        """The limits that are set."""
        limits = [
            Limit.within(quantity, self.bounds[quantity.name], self.plant)
            for quantity in self._limited
        ]
        if self.torque_speed is not None:
            line = TorqueSpeedLine(self.torque_speed, self.plant.joint)
            limits.append(Limit.of_line(line))
        return tuple(limits)

    @property
    def _limited(self) -> list[Quantity]:
        """The quantities that have bounds, in the units of the plant."""
        for name in self.bounds:  # a process of its own may know less
            if name not in QUANTITIES:
                raise ValueError(
                    f"the quantity {quoted(name)} that the task limits is not known here; import "
                    "the file that defines it first, or name it by --plant-file"
                )
        joint, tip_unit = self.plant.joint, self.plant.tip_unit
        known = (quantity for name, quantity in QUANTITIES.items() if name in self.bounds)
        return [quantity.on(joint, tip_unit) for quantity in known]

    def as_saved(self, entries: Mapping[str, Any]) -> dict[str, Any]:
        """Return its entries as files have them: each limit by its keyword."""
        by_keyword = dict.fromkeys((f"{name}{_LIMIT}" for name in _ALWAYS_SAVED), None)
        by_keyword |= {f"{name}{_LIMIT}": bounds for name, bounds in entries["bounds"].items()}
        return {name: entry for name, entry in entries.items() if name != "bounds"} | by_keyword

    @staticmethod
    def of_saved(document: Any) -> Any:
        """Return the entries of a file as they are here: limits among the bounds."""
        if not isinstance(document, dict):
            return document
        entries = dict[str, Any]()
        bounds = dict[str, Any]()
        for name, entry in document.items():
            quantity = name.removesuffix(_LIMIT)
            if quantity == name:
                entries[name] = entry
            elif quantity not in QUANTITIES:
                raise ValueError(
                    f"its limit {quoted(name)} is not known here; import the file that defines the "
                    "quantity first, or name it by --plant-file"
                )
            elif entry is not None:
                bounds[quantity] = entry
        return {**entries, "bounds": bounds}

    def limit_of(self, name: str) -> Limit | None:
        """The limit of a quantity by name; None where it has none."""
        return next((limit for limit in self.limits if limit.name == name), None)


_ALWAYS_SAVED = ("torque", "speed", "acceleration", "deflection", "jerk")
"""Quantities whose limits files have where there is none, too: digests of 2.0 are of these."""


def _merged(
    bounds: Mapping[str, Bounds] | None, given: Mapping[str, Bounds | None]
) -> dict[str, Any]:
    """Bounds by quantity, and those that are given by the keywords of limits; None takes away."""
    if bounds is not None and not isinstance(bounds, Mapping):
        raise TypeError(
            f"bounds are {quoted(bounds)}; give them by name, such as {{'torque': 0.2}}"
        )
    merged: dict[str, Any] = dict(bounds or {})
    for keyword, value in given.items():
        name = keyword.removesuffix(_LIMIT)
        if name not in QUANTITIES or name == keyword:
            known = [quantity.limit for quantity in QUANTITIES.values()]
            raise TypeError(unknown("argument", keyword, known))
        if value is None:
            merged.pop(name, None)
        elif value is not _NOT_GIVEN:
            merged[name] = value
    return merged


def _is_default(window: object) -> bool:
    """Return whether a residual window was not given, but worked out for another task, or none."""
    return window is None or isinstance(window, DefaultWindow)


def _joined(plant: Plant, own: Any, given: Any) -> Any:
    """Return what was given, with a plant's own limits of joints that were not named."""
    if not isinstance(given, Mapping) or not given:
        return given
    if own is not None and not isinstance(own, Mapping):
        return given
    for joint, bounds in given.items():
        if bounds is None and joint not in plant.joint_names:
            raise ValueError(has_no(plant.name, "joint", joint, plant.joint_names))
    joined = {**(own or {}), **given}
    return {joint: bounds for joint, bounds in joined.items() if bounds is not None} or None


def _check_bounds(quantity: Quantity, value: Any, plant: Plant) -> Bounds:
    """A positive number, or a negative and a positive one; or such of joints by name."""
    name = quantity.limit.replace("_", " ")
    if not isinstance(value, Mapping):
        return _check_sides(name, str(quantity.unit), value)
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
    return ", ".join(
        f"{name} is {_words(name, entries.get(name), task.plant)}, "
        f"not {_words(name, expected.get(name), task.plant)}"
        for name in entries | expected
        if not _same(entries.get(name), expected.get(name))
    )


def _stated(task: PointToPoint) -> dict[str, object]:
    """Return all that a task has, by words; states are numbers, given or not."""
    # Fields that are told in another way.
    apart = "plant", "initial", "final", "energy", "uncertainty", "bounds"
    plain = (entry.name for entry in fields(task) if entry.name not in apart)
    return {
        "plant parameter": task.plant.parameters,
        "drive": {} if task.plant.drive is None else vars(task.plant.drive),
        **{name.replace("_", " "): getattr(task, name) for name in plain},
        **{_limit_words(name): bounds for name, bounds in task.bounds.items()},
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


def _limit_words(quantity: str) -> str:
    return f"{quantity.replace('_', ' ')} limit"


def _words(name: str, value: object, plant: Plant) -> str:
    if value is None:
        return "none"
    units = {"residual window": SECOND, "band": TIP} | dict(OF_MOVES)
    units |= {_limit_words(quantity.name): quantity.unit for quantity in QUANTITIES.values()}
    unit = units.get(name, NONE).of(plant.joint, plant.tip_unit)
    return f"{value:.10g} {unit}".strip() if isinstance(value, float) else str(value)
