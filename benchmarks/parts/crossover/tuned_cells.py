"""The cells in which settings are tuned: where a row of the report rests on a rival's settings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .limits import LIMITS
from .moves import Move
from .problems import CENTRE_KIND, CENTRE_TERMS, Case


@dataclass(frozen=True)
class TunedCell:
    """A cell.

    Attributes
    ----------
    budget : int
        Candidates with which the best settings are tested.
    trials : int
        Candidates of a trial.
    kind : str
        Of the energy.
    limits : tuple of str
        Kinds of limit. A move of tuning has one of them, in turn; a move of testing has all.
    noise : float
        As of `Planned`.
    """

    budget: int = 10_000
    trials: int = 5_000
    kind: str = CENTRE_KIND
    limits: tuple[str, ...] = ("",)
    noise: float = 0.0

    def to_tune(self, moves: Sequence[Move]) -> list[Case]:
        """Return the problems of a trial."""
        return [
            Case(move, CENTRE_TERMS, self.kind, limits=self.limits[i % len(self.limits)])
            for i, move in enumerate(move for move in moves if move.tuning)
        ]

    def to_test(self, moves: Sequence[Move]) -> list[Case]:
        """Return the problems on which the best settings are tested."""
        return [
            Case(move, CENTRE_TERMS, self.kind, limits=limits)
            for limits in self.limits
            for move in moves
        ]


TUNED_CELLS = {
    "centre": TunedCell(),
    "limits": TunedCell(limits=LIMITS),
    "limits-1000": TunedCell(1_000, 1_000, limits=LIMITS),
    "limits-200": TunedCell(200, 200, limits=LIMITS),
    "jumps": TunedCell(kind="motor-map"),
    "noise": TunedCell(noise=0.01),
    "few-200": TunedCell(200, 200),
    "few-200-noise": TunedCell(200, 200, noise=0.01),
    "few-1000": TunedCell(1_000, 1_000),
    "few-1000-noise": TunedCell(1_000, 1_000, noise=0.01),
}


def refuse_cell(name: str) -> None:
    """Refuse a cell in which nothing is tuned."""
    if name not in TUNED_CELLS:
        raise ValueError(f"no cell is called {name!r}; give one of {', '.join(TUNED_CELLS)}")
