"""Learn about all moves of one machine from recordings of several.

First the model, by all recordings together. Then the deviation that the machine has beside it: of a
linear machine it is a share of the tip's largest displacement that changes smoothly with where a
move goes and how long it takes. It is fitted to the moves that were recorded, and predicts what
others leave; how well, is said by leaving one move out after another.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.identified import Estimate, Part, is_frequency
from quietarm.machine.learn.evidence import told_of
from quietarm.machine.learn.reading.read_swing import modal_names
from quietarm.machine.learn.weigh_moves import weigh_moves
from quietarm.models import Plant
from quietarm.ocp.planning.executed import ExecutedMove
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_LEAST_CHANGE = 5e-4
"""Share of a frequency, below which a difference from the model is left to the deviation."""
_OF_SHARE = 0.3
"""Standard deviation of the share of the model's swing that the tip shows, about 1."""
_OF_TERM = 0.1
"""The same of each term of the deviation, as a share of the tip's largest displacement."""
_OF_LARGE_SWINGS = 0.04
"""Share of a swing by which it may differ from what a linear machine would leave."""


@dataclass(frozen=True)
class SmoothDeviation:
    """The deviation of one mode's swing at arrival, by where a move goes and how long it takes.

    The swing is a share of what the plant says, plus a deviation: the way over the duration squared
    times a polynomial of second degree in target, way and duration.

    Attributes
    ----------
    centre, spread : tuple of float
        Of target, way and duration, by which they are brought to about -1 to 1.
    share : tuple of float
        Real and imaginary part of the share.
    terms : tuple of (float, float)
        The same of every term of the polynomial [s^2].
    """

    centre: tuple[float, float, float]
    spread: tuple[float, float, float]
    share: tuple[float, float]
    terms: tuple[tuple[float, float], ...]

    def deviation(self, move: tuple[float, float, float]) -> complex:
        """The deviation of a move from start to target in a duration [m]."""
        terms = np.array([complex(*term) for term in self.terms])
        return complex(columns_of(move, self.centre, self.spread) @ terms)

    def told_for(self, move: tuple[float, float, float], wanted: complex) -> complex:
        """Return what the plant should say of set points, so that a wanted swing is left [m]."""
        return (wanted - self.deviation(move)) / complex(*self.share)


def columns_of(
    move: tuple[float, float, float], centre: Sequence[float], spread: Sequence[float]
) -> Array:
    """Return the part that each term of the polynomial adds to a move's deviation."""
    start, target, duration = move
    values = np.array([target, target - start, duration])
    scaled = (values - np.array(centre)) / np.array(spread)
    powers = [
        float(np.prod(scaled[list(of)]))
        for degree in range(3)
        for of in combinations_with_replacement(range(3), degree)
    ]
    return (target - start) / duration**2 * np.array(powers)


class MovesOfMachine:
    """Several executed moves of one machine, each with its recordings.

    Parameters
    ----------
    task : PointToPoint
        What the moves have in common; its plant is the model.
    moves : sequence of ExecutedMove
        With what was measured of each.
    """

    def __init__(self, task: PointToPoint, moves: Sequence[ExecutedMove]) -> None:
        self.task = task
        self.moves = tuple(moves)

    def without(self, number: int) -> MovesOfMachine:
        """Return all moves but one."""
        kept = [move for k, move in enumerate(self.moves) if k != number]
        return MovesOfMachine(self.task, kept)

    @cached_property
    def estimates(self) -> tuple[Estimate, ...]:
        """Frequencies and dampings by all recordings."""
        parts = list[Part]()
        swung = dict[str, float]()
        for number, move in enumerate(self.moves, start=1):
            for one in move.measured:
                name = f"move {number}, {one.recording}"
                swung[name] = sum(swing.amplitude for swing in one.swings)
                parts.append(Part(name, 0.0, 0.0, dict(one.values), dict(one.deviations)))
        estimates = list[Estimate]()
        for name in modal_names(self.task.plant):
            telling = [part for part in parts if name in part.values]
            estimated = weigh_moves(name, telling, swung) if telling else None
            estimates += [estimated] if estimated else []
        return tuple(estimates)

    @cached_property
    def changed(self) -> dict[str, tuple[float, float]]:
        """Parameters that the recordings clearly have otherwise: the model's and their values."""
        plant = self.task.plant
        clear = {
            estimate.parameter: (getattr(plant, estimate.parameter), estimate.value)
            for estimate in self.estimates
            if not estimate.low <= getattr(plant, estimate.parameter) <= estimate.high
        }
        rates = [
            abs(new / model - 1) > _LEAST_CHANGE
            for name, (model, new) in clear.items()
            if is_frequency(plant, name)
        ]
        return clear if any(rates) else {}

    @cached_property
    def plant(self) -> Plant:
        """The plant with what is changed."""
        return replace(
            self.task.plant, **{name: value for name, (_, value) in self.changed.items()}
        )

    @cached_property
    def left(self) -> ComplexArray:
        """The mean of what each move left (moves, modes) [m]."""
        return np.stack([
            np.mean([[s.complex_amplitude for s in one.swings] for one in move.measured], axis=0)
            for move in self.moves
        ])  # fmt: skip

    @cached_property
    def noise(self) -> Array:
        """Standard deviation of that (moves, modes) [m]."""
        squares = [
            [[s.deviation**2 for s in one.swings] for one in move.measured] for move in self.moves
        ]
        return np.stack([np.sqrt(np.mean(of_move, axis=0)) for of_move in squares])

    @cached_property
    def told(self) -> ComplexArray:
        """Swing that the plant with what is changed says of each move (moves, modes) [m]."""
        return np.stack([told_of(move, self.task, self.plant) for move in self.moves])

    def smooth(self, span: Array) -> list[SmoothDeviation]:
        """Fit the deviation of each mode.

        Parameters
        ----------
        span : array, shape (2, 3)
            The least and the largest target, way and duration that are asked for.
        """
        centre = tuple(span.mean(axis=0).tolist())
        spread = tuple(np.where(np.ptp(span, axis=0) > 0, np.ptp(span, axis=0) / 2, 1.0).tolist())
        columns = np.stack([columns_of(move.move, centre, spread) for move in self.moves])
        modes = range(self.left.shape[1])
        return [self._smooth_of(mode, columns, centre, spread) for mode in modes]

    def _smooth_of(self, mode: int, columns: Array, centre: Any, spread: Any) -> SmoothDeviation:
        told, left = self.told[:, mode], self.left[:, mode]
        noise = np.hypot(self.noise[:, mode], _OF_LARGE_SWINGS * np.abs(left)) + 1e-9
        # a plant that swings at omega is displaced by about the acceleration over omega squared
        rate = min(self._rates.values())
        size = 6 / rate**2  # 6: the peak acceleration of a cycloid over way and duration
        terms = columns.shape[1]
        basis = np.column_stack([told, columns]).astype(complex)
        before = np.zeros(1 + terms, complex)
        before[0] = 1.0
        deviations = np.array([_OF_SHARE, *[_OF_TERM * size] * terms])
        scaled = basis * deviations
        curvature = (scaled.conj().T / noise**2) @ scaled + np.eye(1 + terms)
        gradient = (scaled.conj().T / noise**2) @ (left - basis @ before)
        solution = before + deviations * np.linalg.solve(curvature, gradient)
        pairs = [(float(value.real), float(value.imag)) for value in solution]
        return SmoothDeviation(centre, spread, pairs[0], tuple(pairs[1:]))

    @cached_property
    def _rates(self) -> dict[str, float]:
        """The plant's frequencies [rad/s]."""
        return {
            name: value for name, value in self.plant.measured.items()
            if is_frequency(self.plant, name)
        }  # fmt: skip

    def left_out(self, span: Array) -> Array:
        """Return what each move would leave if it were corrected by the others' recordings [m].

        That is what the others predict of it, model and deviation, less what it left.
        """
        unexplained = list[float]()
        for number, move in enumerate(self.moves):
            others = self.without(number)
            told = told_of(move, self.task, others.plant)
            said = [
                complex(*smooth.share) * of_mode + smooth.deviation(move.move)
                for smooth, of_mode in zip(others.smooth(span), told)
            ]
            unexplained.append(float(np.abs(np.array(said) - self.left[number]).sum()))
        return np.array(unexplained)
