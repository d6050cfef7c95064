"""A plant that stands for several: the assumed one, and itself with errors, on one joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from typing import Any

from quietarm.models import Body, Expression, JointMotion, Plant
from quietarm.models.contract import check_contract
from quietarm.ocp.checks import finite
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import checked_ranges, perturb_plant

MOST_RANGES = 4
"""Errors at once: each of them doubles the corners at which a residual is held."""
_ROUNDING = 1e-9


@dataclass(frozen=True)
class UncertainPlant(Plant):
    """A plant whose parameters are known within ranges: its residual is the worst of samples.

    The modes of the assumed plant and of every sample stand side by side, on the same joint. So
    whatever computes with a plant computes with all of them: residual and deflection are the
    largest of any sample's tips; torque and energy are those of the assumed plant.

    Parameters
    ----------
    assumed : Plant
        The plant without errors.
    ranges : mapping of str to float
        Largest relative errors by name, as 0.1 for 10 %: of ``"frequency"`` and ``"damping"``,
        which all modes have alike, and of any parameter of the plant.
    samples : sequence of sequence of float, optional
        Errors of the samples beside the assumed plant, in the order of the ranges; the corners of
        the ranges by default.

    Raises
    ------
    ValueError
        When there is no such parameter, a number is out of range, a sample is beyond the ranges,
        or a plant within them breaks its contract.
    """

    assumed: Plant
    ranges: Mapping[str, float]
    samples: tuple[tuple[float, ...], ...] = ()

    def __post_init__(self) -> None:
        if isinstance(self.assumed, UncertainPlant):
            raise ValueError("the plant is uncertain already; give the assumed one")
        ranges = checked_ranges(self.assumed, self.ranges)
        if len(ranges) > MOST_RANGES:
            raise ValueError(
                f"{len(ranges)} errors at once have {2 ** len(ranges)} corners at which the "
                f"residual is held; give at most {MOST_RANGES}"
            )
        corners = product(*((-size, size) for size in ranges.values()))
        samples = tuple(_sample(one, ranges) for one in self.samples or corners)
        kept: dict[str, Any] = {"ranges": dict(ranges), "samples": samples}
        kept |= {name: getattr(self.assumed, name) for name in ("name", "small_deflection")}
        kept["modes"] = (1 + len(samples)) * self.assumed.modes
        for name, value in kept.items():
            object.__setattr__(self, name, value)

    def __hash__(self) -> int:
        return hash((self.assumed, tuple(self.ranges.items()), self.samples))

    @property
    def nominal(self) -> Plant:
        """The assumed plant."""
        return self.assumed

    @property
    def errors(self) -> Mapping[str, float]:
        """The ranges."""
        return self.ranges

    @property
    def error_samples(self) -> tuple[tuple[float, ...], ...]:
        """The samples."""
        return self.samples

    @property
    def parts(self) -> tuple[Plant, ...]:
        """The assumed plant and every sample."""
        return _parts(self.assumed, tuple(self.ranges), self.samples)

    @property
    def parameters(self) -> dict[str, float]:
        """Those of the assumed plant."""
        return self.assumed.parameters

    def validate(self) -> None:
        """Check the assumed plant, and the contract of every other part.

        An error of one parameter alone may make a plant that cannot exist, as others that belong to
        it stay as they are.
        """
        self.assumed.validate()
        for part in self.parts[1:]:
            check_contract(part)

    def modal_accelerations(
        self, joint: JointMotion, W: Sequence[Expression], dW: Sequence[Expression]
    ) -> Sequence[Expression]:
        """W'' of every part, one after another [m/s^2]."""
        each = zip(self.parts, self._by_part(W), self._by_part(dW), strict=True)
        return [ddW for part, W, dW in each for ddW in part.modal_accelerations(joint, W, dW)]

    def torque(
        self,
        joint: JointMotion,
        W: Sequence[Expression],
        dW: Sequence[Expression],
        ddW: Sequence[Expression],
    ) -> Expression:
        """Joint torque of the assumed plant [N m]."""
        return self.assumed.torque(joint, *(self._by_part(rows)[0] for rows in (W, dW, ddW)))

    def tip_displacements(self, W: Sequence[Expression]) -> Sequence[Expression]:
        """Those of every part, one after another [m]."""
        each = zip(self.parts, self._by_part(W), strict=True)
        return [tip for part, W in each for tip in part.tip_displacements(W)]

    def structure(self, angle: float, tips: Sequence[float]) -> Sequence[Body]:
        """That of the assumed plant."""
        return self.assumed.structure(angle, tips[: self.assumed.tips])

    def _by_part(self, rows: Sequence[Expression]) -> list[Sequence[Expression]]:
        size = self.assumed.modes
        return [rows[first : first + size] for first in range(0, self.modes, size)]


@lru_cache(maxsize=64)
def _parts(
    assumed: Plant, names: tuple[str, ...], samples: tuple[tuple[float, ...], ...]
) -> tuple[Plant, ...]:
    errors = (dict(zip(names, sample, strict=True)) for sample in samples)
    return (assumed, *(perturb_plant(assumed, one) for one in errors))


def _sample(errors: Sequence[float], ranges: Mapping[str, float]) -> tuple[float, ...]:
    if len(errors) != len(ranges):
        raise ValueError(f"sample {tuple(errors)} has {len(errors)} errors; give {len(ranges)}")
    for error, (name, most) in zip(errors, ranges.items(), strict=True):
        if abs(finite(f"error of {name} in a sample", error)) > most * (1 + _ROUNDING):
            raise ValueError(
                f"error of {name} in a sample is {error:g}; give one within +-{most:g}, its range"
            )
    return tuple(map(float, errors))


def with_samples(task: PointToPoint, samples: Sequence[Sequence[float]]) -> PointToPoint:
    """The move with these samples of its uncertain plant."""
    plant: Any = task.plant
    return replace(task, plant=replace(plant, samples=tuple(map(tuple, samples))))
