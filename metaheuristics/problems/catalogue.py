"""Named problems, each with its exact front.

The fronts are files beside this one; ``quietarm problems --again`` computes them anew.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from math import pi
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.problems.finding import exact_front, swept_front
from quietarm.metaheuristics.problems.function import MoveFunction
from quietarm.models import ArmOnFlexibleLink, DualLinkManipulator, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, Front, JointProfile, PointToPoint, Uncertainty
from quietarm.ocp.checks import unknown

if TYPE_CHECKING:
    from quietarm.metaheuristics.problems.certificate import Certificate
    from quietarm.metaheuristics.problems.pymoo_problem import ExactProblem
    from quietarm.metaheuristics.problems.recorded import RecordedFunction

FRONTS = Path(__file__).parent / "fronts"
"""The exact fronts, in a folder for each plant, where a problem with several has one of its own."""
_FILE_NAME = re.compile(r"[^\W_][\w .+=-]*")


@dataclass(frozen=True)
class NamedProblem:
    """A move, a profile and a box, by name: one of `PROBLEMS`, or one of your own.

    Attributes
    ----------
    name : str
        What it is called; of a named problem its identifier, which stays.
    task : PointToPoint
        The move and its limits.
    profile : JointProfile
        How the joint moves.
    bound : float
        Largest absolute coefficient.
    peak : str
        Quantity whose peak is the third objective; empty where there are two.
    peaks : tuple of float
        Limits on that peak under which the exact fronts of the other two were found.
    version : int
        Of move, profile, box and front; a change of any of them is another version.
    """

    name: str
    task: PointToPoint
    profile: JointProfile
    bound: float
    peak: str = ""
    peaks: tuple[float, ...] = ()
    version: int = 1

    def __post_init__(self) -> None:
        if not _FILE_NAME.fullmatch(self.name):
            raise ValueError(
                f"the name {self.name!r} does not do for a problem; give letters, digits, spaces "
                "and . + = - _ with a letter or digit first: files are called by it"
            )

    def function(self, **settings: Any) -> MoveFunction:
        """It as a function of arrays; settings as for `MoveFunction`: steps and threads."""
        peaks = (self.peak,) if self.peak else ()
        return MoveFunction(self.task, self.profile, bound=self.bound, peaks=peaks, **settings)

    def pymoo(self, **settings: Any) -> ExactProblem:
        """It as a pymoo problem with its exact front; settings as for `function`."""
        from quietarm.metaheuristics.problems.pymoo_problem import ExactProblem

        return ExactProblem(self.function(**settings), *self.exact())

    def tasks(self) -> dict[str, PointToPoint]:
        """The tasks of the exact fronts by the names of their files.

        The problem's own; for a third objective the same under each limit of its peak.
        """
        if not self.peak:
            return {self.name: self.task}
        limit = f"{self.peak}_limit"
        limited: Any = [(most, {limit: most}) for most in self.peaks]
        return {f"{self.name}-{most:g}": replace(self.task, **given) for most, given in limited}

    def fronts(self) -> tuple[Front, ...]:
        """The exact fronts: one, or for a third objective one for each limit.

        Of a named problem from their files; else found by the gradient's sweep, some seconds.
        """
        return tuple(
            _loaded(self._folder / f"{name}.json") if self.named
            else _swept(task, self.profile, self.bound)
            for name, task in self.tasks().items()
        )  # fmt: skip

    @property
    def named(self) -> bool:
        """Whether it is one of `PROBLEMS`."""
        return PROBLEMS.get(self.name) == self

    def recorded(self, **settings: Any) -> RecordedFunction:
        """It as a function of arrays that keeps what it is asked; settings as for `function`."""
        from quietarm.metaheuristics.problems.recorded import RecordedFunction

        return RecordedFunction(self, **settings)

    @property
    def _folder(self) -> Path:
        plant = FRONTS / self.task.plant.name
        return plant / self.name if self.peak else plant

    def certificates(self) -> tuple[Certificate, ...]:
        """What is known of its exact fronts; ValueError where it is none of `PROBLEMS`."""
        from quietarm.metaheuristics.problems.certificate import Certificates

        if not self.named:
            raise ValueError(f"{self.name} comes without a certificate: it is no named problem")
        kept = Certificates.kept()
        return tuple(kept[name] for name in self.tasks())

    def exact(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Coefficients and objectives of the exact front.

        Returns
        -------
        pareto_set : ndarray, shape (points, variables)
            Coefficients; none of the motions dominates another.
        pareto_front : ndarray, shape (points, objectives)
            Residual [m], energy [J] and the third objective.
        """
        import moocore  # not at the top: it takes long to load

        points = [point for front in self.fronts() for point in front.points]
        X = np.array([point.coefficients for point in points])
        F = np.array([(point.residual, point.energy) for point in points])
        if self.peak:
            objectives, _ = self.function()(X)
            F = np.column_stack([F, objectives[:, 2:]])
        kept = moocore.is_nondominated(F)
        return X[kept], F[kept]

    def find_again(self, report: Callable[[str], None] = lambda name: None) -> dict[str, Front]:
        """Find the exact fronts anew, by the gradient; the motions of the old ones are starts.

        Parameters
        ----------
        report : callable, optional
            Called with the name of each when it begins.

        Returns
        -------
        dict of str to Front
            By the names of their files.
        """
        found: dict[str, Front] = {}
        for name, task in self.tasks().items():
            report(name)
            path = self._folder / f"{name}.json"
            known = _loaded(path).points if path.exists() else ()
            found[name] = exact_front(task, self.profile, self.bound, known)
        return found


@cache
def _loaded(path: Path) -> Front:
    return Front.load(path)


@lru_cache(maxsize=64)
def _swept(task: PointToPoint, profile: JointProfile, bound: float) -> Front:
    """The whole front; after Ctrl-C none, as others would be measured against a part of it."""
    front = swept_front(task, profile, bound)
    if not front.complete:
        raise KeyboardInterrupt
    return front


def problem_of(name: str) -> NamedProblem:
    """A named problem; ValueError suggests the nearest one."""
    if name not in PROBLEMS:
        raise ValueError(unknown("problem", name, PROBLEMS))
    return PROBLEMS[name]


_LINK, _ARM, _DUAL = SingleLinkManipulator(), ArmOnFlexibleLink(), DualLinkManipulator()
_LINK_BOX, _ARM_BOX = 0.2, 0.5  # eqs (12) and (17)
_ROBUST_BOX = 0.5
"""In the paper's box no motion leaves less than 17 mm where the frequency is 10 % wrong."""
_LINK_SIXTH = PointToPoint(_LINK, pi / 6, 0.8)
_ARM_HALF = PointToPoint(_ARM, pi / 2, 0.8)


def _problem(
    name: str, task: PointToPoint, bound: float, terms: int = 6, **others: Any
) -> NamedProblem:
    return NamedProblem(name, task, CycloidPolynomial(terms), bound, **others)


_ALL = (
    _problem("single-link-30deg-0.8s", _LINK_SIXTH, _LINK_BOX),
    _problem("single-link-90deg-1s", PointToPoint(_LINK, pi / 2, 1.0), _LINK_BOX),
    _problem("single-link-90deg-1.1s", PointToPoint(_LINK, pi / 2, 1.1), _LINK_BOX),
    _problem("arm-on-flexible-link-90deg-0.8s", _ARM_HALF, _ARM_BOX),
    _problem(
        "arm-on-flexible-link-135deg-1s", PointToPoint(_ARM, pi / 4, 1.0, -pi / 2), _ARM_BOX
    ),
    _problem(
        "arm-on-flexible-link-180deg-1.2s", PointToPoint(_ARM, pi / 2, 1.2, -pi / 2), _ARM_BOX
    ),
    _problem("dual-link-90deg-0.9s", PointToPoint(_DUAL, pi / 2, 0.9), _ARM_BOX),
    _problem("single-link-30deg-0.8s-2-terms", _LINK_SIXTH, _LINK_BOX, 2),
    _problem("single-link-30deg-0.8s-4-terms", _LINK_SIXTH, _LINK_BOX, 4),
    _problem("single-link-30deg-0.8s-10-terms", _LINK_SIXTH, _LINK_BOX, 10),
    _problem("single-link-30deg-0.8s-20-terms", _LINK_SIXTH, _LINK_BOX, 20),
    _problem("arm-on-flexible-link-90deg-0.8s-2-terms", _ARM_HALF, _ARM_BOX, 2),
    _problem("arm-on-flexible-link-90deg-0.8s-12-terms", _ARM_HALF, _ARM_BOX, 12),
    _problem(
        "single-link-30deg-0.8s-limits",
        replace(_LINK_SIXTH, torque_limit=0.16, speed_limit=0.99, deflection_limit=0.03),
        _LINK_BOX,
    ),
    _problem(
        "arm-on-flexible-link-90deg-0.8s-limits",
        replace(_ARM_HALF, torque_limit=0.3, acceleration_limit=75.0),
        _ARM_BOX,
    ),
    _problem(
        "single-link-30deg-0.8s-torque", _LINK_SIXTH, _LINK_BOX,
        peak="torque", peaks=(0.1, 0.115, 0.13, 0.145, 0.16, 0.18),
    ),
    _problem(
        "single-link-30deg-0.8s-robust",
        replace(_LINK_SIXTH, uncertainty=Uncertainty({"frequency": 0.1})),
        _ROBUST_BOX,
    ),
)  # fmt: skip

PROBLEMS: Mapping[str, NamedProblem] = MappingProxyType({problem.name: problem for problem in _ALL})
"""By name, of plant, angle and duration; six terms and no limits where nothing else is said."""
