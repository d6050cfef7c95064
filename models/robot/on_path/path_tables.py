"""Tables of a robot on its path: every coefficient of its equations, fitted once a path."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from quietarm.models.joint_motion import Array, Expression
from quietarm.models.kept_functions import kept_arrays
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.on_path.reduction import (
    FORCING,
    MIDDLE,
    OF_MODES,
    OF_TORQUES,
    Coefficients,
    Reduction,
)
from quietarm.models.robot.path.geometric_path import BEYOND, GeometricPath
from quietarm.models.robot.path.piecewise import (
    NODES,
    NoFitError,
    Piecewise,
    Place,
    fit,
    interpolate,
    without_small_terms,
)

ACCURACY = 1e-9
"""Largest error of a table, as a share of what the coefficient can matter."""
STIFFNESS = "stiffness"
PAYLOAD = "payload"
VARIED = (STIFFNESS, PAYLOAD)
"""Multiples of a robot's, which a plant may have and its tables know."""
FARTHEST = 0.3
"""By which a multiple may be another than 1: there polynomials of fourth degree miss 2e-4 of what
the sag changes."""
ACCURACY_OF_CHANGES = 1e-7
"""As `ACCURACY`, of what the farthest multiple changes."""


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
    directions : tuple of int
        Axes of the tip's frame along which it moves, from 0, those of `tips`.
    """

    knots: Array
    modes: dict[str, Array]
    torques: dict[str, Array]
    tips: Array
    tip_rates: Array
    path: Sequence[Array]
    frequencies: Array
    directions: tuple[int, ...]

    def at(self, place: Expression) -> Place:
        """The basis at a place."""
        return Place(self.knots, place, self.terms)

    @property
    def terms(self) -> int:
        """Number of Chebyshev polynomials of a piece."""
        return max(len(table[0]) for table in (self.tips, *self.path, *self.modes.values()))

    @property
    def least_inertia(self) -> float:
        """Least share of the inertia along the path that remains where the modes give way."""
        places = np.linspace(0.0, 1.0, NODES)
        whole, left = np.array([self._inertias(float(place)) for place in places]).T
        moving = whole > _STILL * whole.max()
        return float((left[moving] / whole[moving]).min())

    def _inertias(self, place: float) -> tuple[float, float]:
        """Inertia against s'' at a place with the modes held, and with them free."""
        at = self.at(place)
        slopes = at.values(self.path[1]).astype(float)
        torques = at.values(self.torques["a"]).astype(float)
        given_way = at.values(self.torques["N"]).astype(float) @ at.values(self.modes["a"]).astype(
            float
        )
        return float(slopes @ torques), float(slopes @ (torques - given_way))

    @property
    def groups(self) -> dict[str, dict[str, Array]]:
        """Tables of the modes, the torques, and the tips' rows and their slopes, by group."""
        return {
            "modes": self.modes,
            "torques": self.torques,
            "tips": {"rows": self.tips, "slopes": self.tip_rates},
        }

    @property
    def size(self) -> int:
        """Number of values that the tables hold."""
        groups = [*self.modes.values(), *self.torques.values(), self.tips]
        return sum(int(np.count_nonzero(table)) for table in groups)


_STILL = 1e-9
"""Share of the largest inertia along a path, where its joints stand still."""
EXCITED = "excited"
"""In the place of a number of modes."""
MOST_MODES = 12
"""Of a robot: each of them is in every equation with each."""


@dataclass(frozen=True)
class Swing:
    """A mode of a robot on a path.

    Attributes
    ----------
    number : int
        0 of the slowest.
    frequency : float
        In the middle of the path [rad/s].
    leaves : float
        Largest displacement of the tip that it leaves [m], if alone, after a plain cycloid that
        takes two swings of the slowest mode; undamped, its phase on arrival as bad as can be.
    """

    number: int
    frequency: float
    leaves: float


@lru_cache(maxsize=64)
def swings_of(robot: MovingRobot, path: GeometricPath) -> tuple[Swing, ...]:
    """The slowest modes of a robot, twelve at most, and how a path excites each."""
    count = min(MOST_MODES, len(robot.mechanism.sprung))
    reduction = Reduction(robot.dynamics, robot.tip_place, path, range(count))
    coefficients = reduction.at(np.linspace(0.0, 1.0, NODES))
    forces = np.abs(coefficients.modes["a"]).max(axis=0)
    displacements = np.linalg.norm(coefficients.tips, axis=1).max(axis=0)
    frequencies = reduction.all_frequencies[:count]
    duration = _SWINGS_OF_A_MOVE * math.tau / frequencies[0]
    turning = math.tau / duration
    amplitudes = 2 * forces * turning**2 / duration
    amplitudes = amplitudes / (frequencies * np.abs(frequencies**2 - turning**2))
    leaves = displacements * amplitudes
    return tuple(
        Swing(number, float(frequency), float(left))
        for number, (frequency, left) in enumerate(zip(frequencies, leaves))
    )


_SWINGS_OF_A_MOVE = 2
"""A move that is as short: shorter ones take much energy."""
_EXCITED_SHARE = 1e-3
"""Of what the most excited mode leaves: a mode that leaves less is not followed."""


def modes_on(robot: MovingRobot, path: GeometricPath) -> tuple[int, ...]:
    """Numbers of the modes that are followed on a path: so many, or those that it excites."""
    if robot.modes != EXCITED:
        assert robot.modes is not None
        return tuple(range(int(robot.modes)))
    swings = swings_of(robot, path)
    least = _EXCITED_SHARE * max(swing.leaves for swing in swings)
    return tuple(swing.number for swing in swings if swing.leaves >= least)


@lru_cache(maxsize=16)
def tables_of(robot: MovingRobot, path: GeometricPath) -> Tables:
    """The tables of a robot on a path; ValueError where a spring cannot carry its load."""
    kept = kept_arrays(("tables", robot, path), lambda: _arrays_of(_fit_tables(robot, path)))
    return _tables_of_arrays(kept)


def _arrays_of(tables: Tables) -> dict[str, Array]:
    """Arrays that tables are made of, by names as `modes K`."""
    return {
        "knots": tables.knots,
        "tips": tables.tips,
        "tip_rates": tables.tip_rates,
        "frequencies": tables.frequencies,
        "directions": np.array(tables.directions),
        **{f"modes {name}": table for name, table in tables.modes.items()},
        **{f"torques {name}": table for name, table in tables.torques.items()},
        **{f"path {order}": table for order, table in enumerate(tables.path)},
    }


def _tables_of_arrays(arrays: Mapping[str, Array]) -> Tables:
    return Tables(
        knots=arrays["knots"],
        modes={name: arrays[f"modes {name}"] for name in OF_MODES},
        torques={name: arrays[f"torques {name}"] for name in OF_TORQUES},
        tips=arrays["tips"],
        tip_rates=arrays["tip_rates"],
        path=[arrays[f"path {order}"] for order in range(_ORDERS)],
        frequencies=arrays["frequencies"],
        directions=tuple(arrays["directions"].tolist()),
    )


_ORDERS = 4
"""Of the path: positions and their first three derivatives."""


@lru_cache(maxsize=16)
def _reduction_of(robot: MovingRobot, path: GeometricPath) -> Reduction:
    """The reduction of a robot on a path to the modes that are followed."""
    return Reduction(robot.dynamics, robot.tip_place, path, modes_on(robot, path))


@lru_cache(maxsize=64)
def _nominal_columns(robot: MovingRobot, path: GeometricPath, places: tuple[float, ...]) -> Array:
    """Columns of a robot's own coefficients at places, which every multiple is compared with."""
    nominal = _reduction_of(robot, path)
    return _layout_of(robot, path).columns(nominal.at(np.array(places)))


@lru_cache(maxsize=16)
def _layout_of(robot: MovingRobot, path: GeometricPath) -> _Layout:
    """Return how the coefficients of a robot on a path stand side by side."""
    return _Layout(_reduction_of(robot, path).at(np.array([MIDDLE])))


def _fit_tables(robot: MovingRobot, path: GeometricPath) -> Tables:
    reduction = _reduction_of(robot, path)
    layout = _layout_of(robot, path)

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
    derivatives = [positions, *(positions.derivative(order) for order in range(1, _ORDERS))]
    return Tables(
        knots=found.knots,
        modes={name: _filled(by_name[f"modes {name}"], terms) for name in OF_MODES},
        torques={name: _filled(by_name[f"torques {name}"], terms) for name in OF_TORQUES},
        tips=_filled(by_name["tips"], terms),
        tip_rates=_filled(_slopes(found.knots, by_name["tips"]), terms),
        path=[_filled(order.coefficients, terms) for order in derivatives],
        frequencies=reduction.all_frequencies,
        directions=tuple(reduction.directions.tolist()),
    )


Groups = dict[str, dict[str, Array]]
"""Tables by group and entry, as of `Tables.groups`."""


@lru_cache(maxsize=16)
def variations_of(
    robot: MovingRobot, path: GeometricPath, names: tuple[str, ...]
) -> dict[tuple[int, ...], Groups]:
    """Return what is added to the tables if multiples of `VARIED` are not 1.

    Parameters
    ----------
    robot, path
        Of the tables.
    names : tuple of str
        Which multiples are varied.

    Returns
    -------
    dict
        By powers of the multiples' errors: the tables that are multiplied by these.
    """
    _, powers = _design(len(names))

    def build() -> dict[str, Array]:
        return {
            _KEY_OF_VARIATION.format(powers=number, group=group, name=name): table
            for number, groups in enumerate(_fit_variations(robot, path, names).values())
            for group, tables in groups.items()
            for name, table in tables.items()
        }

    kept = kept_arrays(("variations", robot, path, names), build)
    variations = dict[tuple[int, ...], Groups]()
    for number, power in enumerate(powers):
        variations[power] = {
            group: {
                name: kept[_KEY_OF_VARIATION.format(powers=number, group=group, name=name)]
                for name in tables
            }
            for group, tables in tables_of(robot, path).groups.items()
        }
    return variations


_KEY_OF_VARIATION = "{powers} {group} {name}"


def _fit_variations(
    robot: MovingRobot, path: GeometricPath, names: tuple[str, ...]
) -> dict[tuple[int, ...], Groups]:
    tables = tables_of(robot, path)
    nominal = _reduction_of(robot, path)
    layout = _layout_of(robot, path)

    def before(places: Array) -> Array:
        return _nominal_columns(robot, path, tuple(places.tolist()))

    multiples = dict.fromkeys(VARIED, 1.0)
    errors, powers = _design(len(names))
    varied = [
        nominal.of(robot.dynamics_with(**(multiples | dict(zip(names, 1 + FARTHEST * error)))))
        for error in errors
    ]
    monomials = np.prod(errors[:, None, :] ** np.array(powers), axis=2)

    def terms_of(places: Array) -> Array:
        """Places -> the factors of all monomials, side by side."""
        unvaried = before(places)
        changes = np.array([layout.columns(each.at(places)) - unvaried for each in varied])
        factors = np.linalg.solve(monomials, changes.reshape(len(varied), -1))
        by_place = factors.reshape(changes.shape).swapaxes(0, 1)
        return by_place.reshape(len(places), -1)

    scales = layout.scales(before(np.linspace(0.0, 1.0, NODES)))
    fitted = without_small_terms(
        interpolate(terms_of, tables.knots, NODES),
        np.tile(ACCURACY_OF_CHANGES * scales, len(powers)),
    )
    terms = max(fitted.shape[1], len(tables.tips[0]))
    variations = dict[tuple[int, ...], Groups]()
    for power, part in zip(powers, np.split(fitted, len(powers), axis=2)):
        by_name = layout.split(part / FARTHEST ** sum(power))
        variations[power] = {
            "modes": {name: _filled(by_name[f"modes {name}"], terms) for name in OF_MODES},
            "torques": {name: _filled(by_name[f"torques {name}"], terms) for name in OF_TORQUES},
            "tips": {
                "rows": _filled(by_name["tips"], terms),
                "slopes": _filled(_slopes(tables.knots, by_name["tips"]), terms),
            },
        }
    return variations


@lru_cache(maxsize=64)
def groups_at(
    robot: MovingRobot, path: GeometricPath, errors: tuple[tuple[str, float], ...]
) -> Groups:
    """The tables for these errors of the multiples in `VARIED`; as large as the nominal ones."""
    groups = tables_of(robot, path).groups
    if not errors:
        return groups
    names, sizes = zip(*errors)
    variations = variations_of(robot, path, names)
    summed = {group: dict(entries) for group, entries in groups.items()}
    for powers, changes in variations.items():
        factor = math.prod(size**power for size, power in zip(sizes, powers))
        for group, entries in changes.items():
            for name, change in entries.items():
                before = summed[group][name]
                terms = max(before.shape[1], change.shape[1])
                summed[group][name] = _filled(before, terms) + factor * _filled(change, terms)
    return summed


def _design(count: int) -> tuple[Array, list[tuple[int, ...]]]:
    """Sample points (as shares of the largest errors) and exponents to fit `count` multiples by."""
    alone = [0.5, 1.0, -0.5, -1.0]
    if count == 1:
        return np.array(alone)[:, None], [(power,) for power in range(1, 5)]
    errors = [(error, 0.0) for error in alone] + [(0.0, error) for error in alone]
    errors += [(first, second) for first in (-1.0, 1.0) for second in (-1.0, 1.0)]
    powers = [(power, 0) for power in range(1, 5)] + [(0, power) for power in range(1, 5)]
    powers += [(1, 1), (1, 2), (2, 1), (2, 2)]
    return np.array(errors), powers


def _slopes(knots: Array, tips: Array) -> Array:
    """Derivatives of the tips' rows by the place, shape (pieces, terms, directions, modes)."""
    rows = Piecewise(knots, tips.reshape(*tips.shape[:2], -1))
    slopes = rows.derivative().coefficients
    return slopes.reshape(len(slopes), -1, *tips.shape[2:])


def range_of_tables() -> tuple[float, float]:
    """The places for which there are tables."""
    return (-BEYOND, 1 + BEYOND)


def _filled(table: Array, terms: int) -> Array:
    """Fill up with zeros for the terms that are not needed."""
    filled = np.zeros((table.shape[0], terms, *table.shape[2:]))
    filled[:, : table.shape[1]] = table
    return filled


class _Layout:
    """Places of all coefficients in a row, and their sizes."""

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
        """Return the size to which each column is compared: its term's largest, or what matters.

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
