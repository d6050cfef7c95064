"""A case: a task, the box that its coefficients stay in, and its name."""

from __future__ import annotations

from dataclasses import dataclass

from quietarm.metaheuristics import PAPER_BOX
from quietarm.ocp import PointToPoint
from quietarm.ocp.base.checks import positive


@dataclass(frozen=True)
class Case:
    """A task and the box that its coefficients stay in.

    Parameters
    ----------
    task : PointToPoint
        The move.
    bound : float, optional
        Largest absolute coefficient; the paper's for its plants.
    label : str, optional
        What the paper calls the move; empty for a task that is not the paper's.

    Raises
    ------
    ValueError
        When there is no bound, or it is not positive.
    """

    task: PointToPoint
    bound: float | None = None
    label: str = ""

    def __post_init__(self) -> None:
        bound = PAPER_BOX.get(self.task.plant.name) if self.bound is None else self.bound
        if bound is None:
            raise ValueError(
                f"give a bound on the coefficients: the paper has none for {self.task.plant.name}"
            )
        object.__setattr__(self, "bound", positive("bound on the coefficients", bound))

    @property
    def name(self) -> str:
        """Plant and move."""
        return f"{self.task.plant.name}, {self.label}"
