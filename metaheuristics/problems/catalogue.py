"""Named problems, each with its reference front.

The fronts are files beside this one; benchmarks/reference_fronts makes and verifies them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from math import inf, pi
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.problems.drawn_moves import drawn_moves
from quietarm.metaheuristics.problems.function import MoveFunction
from quietarm.metaheuristics.problems.problem_function import ProblemFunction
from quietarm.models import ArmOnFlexibleLink, DualLinkManipulator, Plant, SingleLinkManipulator
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    JointProfile,
    NoTaskError,
    PointToPoint,
    Uncertainty,
    epsilon_front,
    non_dominated,
)
from quietarm.ocp.checks import clipped, quoted, takes, unknown
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, checked_objectives, peak_quantities
from quietarm.ocp.window import EQ_11

if TYPE_CHECKING:
    from quietarm.metaheuristics.problems.pymoo_problem import PymooProblem
    from quietarm.metaheuristics.problems.recorded import RecordedFunction
    from quietarm.metaheuristics.score import Reference

_IN_PYTHON = (
    "make NamedProblem.of_function('mine', function, reference_front=front) in Python "
    "(docs/problems.md)"
)
"""What makes a problem of a user's own function."""
FRONTS = Path(__file__).parent / "fronts"
"""The reference fronts, in a folder for each plant, where a problem with several has one of its
own."""


@dataclass(frozen=True)
class NamedProblem:
    """A move, a profile and bounds, by name: one of `PROBLEMS`, or one of your own.

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
    objectives : tuple of str
        Names of its objectives: residual, energy, and peaks beside them.
    peak_limits : tuple of float
        Of a named problem with one peak, the limits on it under which the reference fronts of
        residual and energy were found.
    version : int
        Of move, profile, box and front; a change of any of them is another version.
    reference_front : Front, optional
        Of a problem of your own; where there is none, the gradient finds it.
    given : ProblemFunction, optional
        Of a problem by `of_function`, the function; task and profile are then its box and names.
    """

    name: str
    task: PointToPoint
    profile: JointProfile
    bound: float
    objectives: tuple[str, ...] = RESIDUAL_AND_ENERGY
    peak_limits: tuple[float, ...] = ()
    version: int = 1
    reference_front: Front | None = field(default=None, compare=False)
    given: ProblemFunction | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        file_name = re.compile(r"[^\W_][\w .+=-]*")
        if not file_name.fullmatch(self.name):
            raise ValueError(
                f"the name {self.name!r} does not do for a problem; give letters, digits, spaces "
                "and . + = - _ with a letter or digit first: files are called by it"
            )
        if self.given is None:
            object.__setattr__(self, "objectives", checked_objectives(self.objectives))

    @classmethod
    @takes(reference_front=Front)
    def of_function(
        cls, name: str, function: ProblemFunction | Any, *, reference_front: Front, **settings: Any
    ) -> NamedProblem:
        """The problem of a user's own function, for jobs.

        Parameters
        ----------
        name : str
            What it is called.
        function : callable
            As of a `GivenFunction`, with whose arguments as `settings`; or one of these.
        reference_front : Front
            What runs are measured against, as the front of a long search: there is no gradient that
            would find it.

        Raises
        ------
        ValueError
            When the reference front has fewer than two points, or is of another function.
        """
        from quietarm.metaheuristics.problems.given_function import GivenFunction

        is_problem = isinstance(function, ProblemFunction)
        given: Any = function if is_problem else GivenFunction(function, **settings)
        _refuse_other_reference(name, given, reference_front)
        return cls(
            name,
            given.task,
            given.profile,
            given.bound,
            objectives=given.objectives,
            reference_front=reference_front,
            given=given,
        )

    @property
    def is_move(self) -> bool:
        """Return whether it is a move of a plant, and no function of a user's own."""
        return self.given is None

    @property
    def box(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The least and the largest of each coefficient."""
        if self.given is not None:
            return self.given.lower, self.given.upper
        return self.profile.box(self.bound)

    @property
    def limited(self) -> bool:
        """Return whether candidates may break a limit or a constraint."""
        return bool(self.task.limits if self.given is None else self.given.constraints)

    @classmethod
    @takes(front=Front)
    def of_front(cls, name: str, front: Front) -> NamedProblem:
        """The problem that a front solves, which becomes its reference front.

        ValueError when the front states no bound, or has fewer than two points; NoTaskError of a
        front of a function, which does not have the function: `of_function` takes both.
        """
        if isinstance(front, FunctionFront):
            raise NoTaskError(
                f"{name} is a front of the function {clipped(front.function.name)}, and no file "
                f"has the function itself; {_IN_PYTHON}"
            )
        bound = front.record.bound or front.profile.default_bound
        if bound is None:
            raise ValueError(f"{name} states no bound; give a front that was found within one")
        if len(front.points) < 2:
            raise ValueError(f"{name} has {len(front.points)} points; give two or more")
        return cls(
            name,
            front.task,
            front.profile,
            bound,
            objectives=front.objectives,
            reference_front=front,
        )

    def __reduce__(self) -> Any:
        """Pickle by the name if that says everything."""
        if self.named:
            return problem_of, (self.name,)
        return type(self), tuple(vars(self).values())

    def function(self, **settings: Any) -> ProblemFunction:
        """The problem as a function of arrays; settings of `MoveFunction`: steps and threads."""
        if self.given is not None:
            return self.given
        return MoveFunction(
            self.task,
            self.profile,
            bound=self.bound,
            objectives=self.objectives,
            **settings,
        )

    def pymoo(self, **settings: Any) -> PymooProblem:
        """The problem for pymoo, with its reference front; settings as for `function`."""
        from quietarm.metaheuristics.problems.pymoo_problem import PymooProblem

        return PymooProblem(self.function(**settings), *self.optimum())

    def tasks(self) -> dict[str, PointToPoint]:
        """The tasks of the reference fronts by the names of their files.

        The problem's own; or the same under each limit of its peak.
        """
        if not self.peak_limits:
            return {self.name: self.task}
        (quantity,) = peak_quantities(self.objectives)
        limit = QUANTITIES[quantity].limit
        limits: Any = {most: {limit: most} for most in self.peak_limits}
        return {f"{self.name}-{most:g}": replace(self.task, **limits[most]) for most in limits}

    def fronts(self) -> tuple[Front, ...]:
        """The reference fronts: one, or those of residual and energy under each limit of a peak."""
        if self.reference_front is not None:
            return (self.reference_front,)
        if self.named:
            return tuple(_loaded(self._folder / f"{name}.json") for name in self.tasks())
        return (front_by_gradient(self.task, self.profile, self.bound, self.objectives),)

    def front(self) -> Front:
        """The reference front, of all objectives."""
        if self.peak_limits and self.named:
            return _of_all_limits(self, _loaded(self._folder / f"{self.name}.json"))
        return self.fronts()[0]

    def reference(self) -> Reference:
        """The reference front as a scale."""
        return _scale(self.front())

    @property
    def named(self) -> bool:
        """Return whether this is one of `PROBLEMS`."""
        return self.reference_front is None and PROBLEMS.get(self.name) == self

    def recorded(
        self, budget: float = inf, *, noise: float = 0.0, reevaluate: int = 1, seed: int = 0
    ) -> RecordedFunction:
        """The problem as a function of arrays that records its candidates, up to a budget.

        Arguments and errors as of a `RecordedFunction`.
        """
        from quietarm.metaheuristics.problems.recorded import RecordedFunction

        of_move: Any = {
            "profile": self.profile, "bound": self.bound, "objectives": self.objectives,
        }  # fmt: skip
        return RecordedFunction(
            self.task if self.given is None else self.given,
            **(of_move if self.given is None else {}),
            budget=budget,
            problem=self.name,
            noise=noise,
            reevaluate=reevaluate,
            seed=seed,
        )

    @property
    def _folder(self) -> Path:
        plant = FRONTS / self.task.plant.name
        return plant / self.name if self.peak_limits else plant

    def optimum(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Coefficients and objectives of the reference front.

        Returns
        -------
        pareto_set : ndarray, shape (points, variables)
            Coefficients; none of the motions dominates another.
        pareto_front : ndarray, shape (points, objectives)
            Residual [m], energy [J] and peaks.
        """
        front = self.front()
        return front.coefficients, front.objective_values


def _refuse_other_reference(name: str, function: ProblemFunction, front: Front) -> None:
    """Refuse a reference front that is no scale for a function."""
    if len(front.points) < 2:
        raise ValueError(
            f"the reference front of {name} has {len(front.points)} points; give that of "
            "a longer search, with two or more"
        )
    own = {"coefficients": len(function.variables), "objectives": function.objectives}
    its: dict[str, Any] = {
        "coefficients": front.coefficients.shape[1],
        "objectives": front.objectives,
    }
    if isinstance(front, FunctionFront):
        own |= {"units": function.units, "constraints": function.constraints}
        its |= {"units": front.function.units, "constraints": front.function.constraints}
    for entry, value in own.items():
        if its[entry] != value:
            raise ValueError(
                f"the reference front of {name} is of another function: its {entry} are "
                f"{_words(its[entry])}, not {_words(value)}; give a front of this function"
            )


def _words(value: object) -> str:
    return (", ".join(value) or "none") if isinstance(value, tuple) else str(value)


@cache
def _loaded(path: Path) -> Front:
    return Front.load(path)


@lru_cache(maxsize=8)
def _of_all_limits(problem: NamedProblem, surface: Front) -> Front:
    """A front by a grid of limits, with those that the fronts under limits of a peak have besides.

    Of the latter the peak is that at the nodes of 192 steps, as when they were found.
    """
    steps = 192
    (quantity,) = peak_quantities(problem.objectives)
    under_limits = problem.fronts()
    known = [point for front in under_limits for point in front.points]
    coefficients = np.vstack([front.coefficients for front in under_limits])
    peaks = problem.function(steps=steps)(coefficients)[0][:, 2].tolist()
    measured = [replace(point, peaks={quantity: peak}) for point, peak in zip(known, peaks)]
    points = non_dominated([*surface.points, *measured], problem.objectives)
    return replace(surface, points=points)


@lru_cache(maxsize=64)
def _scale(front: Front) -> Reference:
    from quietarm.metaheuristics.score import Reference

    return Reference(front)


@lru_cache(maxsize=64)
def front_by_gradient(
    task: PointToPoint,
    profile: JointProfile,
    bound: float,
    objectives: tuple[str, ...] = RESIDUAL_AND_ENERGY,
) -> Front:
    """A reference front by the gradient.

    Of two objectives, on six named problems within 1.4e-5 of the hypervolume.
    """
    return epsilon_front(
        task,
        profile,
        bound=bound,
        points=300,
        at=LEVELS,
        objectives=objectives,
        starts=12,  # of its ends
        steps=192 if task.limits else None,  # a peak between coarser ones costs up to 3e-4
    )


@interruptible
def problem_of(name: str) -> NamedProblem:
    """A named problem, or a drawn one of docs/results; ValueError suggests the nearest one."""
    if not isinstance(name, str):
        raise TypeError(why_no_problem("name", name))
    if name in PROBLEMS:
        return PROBLEMS[name]
    if name in drawn_moves():
        return _drawn_problem(name)
    raise ValueError(unknown("problem", name, [*PROBLEMS, *drawn_moves()]))


def why_no_problem(what: str, value: object) -> str:
    """Say what to do with a function, or a front, that is given where a problem is named."""
    if isinstance(value, NamedProblem):
        return f"{what} is a NamedProblem; take it as it is"
    if isinstance(value, FunctionFront):
        return f"{what} is a front of a function; {_IN_PYTHON}"
    if isinstance(value, Front):
        return f"{what} is a front; give NamedProblem.of_front('mine', front)"
    if callable(value):
        return f"{what} is a function; {_IN_PYTHON}, with the front of a long search of it"
    return f"{what} is {quoted(value)}; give a name of quietarm list problems, or a NamedProblem"


@interruptible
def drawn_problems() -> tuple[str, ...]:
    """Return the names of the problems of docs/results, which `problem_of` knows as well.

    Their reference fronts are found by the gradient when they are asked for.
    """
    return tuple(drawn_moves())


@cache
def _drawn_problem(name: str) -> NamedProblem:
    move = drawn_moves()[name]
    return NamedProblem(name, move.task, move.profile, move.bound, objectives=move.objectives)


def _task(plant: Plant, target: float, duration: float, start: float = 0.0) -> PointToPoint:
    """Make a task with the residual window of the paper and of the reference fronts."""
    return PointToPoint(plant, target, duration, start, residual_window=EQ_11)


def _problem(
    name: str, task: PointToPoint, bound: float, terms: int = 6, **options: Any
) -> NamedProblem:
    options = {"version": 2, **options}
    return NamedProblem(
        name,
        task,
        CycloidPolynomial(terms),
        bound,
        **options,
    )


def _named_problems() -> tuple[NamedProblem, ...]:
    """Six terms and no limits unless it is said; bounds of the paper, eqs (12) and (17)."""
    link = SingleLinkManipulator()
    arm = ArmOnFlexibleLink()
    dual_link = DualLinkManipulator()
    link_box = 0.2
    arm_box = 0.5
    robust_box = 0.5  # in the paper's every motion has more than 17 mm with 10 % of frequency
    link_sixth = _task(link, pi / 6, 0.8)
    arm_half = _task(arm, pi / 2, 0.8)
    return (
        _problem("single-link-30deg-0.8s", link_sixth, link_box),
        _problem("single-link-90deg-1s", _task(link, pi / 2, 1.0), link_box),
        _problem("single-link-90deg-1.1s", _task(link, pi / 2, 1.1), link_box),
        _problem("arm-on-flexible-link-90deg-0.8s", arm_half, arm_box),
        _problem(
            "arm-on-flexible-link-135deg-1s",
            _task(arm, pi / 4, 1.0, -pi / 2),
            arm_box,
        ),
        _problem(
            "arm-on-flexible-link-180deg-1.2s",
            _task(arm, pi / 2, 1.2, -pi / 2),
            arm_box,
        ),
        _problem("dual-link-90deg-0.9s", _task(dual_link, pi / 2, 0.9), arm_box),
        _problem("single-link-30deg-0.8s-2-terms", link_sixth, link_box, 2),
        _problem("single-link-30deg-0.8s-4-terms", link_sixth, link_box, 4),
        _problem("single-link-30deg-0.8s-10-terms", link_sixth, link_box, 10),
        _problem("single-link-30deg-0.8s-20-terms", link_sixth, link_box, 20),
        _problem("arm-on-flexible-link-90deg-0.8s-2-terms", arm_half, arm_box, 2),
        _problem("arm-on-flexible-link-90deg-0.8s-12-terms", arm_half, arm_box, 12),
        _problem(
            "single-link-30deg-0.8s-limits",
            replace(
                link_sixth,
                torque_limit=0.16,
                speed_limit=0.99,
                deflection_limit=0.03,
            ),
            link_box,
        ),
        _problem(
            "arm-on-flexible-link-90deg-0.8s-limits",
            replace(arm_half, torque_limit=0.3, acceleration_limit=75.0),
            arm_box,
        ),
        _problem(
            "single-link-30deg-0.8s-torque",
            link_sixth,
            link_box,
            objectives=(*RESIDUAL_AND_ENERGY, "peak_torque"),
            peak_limits=(0.1, 0.115, 0.13, 0.145, 0.16, 0.18),
            version=3,
        ),
        _problem(
            "single-link-30deg-0.8s-robust",
            replace(link_sixth, uncertainty=Uncertainty({"frequency": 0.1})),
            robust_box,
        ),
    )


PROBLEMS: Mapping[str, NamedProblem] = MappingProxyType(
    {problem.name: problem for problem in _named_problems()}
)
"""By name, of plant, angle and duration."""
