"""What a search had found after so many evaluations, measured within the exact front's extent."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from operator import add

import moocore
import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import Front
from quietarm.ocp.checks import Count, NotNegative, Positive

Array = NDArray[np.float64]
CORNER = 1.1
"""Hypervolumes are measured from here, where 0 is the exact front's best and 1 its worst of each
objective: as is usual, a tenth beyond, so that the ends of the front count."""
_A_DECADE = 48
"""Marks in each decade of evaluations; neighbouring ones are 5 % apart."""
_FIRST_MARK = 10


@dataclass(frozen=True)
class Scale:
    """The exact front's extent."""

    ideal: tuple[NotNegative, NotNegative]
    nadir: tuple[Positive, Positive]

    @classmethod
    def of(cls, front: Front) -> Scale:
        """The extent of a front; ValueError where it has none in one of the objectives."""
        if len(front.points) < 2:
            raise ValueError(
                "the exact front is a single motion, which is no scale for others; give another "
                "problem"
            )
        still, cheap = front.points[0], front.points[-1]
        return cls((still.residual, cheap.energy), (cheap.residual, still.energy))

    def scaled(self, objectives: Array) -> Array:
        """Residuals [m] and energies [J], shape (n, 2), from 0 at the ideal to 1 at the nadir."""
        ideal = np.array(self.ideal)
        return (objectives - ideal) / (np.array(self.nadir) - ideal)

    def hypervolume(self, objectives: Array) -> float:
        """What points dominate up to `CORNER`; shape (n, 2), residuals [m] and energies [J]."""
        if len(objectives) == 0:
            return 0.0
        return float(moocore.hypervolume(self.scaled(objectives), ref=[CORNER, CORNER]))

    def hypervolume_of_line(self, objectives: Array) -> float:
        """The same for an exact front, which is the line through points of rising residual."""
        residuals, energies = self.scaled(objectives).T
        # the last point is the cheapest there is
        residuals, energies = np.append(residuals, CORNER), np.append(energies, energies[-1])
        above = CORNER - (energies[1:] + energies[:-1]) / 2
        return float(np.sum(above * np.diff(residuals)))


@dataclass(frozen=True)
class Mark:
    """Where a search was."""

    evaluations: Count
    seconds: NotNegative
    hypervolume: NotNegative


@dataclass(frozen=True)
class Visits:
    """Where a search's feasible candidates lie, by residual in the exact front's extent."""

    still: Count = 0
    middle: Count = 0
    cheap: Count = 0
    outside: Count = 0

    @classmethod
    def of(cls, scaled: Array) -> Visits:
        """Count candidates, shape (n, 2), that `Scale.scaled` gave."""
        inside = (scaled < CORNER).all(axis=1)
        thirds = np.clip((3 * scaled[inside, 0]).astype(int), 0, 2)
        still, middle, cheap = (int(n) for n in np.bincount(thirds, minlength=3))
        return cls(still, middle, cheap, int((~inside).sum()))

    def __add__(self, other: Visits) -> Visits:
        """The sum of both."""
        return Visits(*map(add, astuple(self), astuple(other)))


def marks_of(budget: int) -> tuple[int, ...]:
    """The numbers of evaluations after which a search is measured; the last is the budget."""
    first = min(_FIRST_MARK, budget)
    number = 1 + round(_A_DECADE * np.log10(budget / first))
    return tuple(np.unique(np.geomspace(first, budget, number).round().astype(int)).tolist())


class Record:
    """What a search has found, measured at the marks of its budget of evaluations."""

    def __init__(self, budget: int, scale: Scale, variables: int) -> None:
        self.budget, self.scale = budget, scale
        self.spent, self.marks, self.visits = 0, list[Mark](), Visits()
        self._ahead = list(marks_of(budget))[::-1]
        self._X, self._F = np.empty((0, variables)), np.empty((0, 2))
        self._waiting: list[tuple[Array, Array]] = []

    @property
    def left(self) -> int:
        """Evaluations that are left."""
        return self.budget - self.spent

    @property
    def until_mark(self) -> int:
        """Evaluations until the next mark; 0 once all are spent."""
        return self._ahead[-1] - self.spent if self._ahead else 0

    def non_dominated(self) -> tuple[Array, Array]:
        """Coefficients and objectives of all feasible candidates that no other dominates."""
        if self._waiting:
            X = np.vstack([self._X, *(part for part, _ in self._waiting)])
            F = np.vstack([self._F, *(part for _, part in self._waiting)])
            kept = np.flatnonzero(moocore.is_nondominated(F))
            self._X, self._F, self._waiting = X[kept], F[kept], []
        return self._X, self._F

    def add(self, X: Array, F: Array, usable: NDArray[np.bool_], seconds: float) -> None:
        """Take evaluated candidates, of which those that are usable count as found."""
        first = 0
        while first < len(X):
            part = slice(first, first + self.until_mark)
            kept, count = usable[part], len(X[part])
            self.move_on(count, seconds, X[part][kept], F[part][kept])
            first += count

    def move_on(
        self, evaluations: int, seconds: float, X: Array | None = None, F: Array | None = None
    ) -> None:
        """Count evaluations, up to the next mark at most, with what they gave."""
        self.spent += evaluations
        if X is not None and F is not None and len(X):
            self._waiting.append((X.copy(), F.copy()))
            self.visits += Visits.of(self.scale.scaled(F))
        if self.until_mark == 0:
            volume = self.scale.hypervolume(self.non_dominated()[1])
            self.marks.append(Mark(self._ahead.pop(), seconds, volume))
