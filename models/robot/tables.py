"""Tables of a robot on its path: every coefficient of its equations, fitted once a path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from quietarm.models.joint_motion import Array, Expression
from quietarm.models.robot.path import BEYOND, GeometricPath
from quietarm.models.robot.piecewise import NoFitError, Piecewise, Place, fit
from quietarm.models.robot.reduction import FORCING, OF_MODES, OF_TORQUES, Coefficients, Reduction

if TYPE_CHECKING:
    from quietarm.models.robot.robot import Robot

ACCURACY = 1e-9
"""Largest error of a table, as a share of what the coefficient can matter."""


@dataclass(frozen=True, eq=False)
class Tables:
    """Coefficients by group and entry, and the path, all on the same pieces.

    Attributes
    ----------
    knots : ndarray, shape (pieces + 1,)
    modes, torques : mapping of str to ndarray
        By coefficient of `OF_MODES` and `OF_TORQUES`: shape (pieces, terms, ...).
    tips : ndarray, shape (pieces, terms, directions, modes)
    path : list of ndarray, shape (pieces, terms, joints)
        Positions and their first three derivatives.
    frequencies : ndarray
        Of all modes in the middle of the path [rad/s].
    """

    knots: Array
    modes: dict[str, Array]
    torques: dict[str, Array]
    tips: Array
    tip_rates: Array
    path: Sequence[Array]
    frequencies: Array

    def at(self, place: Expression) -> Place:
        """The basis at a place."""
        terms = max(len(table[0]) for table in (self.tips, *self.path, *self.modes.values()))
        return Place(self.knots, place, terms)

    @property
    def size(self) -> int:
        """How many numbers they hold."""
        groups = [*self.modes.values(), *self.torques.values(), self.tips]
        return sum(int(np.count_nonzero(table)) for table in groups)


@lru_cache(maxsize=16)
def tables_of(robot: Robot, path: GeometricPath) -> Tables:
    """The tables of a robot on a path; ValueError where a spring cannot carry its load."""
    reduction = Reduction(robot.dynamics, robot.tip_place, path, robot.modes)
    layout = _Layout(reduction.at(np.array([0.5])))

    def columns(places: Array) -> Array:
        return layout.columns(reduction.at(places))

    try:
        found = fit(columns, path.extended.knots, lambda rows: ACCURACY * layout.scales(rows))
    except NoFitError as error:
        raise ValueError(
            f"the robot's equations are not smooth near s = {error.place:.4g} of the path; give a "
            "path that turns less sharply there"
        ) from None
    by_name = layout.split(found.coefficients)
    positions = path.extended.on(found.knots)
    terms = max(found.coefficients.shape[1], positions.coefficients.shape[1])
    derivatives = [positions, *(positions.derivative(order) for order in (1, 2, 3))]
    tips = Piecewise(found.knots, by_name["tips"].reshape(*found.coefficients.shape[:2], -1))
    return Tables(
        knots=found.knots,
        modes={name: _filled(by_name[f"modes {name}"], terms) for name in OF_MODES},
        torques={name: _filled(by_name[f"torques {name}"], terms) for name in OF_TORQUES},
        tips=_filled(by_name["tips"], terms),
        tip_rates=_filled(
            tips.derivative().coefficients.reshape(len(found.knots) - 1, -1, *layout.tips), terms
        ),
        path=[_filled(order.coefficients, terms) for order in derivatives],
        frequencies=reduction.all_frequencies,
    )


def reach() -> tuple[float, float]:
    """The places for which there are tables."""
    return (-BEYOND, 1 + BEYOND)


def _filled(table: Array, terms: int) -> Array:
    """With zeros for the terms that are not needed."""
    filled = np.zeros((table.shape[0], terms, *table.shape[2:]))
    filled[:, : table.shape[1]] = table
    return filled


class _Layout:
    """Where every coefficient stands in a row, and how large it is."""

    def __init__(self, example: Coefficients) -> None:
        self._parts = {name: part.shape[1:] for name, part in _named(example).items()}
        self.tips = self._parts["tips"]

    def columns(self, coefficients: Coefficients) -> Array:
        """All in columns, a place in each row."""
        parts = _named(coefficients).values()
        return np.hstack([part.reshape(len(part), -1) for part in parts])

    def split(self, columns: Array) -> dict[str, Array]:
        """The coefficients of columns, which are along the last axis."""
        found = dict[str, Array]()
        begin = 0
        for name, shape in self._parts.items():
            end = begin + int(np.prod(shape))
            found[name] = columns[..., begin:end].reshape(*columns.shape[:-1], *shape)
            begin = end
        return found

    def scales(self, rows: Array) -> Array:
        """What each column is compared with: the largest value of its term, or what matters.

        The path forces the modes by an acceleration; they answer with amplitudes of that over the
        square of the lowest frequency, which tells what else of their equations and of the torques
        matters. A term that is nothing beside it is no better than noise.
        """
        parts = self.split(rows)
        push = max(float(np.abs(parts[f"modes {name}"]).max()) for name in ("a", "b"))
        push = max(push, _LEAST_PUSH)
        square = float(np.abs(np.linalg.eigvals(parts["modes K"])).min())
        root = math.sqrt(square)
        force = max(float(np.abs(parts[f"torques {name}"]).max()) for name in ("a", "b", "g"))
        units = {"D": root, "C": root, "N": 1.0}
        scales = list[Array]()
        for name, part in parts.items():
            group, _, term = name.partition(" ")
            unit = 1.0 if term in FORCING else units.get(term, square)
            natural = {"modes": push if term in FORCING else unit, "tips": 1.0}.get(
                group, force if term in FORCING else force * unit / push
            )
            largest = max(float(np.abs(part).max()), _SMALL * natural)
            scales.append(np.full(part[0].size, largest))
        return np.concatenate(scales)


_LEAST_PUSH = 1e-6
"""Acceleration of a mode [m/s^2] by a path that is followed in a second, which is nothing."""
_SMALL = 1e-3
"""Share of what matters: a smaller coefficient is as exact as one of that size."""


def _named(coefficients: Coefficients) -> dict[str, Array]:
    """Every coefficient by its name."""
    return {
        **{f"modes {name}": coefficients.modes[name] for name in OF_MODES},
        **{f"torques {name}": coefficients.torques[name] for name in OF_TORQUES},
        "tips": coefficients.tips,
    }
