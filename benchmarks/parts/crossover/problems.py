"""The problems of the experiment, each with a front that fixes its scale."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pandas as pd

import quietarm as qa
from quietarm.metaheuristics import NamedProblem
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.networks import CycloidGaussians
from quietarm.ocp.profiles.term_profile import TermProfile

from .chosen_shaper import chosen_shaper
from .energies import energy_of
from .integers import IntegerProfile, scale_of_every_number
from .limits import limits_of
from .moves import Move, draw, plants
from .shared_terms import SharedTerms
from .tables import write_table

CENTRE_TERMS = 6
CENTRE_KIND = "absolute"
CENTRE_FAMILY = "polynomial"
FAMILIES: Mapping[str, type[TermProfile]] = {
    CENTRE_FAMILY: qa.CycloidPolynomial,
    "spline": qa.CycloidSpline,
    "gaussians": CycloidGaussians,
}
INTEGERS = ("integer", "shaper")
"""Kinds whose first coefficient is an integer: how many terms, which shaper."""
ROBUST = {"frequency": 0.05}
"""Errors over which a robust residual is the worst: those that a task with a band has by default.
"""


QUICK: Mapping[str, Any] = {"points": 40, "at": LEVELS, "starts": 12}
QUICKER: Mapping[str, Any] = {"points": 12, "starts": 4}
"""Effort of the fronts whose ends are a scale: the second of families and shapers."""


@dataclass(frozen=True)
class Case:
    """A move with a number of coefficients and a kind of energy.

    Attributes
    ----------
    move : Move
        The random move.
    terms : int
        Coefficients of the path.
    kind : str
        Of the energy, as of `energy_of`.
    peaks : tuple of str
        Objectives beside residual and energy.
    limits : str
        Limits of the move, as of `limits_of`; empty for none.
    family : str
        Family of the path, of `FAMILIES`.
    is_robust : bool
        Whether the residual is the largest over the errors of `ROBUST`.
    """

    move: Move
    terms: int = CENTRE_TERMS
    kind: str = CENTRE_KIND
    peaks: tuple[str, ...] = ()
    limits: str = ""
    family: str = CENTRE_FAMILY
    is_robust: bool = False

    @property
    def name(self) -> str:
        """Name of move, coefficients and energy; files are called by it."""
        more = f"-{2 + len(self.peaks)}-objectives" if self.peaks else ""
        more += f"-{self.limits}" if self.limits else ""
        more += f"-{self.family}" if self.family != CENTRE_FAMILY else ""
        more += "-robust" if self.is_robust else ""
        return f"{self.move.name}-{self.terms}-{self.kind}{more}"

    @property
    def task(self) -> qa.PointToPoint:
        """The move with its energy, limits and errors."""
        move = self.move
        energy = energy_of(self.kind, move.plant, move.target, move.duration)
        return qa.PointToPoint(
            move.plant,
            move.target,
            move.duration,
            energy=energy,
            uncertainty=qa.Uncertainty(ROBUST) if self.is_robust else None,
            **limits_of(move.name, self.limits),
        )

    @property
    def profile(self) -> JointProfile:
        """The family's member with so many coefficients; the first may be an integer."""
        return self.integer_profile or FAMILIES[self.family].of_size(self.terms)

    @property
    def integer_profile(self) -> IntegerProfile | None:
        """The profile whose first coefficient is an integer; None where there is none."""
        if self.kind == "integer":
            return SharedTerms(self.terms - 1)
        if self.kind == "shaper":
            return chosen_shaper(self.task, self.terms - 1)
        return None

    @property
    def bound(self) -> float:
        """Box of the coefficients: the move's, or by default the family's where it is another."""
        default = FAMILIES[self.family].default_bound
        return self.move.bound if default is None else default

    @property
    def has_integer(self) -> bool:
        """Return whether an integer stands beside the coefficients."""
        return self.kind in INTEGERS

    def problem(self, folder: Path) -> NamedProblem:
        """With the front that fixes its scale, which a folder keeps."""
        return _problem(self, folder)


@cache
def _problem(case: Case, folder: Path) -> NamedProblem:
    path = folder / "scales" / f"{case.name}.json"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        scale_front(case).save(path)
    return NamedProblem.of_front(case.name, qa.Front.load(path))


def scale_front(case: Case) -> qa.Front:
    """A quick front of a case, by the gradient: its ends are 0 and 1 of the scale of all figures.

    Where the energy jumps, the front of the absolute power is taken, with its energies by the map:
    solvers take long there, and a scale needs no optimum.
    """
    integer = case.integer_profile
    if integer is not None:
        effort = QUICKER if case.kind == "shaper" else QUICK
        return scale_of_every_number(case.task, integer, case.bound, effort)
    profile = case.profile
    if case.peaks:
        return qa.epsilon_front(
            case.task,
            profile,
            bound=case.bound,
            points=50,
            objectives=("residual", "energy", *case.peaks),
        )
    smooth = Case(case.move, case.terms) if case.kind == "motor-map" else case
    effort = QUICK if case.family == CENTRE_FAMILY else QUICKER
    front = qa.epsilon_front(smooth.task, profile, bound=case.bound, **effort)
    if smooth is case:
        return front
    return qa.Front.from_coefficients(
        case.task,
        front.coefficients,
        method="the gradient's motions of least absolute power",
        profile=profile,
        bound=case.bound,
    )


def read_moves(path: Path) -> tuple[Move, ...]:
    """The moves of a table, which is drawn and written where it is missing."""
    if not path.exists():
        write_moves(draw(), path)
    plant_of = {plant.name: plant for plant in plants()}
    table = pd.read_csv(path)
    return tuple(
        Move(
            row.move,
            plant_of[row.plant],
            row.target,
            row.duration,
            row.bound,
            row.use == "tune",
            row.redrawn,
        )
        for row in table.itertuples()
    )


def write_moves(moves: tuple[Move, ...], path: Path) -> None:
    """A table of moves."""
    rows = [
        {
            "move": move.name,
            "plant": move.plant.name,
            "target": move.target,
            "duration": move.duration,
            "bound": move.bound,
            "use": "tune" if move.tuning else "test",
            "redrawn": move.redrawn,
        }
        for move in moves
    ]
    write_table(pd.DataFrame(rows), path, 17)
