"""Names of methods: the one place where they are read, admitted and written."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

from quietarm.ocp.checks import spelling, unknown
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

        Whether there is such a method `admitted` asks. The solver that a method has anyway is not
        named: epsilon:sqp is epsilon.
        """
        name, bracket, settings = text.partition("(")
        alone = name
        for ending in _POLISHED:
            alone = alone.removesuffix(ending)
        method, _, solver = alone.partition(":")
        if method not in BY_GRADIENT:
            method, solver = alone, ""
        if solver == Sqp.name:
            solver = ""
        return cls(method, solver, alone != name, f"{bracket}{settings}")

    @classmethod
    def admitted(cls, text: str, searches: Collection[str]) -> NamedMethod:
        """Read the name of a method that a job may have; ValueError says why another is none.

        A search may be polished; a method by the gradient is polished already, and may name its
        solver.
        """
        named = cls.read(text)
        is_search = named.method in searches
        if named.by_gradient and named.polish:
            raise ValueError(
                f"{text} is polished already: its front is by the gradient; give "
                f"{replace(named, polish=False)}"
            )
        if named.by_gradient and named.solver not in ("", *SOLVERS):
            raise ValueError(unknown("solver", named.solver, SOLVERS))
        if named.settings or not (is_search or named.by_gradient):
            others = f", NAME{POLISH} of a search, NAME:{' or NAME:'.join(SOLVERS)} of the gradient"
            raise ValueError(unknown("method", text, [*searches, *BY_GRADIENT], others))
        return named

    @classmethod
    def of_typed(cls, text: str, searches: Iterable[str]) -> str:
        """A name as it is written here, however it was spelt: NSGA-II+polish is nsga2+polish."""
        methods = {spelling(name): name for name in (*searches, *BY_GRADIENT)}
        solvers = {spelling(name): name for name in SOLVERS}
        name, *rest = re.split(r"(?=[+.])", text.strip(), maxsplit=1)
        if spelling(name) in methods:
            return "".join([methods[spelling(name)], *rest])
        method, colon, solver = name.partition(":")
        method = methods.get(spelling(method), method)
        solver = solvers.get(spelling(solver), solver)
        return "".join([str(cls.read(f"{method}{colon}{solver}")), *rest])

    def __str__(self) -> str:
        solver = f":{self.solver}" if self.solver else ""
        return f"{self.method}{solver}{POLISH * self.polish}{self.settings}"

    @property
    def by_gradient(self) -> bool:
        """Return whether this is by the gradient alone: its front is a line, polished or not."""
        return self.method in BY_GRADIENT

    def polished(self) -> NamedMethod:
        """Return this method with its front polished."""
        return replace(self, polish=True)
