"""A case: a task, the box that its coefficients stay in, and its name."""

from __future__ import annotations

from dataclasses import dataclass

from quietarm.metaheuristics import PAPER_BOX
from quietarm.ocp import PointToPoint
from quietarm.ocp.base.checks import positive


@dataclass(frozen=True)
class Case:
    """A task and the box that its coefficients stay in."""

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
