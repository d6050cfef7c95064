"""Front: the trade-off between residual and energy, by whatever method it was found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ocp.answers.documents import Upgrades
from ocp.answers.older import front_of_version_2
from ocp.answers.provenance import Setting, versions
from ocp.answers.saved import Saved
from ocp.base.ranges import Count, NotNegative, Positive
from ocp.base.readonly import ReadOnlyDict
from ocp.front.points import FailedPoint, FrontPoint, Generation, non_dominated
from ocp.profiles.joint_profile import JointProfile
from ocp.profiles.polynomial import CycloidPolynomial
from ocp.simulation.rollout import rollout
from ocp.task.point_to_point import PointToPoint

LEAST_REFERENCE = 1e-3
"""Where the plain cycloid arrives nearly still, its residual is no scale for hypervolumes [m]."""


@dataclass(frozen=True)
class Front(Saved):
    """Points of which none is better than another in both residual and energy.

    Attributes
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    points : tuple of FrontPoint
        Sorted by residual, stillest first; energies fall along the front.
    method : str
        How it was found.
    settings : dict
        Settings of the method, the bound on the coefficients among them.
    seed : int or None
        Seed of the random numbers.
    reference : tuple of float
        Residual [m] and energy [J] of the corner that hypervolumes are measured from.
    evaluations : int
        Candidates that a search evaluated.
    iterations : int
        Iterations of the gradient's solver.
    failed : int
        Candidates whose figures were not finite, or absurdly large; they never enter a front.
    infeasible : int
        Candidates that broke a limit of the task; nor do they.
    failures : tuple of FailedPoint
        Points of a sweep that could not be found, with the reason.
    gaps : tuple of (float, float)
        Ranges of the residual [m] in which a weighted sum has no point, whatever the weight.
    history : tuple of Generation
        Hypervolume by generation.
    complete : bool
        Whether the method ran to its end.
    versions : dict of str to str
        Versions of what computed it.
    seconds : float
        How long it took; not compared.
    """

    kind: ClassVar[str] = "front"
    version: ClassVar[int] = 3
    upgrades: ClassVar[Upgrades] = {2: front_of_version_2}  # 1 was before any release

    task: PointToPoint
    profile: JointProfile
    points: tuple[FrontPoint, ...]
    method: str
    settings: Mapping[str, Setting]
    seed: Count | None
    reference: tuple[Positive, Positive]
    evaluations: Count = 0
    iterations: Count = 0
    failed: Count = 0
    infeasible: Count = 0
    failures: tuple[FailedPoint, ...] = ()
    gaps: tuple[tuple[NotNegative, NotNegative], ...] = ()
    history: tuple[Generation, ...] = ()
    complete: bool = True
    versions: Mapping[str, str] = field(default_factory=versions)
    seconds: NotNegative = field(default=0.0, compare=False)

    def __post_init__(self) -> None:
        for name in ("settings", "versions"):
            object.__setattr__(self, name, ReadOnlyDict(getattr(self, name)))
        for point in self.points:
            self.profile.checked(point.coefficients)
        if self.points != non_dominated(self.points):
            raise ValueError("its points are out of order, or one is better than another")

    @property
    def residuals(self) -> NDArray[np.float64]:
        """F1 of every point [m]."""
        return np.array([point.residual for point in self.points])

    @property
    def energies(self) -> NDArray[np.float64]:
        """F2 of every point [J]."""
        return np.array([point.energy for point in self.points])

    def stillest(self) -> FrontPoint:
        """The point of least residual; ValueError when the front is empty."""
        return self._nonempty()[0]

    def cheapest(self, residual_limit: float | None = None) -> FrontPoint:
        """The point of least energy.

        Parameters
        ----------
        residual_limit : float, optional
            Largest residual [m] that counts; any by default.

        Returns
        -------
        FrontPoint
            The point.

        Raises
        ------
        ValueError
            When no point is within the limit, with the least residual there is.
        """
        points = self._nonempty()
        if residual_limit is None:
            return points[-1]
        still = [point for point in points if point.residual <= residual_limit]
        if not still:
            raise ValueError(
                f"no point of the front has a residual of {residual_limit:g} m or less; the "
                f"stillest has {points[0].residual:.3g} m"
            )
        return still[-1]

    def knee(self) -> FrontPoint:
        """The point farthest below the straight line between the ends, both objectives scaled."""
        points = self._nonempty()
        spans = np.array([np.ptp(self.residuals), np.ptp(self.energies)])
        if len(points) < 3 or not np.all(spans > 0):
            return points[0]
        scaled = np.column_stack([self.residuals, self.energies]) / spans
        return points[int(np.argmin(scaled.sum(axis=1)))]

    def _nonempty(self) -> Sequence[FrontPoint]:
        if len(self.points) == 0:
            raise ValueError(self.why_empty())
        return self.points

    def why_empty(self) -> str:
        """Why there is no point, from what became of the candidates, and what to try."""
        none = "the front has no point;"
        if 0 < self.evaluations == self.failed:
            return f"{none} the motions of all {self.failed} candidates overflow; narrow the bound"
        if self.infeasible == 0:
            return f"{none} search longer or widen the bound"
        limits = ", ".join(f"{name} {limit:g}" for name, limit in self.task.limits.items())
        overflow = f" and the motions of {self.failed} overflow" if self.failed else ""
        return (
            f"{none} {self.infeasible} of {self.evaluations} candidates break the limits ({limits})"
            f"{overflow}; widen them or the bound, or search longer"
        )


def reference_corner(task: PointToPoint) -> tuple[float, float]:
    """The corner that hypervolumes of a task's fronts are measured from.

    Parameters
    ----------
    task : PointToPoint
        The move.

    Returns
    -------
    tuple of float
        Residual [m] of the plain cycloid, 1 mm at least, and twice its energy [J].
    """
    cycloid = rollout(task, CycloidPolynomial(0), []).motion
    return max(cycloid.residual, LEAST_REFERENCE), 2 * cycloid.energy
