"""The runs on which a row of the report's first table rests: they get most seeds.

A row compares the search that it names with SLSQP or with the gradient. The search is chosen on the
first seeds, which are few and have all methods; these runs judge it on fresh ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .plan import Planned
from .problems import CENTRE_TERMS


@dataclass(frozen=True)
class Deciding:
    """Runs of a row.

    Attributes
    ----------
    axes : tuple of str
        As of `Planned`.
    budget : int
        Candidates.
    labels : tuple of str
        Methods with their settings, of the search and its rival.
    kind : str
        Part of the name of the energy's kind; every kind where empty.
    """

    axes: tuple[str, ...]
    budget: int
    labels: tuple[str, ...]
    kind: str = ""

    def has(self, planned: Planned) -> bool:
        """Return whether a job of the plan is one of these."""
        return (
            planned.axis in self.axes
            and planned.budget == self.budget
            and planned.case.terms == CENTRE_TERMS
            and self.kind in planned.case.kind
            and f"{planned.method} {planned.words}".strip() in self.labels
        )


DECIDING = {
    "centre": Deciding(("centre",), 10_000, ("moead-de", "slsqp")),
    "limits": Deciding(("limits",), 10_000, ("moead-de", "slsqp")),
    "limits-1000": Deciding(("limits",), 1_000, ("gp", "slsqp")),
    "limits-200": Deciding(("limits",), 200, ("gp", "slsqp")),
    "jumps": Deciding(("energy",), 10_000, ("moead-de", "slsqp"), "motor-map"),
    "noise": Deciding(
        ("noise",),
        10_000,
        ("moead-de reevaluate=5 noise=0.01", "slsqp step=0.01 noise=0.01"),
    ),
    "few-200": Deciding(("few",), 200, ("gp", "slsqp")),
    "few-200-noise": Deciding(("few",), 200, ("gp noise=0.01", "slsqp step=0.01 noise=0.01")),
    "few-1000": Deciding(("crossing", "few"), 1_000, ("gp", "slsqp")),
    "few-1000-noise": Deciding(("few",), 1_000, ("gp noise=0.01", "slsqp step=0.01 noise=0.01")),
    "objectives": Deciding(("objectives",), 10_000, ("moead-de",)),
}  # fmt: skip
"""By row; `python benchmarks/crossover.py FOLDER --deciding NAME ...` runs those that are named."""


def refuse_rows(names: Sequence[str]) -> None:
    """Refuse a row that is not of the report."""
    for name in names:
        if name not in DECIDING:
            raise ValueError(f"no row is called {name!r}; give one of {', '.join(DECIDING)}")


def rows_of(names: Sequence[str] | None) -> list[Deciding] | None:
    """Return the runs of rows by their names, of all without a name; None where not asked."""
    return None if names is None else [DECIDING[name] for name in names or DECIDING]
