"""What the name of a method says: the one place where it is read, and written."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

from quietarm.ocp.checks import spelling
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.ocp.solvers.sqp import Sqp

POLISH = "+polish"
"""What a job adds to the name of a search whose front is polished by the gradient."""
_POLISHED = (", polished", POLISH)
"""What ends the name of such a front's method: of `polish_front`, and of a job."""
BY_GRADIENT = ("epsilon", "weighted", "multistart")
"""Methods that find fronts by the gradient alone; each may name its solver, as epsilon:ipopt."""


@dataclass(frozen=True)
class NamedMethod:
    """A method by its name, as jobs, files and the command line have it.

    Attributes
    ----------
    method : str
        A search, as nsga2; a method by the gradient, as epsilon; or a method of one's own.
    solver : str
        Name of the solver of a method by the gradient; empty where none is named.
    polish : bool
        Whether its front is polished by the gradient.
    settings : str
        What stands behind it in brackets, in the label of a job.
    """

    method: str
    solver: str = ""
    polish: bool = False
    settings: str = ""

    @classmethod
    def read(cls, text: str) -> NamedMethod:
        """Read nsga2, nsga2+polish, epsilon:ipopt or nsga2+polish(population=20); any other name.

        Whether there is such a method is not asked.
        """
        name, bracket, settings = text.partition("(")
        alone = name
        for ending in _POLISHED:
            alone = alone.removesuffix(ending)
        method, _, solver = alone.partition(":")
        if method not in BY_GRADIENT:
            method, solver = alone, ""
        return cls(method, solver, alone != name, f"{bracket}{settings}")

    @classmethod
    def of_typed(cls, text: str, searches: Iterable[str]) -> str:
        """A name as it is written here, however it was spelt: NSGA-II+polish is nsga2+polish."""
        known = {spelling(name): name for name in (*searches, *GRADIENT)}
        name, *rest = re.split(r"(?=[+.])", text.strip(), maxsplit=1)
        return "".join([known.get(spelling(name), name), *rest])

    def __str__(self) -> str:
        solver = f":{self.solver}" if self.solver else ""
        return f"{self.method}{solver}{POLISH * self.polish}{self.settings}"

    @property
    def by_gradient(self) -> bool:
        """Whether it is the gradient's alone: such a front lies on a line, polished or not."""
        return self.method in BY_GRADIENT

    @property
    def is_gradient_job(self) -> bool:
        """Whether a job of this name is one by the gradient: such a front is polished already."""
        return str(self) in GRADIENT

    def polished(self) -> NamedMethod:
        """Return this method with its front polished."""
        return replace(self, polish=True)


GRADIENT = tuple(
    str(NamedMethod(name, "" if solver == Sqp.name else solver))
    for name in BY_GRADIENT
    for solver in SOLVERS
)
"""Names of the methods by the gradient; without a solver it is the own SQP."""
