"""Random moves of five plants, by which docs/results compares methods, as tasks by name.

A name says the move, the coefficients and the energy, and after these the limits or the number of
objectives, such as ``single-link-m4-6-absolute-torque-tight``. The moves were drawn by a stated
seed and rule (docs/results/appendix.md, "How"); their tables are in the folder `drawn`.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from quietarm.models import (
    ArmOnFlexibleLink,
    DualLinkManipulator,
    FlexibleBeam,
    LinearAxis,
    Plant,
    SingleLinkManipulator,
)
from quietarm.ocp import AbsolutePower, CopperLoss, CycloidPolynomial, Energy, PointToPoint
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY

TABLES = Path(__file__).parent / "drawn"
TERMS = (2, 4, 6, 10, 16, 24)
CENTRE = 6
ENERGIES = {"absolute": AbsolutePower(), "copper": CopperLoss(0.12)}
"""Energies by their names; copper losses are asked for on the moves with several kinds."""
PEAKS = ("peak_torque", "peak_deflection")


@dataclass(frozen=True)
class DrawnMove:
    """A random move with a number of coefficients, a kind of energy, limits and peaks.

    Attributes
    ----------
    plant : Plant
        With its default parameters.
    target, duration : float
        Angle [rad] or place [m], and seconds.
    bound : float
        Largest absolute coefficient.
    terms : int
        Coefficients.
    kind : str
        Energy, one of `ENERGIES`.
    limits : mapping of str to float
        Limits by their names in a task.
    peaks : tuple of str
        Objectives beside residual and energy.
    """

    plant: Plant
    target: float
    duration: float
    bound: float
    terms: int = CENTRE
    kind: str = "absolute"
    limits: Mapping[str, float] | None = None
    peaks: tuple[str, ...] = ()

    @property
    def energy(self) -> Energy:
        """The energy that the move is judged by."""
        return ENERGIES[self.kind]

    @property
    def task(self) -> PointToPoint:
        """The move with its energy and limits."""
        limits: Any = self.limits or {}
        return PointToPoint(self.plant, self.target, self.duration, energy=self.energy, **limits)

    @property
    def profile(self) -> CycloidPolynomial:
        """The paper's polynomial."""
        return CycloidPolynomial(self.terms)

    @property
    def objectives(self) -> tuple[str, ...]:
        """Residual, energy and peaks."""
        return (*RESIDUAL_AND_ENERGY, *self.peaks)


@cache
def drawn_moves() -> Mapping[str, DrawnMove]:
    """Return all drawn moves by the names of their problems."""
    rows = [row for row in _rows("moves.csv") if row["use"] == "test"]
    plants = {
        plant.name: plant
        for plant in (
            SingleLinkManipulator(),
            ArmOnFlexibleLink(),
            DualLinkManipulator(),
            FlexibleBeam(),
            LinearAxis(),
        )
    }
    limits = _limits()
    moves = dict[str, DrawnMove]()
    of_plant = dict.fromkeys(plants, 0)
    for row in rows:
        of_plant[row["plant"]] += 1
        move = DrawnMove(
            plants[row["plant"]], float(row["target"]), float(row["duration"]), float(row["bound"])
        )
        every_kind = of_plant[row["plant"]] <= 2  # the first two moves of a plant
        moves |= dict(_variants(row["move"], move, limits[row["move"]], every_kind))
    return moves


def drawn_groups() -> dict[str, list[str]]:
    """Return the names of all drawn problems by what they end in after their move's name."""
    groups = dict[str, list[str]]()
    for name in drawn_moves():
        move = re.match(r".*?-m\d+(?=-)", name)
        ending = name[move.end() :] if move else name
        groups.setdefault(ending, []).append(name)
    return groups


def _variants(
    name: str, move: DrawnMove, limits: Mapping[str, Mapping[str, float]], every_kind: bool
) -> Iterator[tuple[str, DrawnMove]]:
    """Yield the problems of a move by their names."""
    for terms in TERMS:
        yield f"{name}-{terms}-absolute", replace(move, terms=terms)
    centre = f"{name}-{CENTRE}"
    for kind, of_kind in limits.items():
        yield f"{centre}-absolute-{kind}", replace(move, limits=of_kind)
    if not every_kind:
        return
    yield f"{centre}-copper", replace(move, kind="copper")
    for count in (1, 2):
        yield f"{centre}-absolute-{2 + count}-objectives", replace(move, peaks=PEAKS[:count])


def _limits() -> dict[str, dict[str, dict[str, float]]]:
    """Limits by move and kind, by their names in a task."""
    limits = dict[str, dict[str, dict[str, float]]]()
    for row in _rows("limits.csv"):
        of_kind = limits.setdefault(row["move"], {}).setdefault(row["limits"], {})
        of_kind[f"{row['quantity']}_limit"] = float(row["value"])
    return limits


def _rows(name: str) -> Iterator[dict[str, str]]:
    """The rows of a table."""
    with (TABLES / name).open(newline="") as file:
        yield from csv.DictReader(file)
