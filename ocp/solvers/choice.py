"""The solvers by the names that users give."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.solvers.ipopt import Ipopt
from quietarm.ocp.solvers.problem import Problem, Solution
from quietarm.ocp.solvers.sqp import Sqp

SolverName = Literal["sqp", "ipopt"]
SOLVERS: tuple[str, ...] = get_args(SolverName)


class Solver(Protocol):
    """What solves problems: `Sqp` or `Ipopt`."""

    def solve(
        self,
        problems: Sequence[Problem],
        starts: Sequence[NDArray[np.float64]],
        *,
        warm: bool = False,
        groups: Sequence[int] | None = None,
    ) -> list[Solution]:
        """Solve each problem from its start; see `Sqp.solve`."""
        ...


def solver_of(settings: SolveSettings) -> Solver:
    """The solver that settings ask for."""
    if settings.solver == "sqp":
        return Sqp(log=settings.log)
    return Ipopt(print_level=5 if settings.log else 0)
