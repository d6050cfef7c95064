"""Perturbed plants, and the uncertainty of a task."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from numbers import Real
from typing import ClassVar

import casadi as ca
import numpy as np

from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.compiled import Compiled
from quietarm.models.joint_motion import Modes
from quietarm.models.plant import DAMPING, FREQUENCY
from quietarm.models.validation import check_contract, outputs_of
from quietarm.ocp.checks import has_no, numbers, positive, quoted, takes

_OF_MODES = (FREQUENCY, DAMPING)
_SAME = 1e-9
"""How far, as a share, equations may differ between two ways to change a parameter."""
MOST_RANGES = 4
"""Errors at once: each of them doubles the corners at which a residual is held."""
Scenario = tuple[float, ...]
"""Relative errors of a plant, in the order of the ranges."""


@dataclass(frozen=True)
class ScaledModes(Plant):
    """A plant whose natural frequencies and damping ratios are multiples of the assumed ones.

    With the joint at rest its modes obey W'' = -s d D W' - s^2 K W in place of -D W' - K W, as if
    time ran s times as fast; what the moving joint adds stays. As the equations are affine, -K W is
    W'' at rest without rates, and -D W' without amplitudes.
    """

    plant: Plant
    frequency: Expression = 1.0
    damping: Expression = 1.0

    def __post_init__(self) -> None:  # a factor may be a symbol, so no check of numbers
        of_plant = "name", "modes", "joint", "tip_unit", "small_deflection", "path_range", "drive"
        for name in of_plant:
            object.__setattr__(self, name, getattr(self.plant, name))

    def modal_accelerations(self, joint: JointMotion, W: Modes, dW: Modes) -> Modes:
        """The plant's own, and what its other stiffness and damping add [m/s^2]."""
        at_rest = JointMotion(joint.angle, 0.0, 0.0)
        still = [0.0] * len(W)
        terms = zip(
            self.plant.modal_accelerations(joint, W, dW),
            self.plant.modal_accelerations(at_rest, W, still),
            self.plant.modal_accelerations(at_rest, still, dW),
        )
        stiffer = self.frequency * self.frequency - 1
        more_damped = self.frequency * self.damping - 1
        return [
            assumed + stiffer * by_stiffness + more_damped * by_damping
            for assumed, by_stiffness, by_damping in terms
        ]

    def torque(self, joint: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Expression:
        """Joint torque by the plant's own equation [N m]."""
        return self.plant.torque(joint, W, dW, ddW)

    def tip_displacements(self, W: Modes) -> Sequence[Expression]:
        """Return the plant's tip displacements [m]."""
        return self.plant.tip_displacements(W)

    def joints(self, path: JointMotion) -> Sequence[JointMotion]:
        """Return the plant's joints."""
        return self.plant.joints(path)

    def torques(self, path: JointMotion, W: Modes, dW: Modes, ddW: Modes) -> Sequence[Expression]:
        """Return the plant's torques [N m]."""
        return self.plant.torques(path, W, dW, ddW)

    def tips_at(self, path: JointMotion, W: Modes) -> Sequence[Expression]:
        """Return the plant's tips at a place [m]."""
        return self.plant.tips_at(path, W)

    def tip_speeds(self, path: JointMotion, W: Modes, dW: Modes) -> Sequence[Expression]:
        """Return the plant's tip speeds [m/s]."""
        return self.plant.tip_speeds(path, W, dW)

    def tip_accelerations(
        self, path: JointMotion, W: Modes, dW: Modes, ddW: Modes
    ) -> Sequence[Expression]:
        """Return the plant's tip accelerations [m/s^2]."""
        return self.plant.tip_accelerations(path, W, dW, ddW)

    @property
    def tip_lines(self) -> np.ndarray | None:
        """Lines of the plant's tips."""
        return self.plant.tip_lines

    @property
    def tip_reach(self) -> float | None:
        """The plant's [m/rad]."""
        return self.plant.tip_reach

    def tip_deviations(
        self, places: np.ndarray, tips: np.ndarray, target: float
    ) -> np.ndarray | None:
        """Return the deviations of the plant's tips [m]."""
        return self.plant.tip_deviations(places, tips, target)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the plant's joints."""
        return self.plant.joint_names


@takes(plant=Plant)
def perturb_plant(plant: Plant, errors: Mapping[str, Expression]) -> Plant:
    """The perturbed plant.

    Parameters
    ----------
    plant : Plant
        The nominal plant.
    errors : mapping of str to Expression
        Relative errors, numbers or symbols: ``"frequency"`` and ``"damping"`` are those of all
        modes, other names those of parameters.

    Returns
    -------
    Plant
        A plant with 1 + error times the nominal parameters.

    Raises
    ------
    ValueError
        When there is no such parameter, or a number makes the frequency 0 or the damping negative.
    """
    _by_name(errors)
    if not errors:
        return plant
    refuse_unknown(plant, errors)
    parameters = (name for name in errors if name not in _OF_MODES)
    values = {name: getattr(plant, name) * (1 + errors[name]) for name in parameters}
    numbers = all(isinstance(value, Real) for value in values.values())
    changed = replace(plant, **values) if numbers else with_values(plant, values)
    factors = {name: 1 + errors[name] for name in _OF_MODES if name in errors}
    for name, factor in factors.items():
        if isinstance(factor, Real):
            _refuse_beyond(name, float(factor) - 1)
    if FREQUENCY in factors:
        swinging = changed.with_frequency(factors[FREQUENCY])
        if swinging is not None:
            changed = swinging
            del factors[FREQUENCY]
    return ScaledModes(changed, **factors) if factors else changed


def with_values(plant: Plant, values: Mapping[str, Expression]) -> Plant:
    """The plant with symbols for parameters, unchecked."""
    changed = copy.copy(plant)  # not by its class, which takes numbers
    for name, value in values.items():
        object.__setattr__(changed, name, value)
    return changed


def refuse_unknown(plant: Plant, names: Iterable[str], also: Sequence[str] = _OF_MODES) -> None:
    """Refuse names that are no parameter of a plant; ValueError suggests the nearest."""
    known = [*also, *plant.measured]
    for name in names:
        if name not in known:
            raise ValueError(has_no(plant.name, "parameter", name, known))


def _refuse_beyond(name: str, error: float) -> None:
    """Refuse an error that changes a sign, or makes anything but the damping zero."""
    if error < -1 or (error == -1 and name != DAMPING):
        becomes = "negative" if error < -1 else "0"
        least = "100 % or less" if name == DAMPING else "less than 100 %"
        raise ValueError(
            f"an error of {100 * error:g} % makes the {name} {becomes}; give {least}, such as 0.1 "
            "for 10 %"
        )


def _sizes(ranges: Mapping[str, float]) -> dict[str, float]:
    """Ranges as numbers; ValueError where there are none, or one turns a sign."""
    _by_name(ranges)
    if not ranges:
        raise ValueError(f"no error is named; give some, such as {{{FREQUENCY!r}: 0.1}} for 10 %")
    sizes = {name: positive(f"range of {name}", size) for name, size in ranges.items()}
    for name, size in sizes.items():
        _refuse_beyond(name, -size)
    return sizes


def _by_name(errors: object) -> None:
    """Refuse errors that are no mapping."""
    if not isinstance(errors, Mapping):
        raise ValueError(
            f"errors are {errors!r}; give them by name, such as {{{FREQUENCY!r}: 0.1}}"
        )


def check_ranges(plant: Plant, ranges: Mapping[str, float]) -> dict[str, float]:
    """Ranges as numbers; ValueError unless the plant keeps its contract at the ends of each."""
    _by_name(ranges)
    refuse_unknown(plant, ranges)
    sizes = _sizes(ranges)
    for name, size in sizes.items():
        _check_range(plant, name, size)
    return sizes


@lru_cache(maxsize=256, typed=True)  # a robust plan asks again for every error that it adds
def _check_range(plant: Plant, name: str, size: float) -> None:
    shared = True
    for error in (-size, size):
        try:
            perturbed = perturb_plant(plant, {name: error})
            check_contract(perturbed)
        except ValueError as problem:
            raise ValueError(f"with an error of {100 * error:g} % of {name}, {problem}") from None
        shared = shared and perturbed.as_checked is not perturbed
    if name not in _OF_MODES and not shared:
        _check_symbols(plant, name, getattr(plant, name) * (1 + size))


def _check_symbols(plant: Plant, name: str, value: float) -> None:
    """Refuse equations that read a parameter elsewhere, or take no symbol for it."""
    if value == 0:
        raise ValueError(f"parameter {name} of {plant.name} is 0, which has no share; leave it out")
    symbol = ca.SX.sym(name)
    motion = np.random.default_rng(0).uniform(0.1, 1.0, 3 + 2 * plant.modes).tolist()
    expressions = outputs_of(with_values(plant, {name: symbol}), motion)
    outputs = ca.densify(ca.vertcat(*expressions))
    computed = Compiled(lambda: ca.Function("found", [symbol], [outputs]))(value)[0].ravel()
    anew = outputs_of(replace(plant, **{name: value}), motion)
    if not np.allclose(
        computed,
        [float(entry) for entry in anew],
        rtol=_SAME,
        atol=0.0,
    ):
        raise ValueError(
            f"plant {quoted(plant.name)} computes with {name} outside its equations or by Python's "
            f"math; compute in them, from self.{name}, with casadi.sqrt and its like"
        )


class _Corners(tuple[Scenario, ...]):
    """Samples by default, which `replace` with other ranges works out again."""


@dataclass(frozen=True)
class Uncertainty:
    """Ranges of parameter errors, and the scenarios in them that are considered.

    Residual and deflection are then the largest over the scenarios; all else is of the nominal
    plant.

    Parameters
    ----------
    ranges : mapping of str to float
        Largest relative errors by name, 0.1 for 10 %: of ``"frequency"`` and ``"damping"`` of
        all modes, and of any parameter of the plant.
    samples : sequence of sequence of float, optional
        Errors of the scenarios beside the nominal plant, in that order; by default all corners, of
        `replace` with other ranges those of these.

    Raises
    ------
    ValueError
        When there are too many ranges, or a number is out of range.
    """

    example: ClassVar[str] = "ranges, such as Uncertainty({'frequency': 0.1}) for 10 %"

    ranges: Mapping[str, float]
    samples: tuple[Scenario, ...] = ()

    def __post_init__(self) -> None:
        ranges = _sizes(self.ranges)
        if len(ranges) > MOST_RANGES:
            raise ValueError(
                f"{len(ranges)} errors at once have {2 ** len(ranges)} corners at which the "
                f"residual is evaluated; give at most {MOST_RANGES}"
            )
        corners = product(*((-size, size) for size in ranges.values()))
        by_default = isinstance(self.samples, _Corners) or (
            isinstance(self.samples, tuple | list) and not self.samples
        )
        rows = list(corners) if by_default else self.samples
        table = numbers("samples", rows, "a row of errors for each scenario")
        if table.ndim != 2:
            raise ValueError(
                f"samples have shape {table.shape}; give (scenarios, {len(ranges)}), a row of "
                "errors for each scenario"
            )
        scenarios = map(tuple, table.tolist())
        samples = _Corners(scenarios) if by_default else tuple(scenarios)
        most = (1 + _SAME) * np.array(list(ranges.values()))
        for sample in samples:
            if len(sample) != len(most) or not np.all(np.abs(sample) <= most):
                raise ValueError(f"sample {sample} is no error within each of the ranges {ranges}")
        object.__setattr__(self, "ranges", ranges)
        object.__setattr__(self, "samples", samples)

    def __hash__(self) -> int:
        return hash((tuple(self.ranges.items()), self.samples))
