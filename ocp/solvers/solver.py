"""What solves problems, as a value that users pass: its name and its options."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import positive, whole
from quietarm.ocp.record import Setting
from quietarm.ocp.solvers.problem import NonlinearProgram, Solution

NAME = "solver"
"""What a record calls it; an option that is not the default stands beside, as solver_tolerance."""
OPTIONS = ("tolerance", "iterations")
"""Those on which an answer depends."""


@dataclass(frozen=True)
class Solver:
    """A solver and its options: `Sqp` or `Ipopt`.

    The same value is taken wherever a solver is chosen, and what is tried where it fails has its
    options as well.

    Parameters
    ----------
    tolerance : float
        Share of the objective that a solution may be above its minimum, as the last step predicts
        it. Limits and rest on arrival are kept as exactly as ever.
    iterations : int
        Most iterations of one solve.
    log : bool
        Whether a line is printed for each iteration.

    Raises
    ------
    ValueError
        When an option is out of range.
    """

    example: ClassVar[str] = "a solver, as Sqp() or Ipopt(tolerance=1e-7)"
    name: ClassVar[str]

    tolerance: float = 1e-9
    iterations: int = 500
    log: bool = False

    def __post_init__(self) -> None:
        tolerance = positive(
            "tolerance of the solver", self.tolerance, most=0.01, why="it is a share"
        )
        iterations = whole(
            "iterations of the solver",
            self.iterations,
            1,
            1_000_000,
        )
        object.__setattr__(self, "tolerance", tolerance)
        object.__setattr__(self, "iterations", iterations)

    def solve(
        self,
        problems: Sequence[NonlinearProgram],
        starts: Sequence[NDArray[np.float64]],
        *,
        warm: bool = False,
        groups: Sequence[int] | None = None,
    ) -> list[Solution]:
        """Solve each problem from its start.

        Parameters
        ----------
        problems : sequence of NonlinearProgram
            Of any tasks, steps and scalarizations.
        starts : sequence of ndarray, each of shape (profile.size,)
            Coefficients to start from.
        warm : bool
            Whether the starts are beside minima.
        groups : sequence of int, optional
            Problems of one number are one problem from several starts: a solver may stop the others
            once half of them, and more than one, agree on the least objective.

        Returns
        -------
        list of Solution
            In the order of the problems.
        """
        raise NotImplementedError

    @property
    def stated(self) -> dict[str, Setting]:
        """What a record says of it: its name, and options that are not the default."""
        usual = {option.name: option.default for option in fields(self)}
        options = {
            f"{NAME}_{name}": getattr(self, name)
            for name in OPTIONS
            if getattr(self, name) != usual[name]
        }
        return {NAME: self.name, **options}

    def as_kind(self, kind: type[Solver]) -> Solver:
        """A solver of another kind with the options of this one."""
        return kind(self.tolerance, self.iterations, self.log)
