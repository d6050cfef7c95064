"""Errors that may be raised, and the status with which a solve ended."""

from __future__ import annotations

from enum import Enum


class QuietarmError(Exception):
    """Base of quietarm's own exceptions."""


class SolverFailedError(QuietarmError):
    """No start of the solver ended at an optimum; the text says why and what to try."""


class InfeasibleTaskError(SolverFailedError):
    """No motion of the given profile is feasible; the text says what would be.

    Parameters
    ----------
    what : str
        What was not found, and limits with which it would be.
    remedy : str, optional
        What else will do, or may.
    """

    def __init__(self, what: str, remedy: str = "") -> None:
        super().__init__("; ".join(filter(None, [what, remedy])))
        self.what = what

    def __reduce__(self) -> tuple[type[InfeasibleTaskError], tuple[str]]:
        return type(self), (str(self),)


class FileFormatError(QuietarmError, ValueError):
    """A file is not what it should be: truncated, of another kind, or of a newer version."""


class SolveStatus(Enum):
    """The end of a solve; `value` is written to files, `text` is shown to the user."""

    OPTIMAL = "optimal"
    ACCEPTABLE = "acceptable"
    INFEASIBLE = "infeasible"
    ITERATION_LIMIT = "iteration limit"
    NUMERICAL_TROUBLE = "numerical trouble"
    SUPERSEDED = "superseded"
    NOT_CERTIFIED = "not certified"
    NOT_OPTIMISED = "not optimised"

    @property
    def solved(self) -> bool:
        """Return whether there is a local optimum, or a feasible motion close to one."""
        return self in (SolveStatus.OPTIMAL, SolveStatus.ACCEPTABLE)

    @property
    def text(self) -> str:
        """Words on what happened and what to try."""
        return _TEXTS[self]

    @classmethod
    def from_ipopt(cls, return_status: str) -> SolveStatus:
        """Translate IPOPT's own status; KeyboardInterrupt when the user stopped the solve."""
        if return_status == "User_Requested_Stop":
            raise KeyboardInterrupt
        return _FROM_IPOPT.get(return_status, cls.NUMERICAL_TROUBLE)


_TEXTS = {
    SolveStatus.OPTIMAL: "The solver found a local optimum.",
    SolveStatus.ACCEPTABLE: "The solver stopped at a feasible motion, where the objective hardly "
    "decreased any more; more steps or another seed may improve it.",
    SolveStatus.INFEASIBLE: "The solver converged to an infeasible motion; allow a larger "
    "residual, wider limits, a longer duration or more terms.",
    SolveStatus.ITERATION_LIMIT: "The solver ran out of iterations; allow it more, or try another "
    "seed, more starts or a bound on the coefficients.",
    SolveStatus.NUMERICAL_TROUBLE: "The solver failed numerically; try another seed, fewer terms "
    "or a bound on the coefficients.",
    SolveStatus.SUPERSEDED: "The solver stopped this start: another one led to an energy as low.",
    SolveStatus.NOT_CERTIFIED: "By CVODES the motion exceeds a limit, although the limits were "
    "tightened; bound the coefficients or use fewer terms.",
    SolveStatus.NOT_OPTIMISED: "The motion was given, not optimised.",
}

_FROM_IPOPT = {
    "Solve_Succeeded": SolveStatus.OPTIMAL,
    "Solved_To_Acceptable_Level": SolveStatus.ACCEPTABLE,
    "Feasible_Point_Found": SolveStatus.ACCEPTABLE,
    "Infeasible_Problem_Detected": SolveStatus.INFEASIBLE,
    "Not_Enough_Degrees_Of_Freedom": SolveStatus.INFEASIBLE,
    "Maximum_Iterations_Exceeded": SolveStatus.ITERATION_LIMIT,
}
