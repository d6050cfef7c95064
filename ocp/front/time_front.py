"""The front of time and energy: when the tool may act, and what each duration takes.

Its ends are the fastest move and the slowest that is asked for; between them are moves of least
energy in durations at even shares. All of them keep the task's limits and its band.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.interrupts import interruptible
from quietarm.ocp.checks import NotNegative, Positive, positive, takes, whole
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.escapes import csv_table
from quietarm.ocp.files import write_whole
from quietarm.ocp.planning.fastest import fastest_move
from quietarm.ocp.planning.plan import Plan, evaluate_coefficients
from quietarm.ocp.planning.plan_move import plan_move
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Record
from quietarm.ocp.saved import Answer
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.told_progress import Progress, no_report

TIME_AND_ENERGY = ("time", "energy")
"""The objectives of such a front."""
LONGEST = 1.5
"""Times the fastest move's duration that the slowest one takes where no duration is given."""


@dataclass(frozen=True)
class TimedPoint:
    """A move of least energy in its duration.

    Attributes
    ----------
    duration : float
        Of the motion [s].
    acts_after : float
        When the tool may act in the worst case [s].
    energy : float
        Energy [J].
    coefficients : tuple of float
        The profile's.
    """

    duration: Positive
    acts_after: NotNegative
    energy: NotNegative
    coefficients: tuple[float, ...]


@dataclass(frozen=True)
class TimeFront(Answer):
    """Moves of one task in several durations: the longer, the less energy.

    Attributes
    ----------
    task : PointToPoint
        The move, in the shortest duration.
    profile : JointProfile
        How the joint moves in all of them.
    points : tuple of TimedPoint
        By when they act.
    record : Record
        Method, settings, versions, time.
    failures : tuple of str
        Durations in which no plan was found, and why.
    """

    example: ClassVar[str] = "a front of time and energy, such as TimeFront.load('time.json')"
    kind: ClassVar[str] = "time-front"
    version: ClassVar[int] = 1

    task: PointToPoint
    profile: JointProfile
    points: tuple[TimedPoint, ...]
    record: Record
    failures: tuple[str, ...] = ()

    @property
    def times(self) -> NDArray[np.float64]:
        """Times when each point acts [s]."""
        return np.array([point.acts_after for point in self.points])

    @property
    def energies(self) -> NDArray[np.float64]:
        """Energy of every point [J]."""
        return np.array([point.energy for point in self.points])

    @property
    def prices(self) -> NDArray[np.float64]:
        """Prices of acting a second earlier than each next point [J/s], one less than points.

        A thousandth of a price is the energy in joules for a millisecond.
        """
        return -np.diff(self.energies) / np.diff(self.times)

    def duration_at(self, price: float) -> float | None:
        """Return the duration at which a second is worth so many joules [s]; None beyond the ends.

        In longer moves a second costs less than the price, in shorter ones more.
        """
        durations = np.array([point.duration for point in self.points])
        middles = (durations[1:] + durations[:-1]) / 2
        prices = self.prices
        if len(prices) < 2 or not prices.min() <= price <= prices.max():
            return None
        dear = np.flatnonzero(prices >= price)
        last = int(dear[-1])
        if last + 1 == len(prices):
            return float(middles[last])
        around = slice(last, last + 2)
        return float(np.interp(-price, -prices[around], middles[around]))

    def plan_of(self, point: TimedPoint) -> Plan:
        """Return the motion of a point as a plan, evaluated by CVODES."""
        task = replace(self.task, duration=point.duration)
        return evaluate_coefficients(
            task, point.coefficients, profile=self.profile, method=self.record.method
        )

    def columns(self) -> dict[str, NDArray[np.float64]]:
        """``duration_s``, ``acts_after_s``, ``energy_J``, ``a_1``, ... of all points, by name."""
        table = np.array([point.coefficients for point in self.points])
        return {
            "duration_s": np.array([point.duration for point in self.points]),
            "acts_after_s": self.times,
            "energy_J": self.energies,
            **{f"a_{i}": column for i, column in enumerate(table.T, start=1)},
        }

    @interruptible
    def save_csv(self, path: str | Path) -> None:
        """Write the `columns` as a table, with every digit."""
        write_whole(path, csv_table(self.columns(), "%.17g"))


@takes(task=PointToPoint, solver=Solver)
def time_front(
    task: PointToPoint,
    *,
    longest: float | None = None,
    points: int = 9,
    residual_limit: float | None = None,
    bound: float | None = None,
    seed: int = 0,
    solver: Solver = Sqp(),
    report: Progress = no_report,
    keep: Callable[[TimeFront], None] | None = None,
) -> TimeFront:
    """Find the front of the time to act and the energy of a task with a band.

    Parameters
    ----------
    task : PointToPoint
        The move with its limits, one at least, and its band.
    longest : float, optional
        The longest duration [s]; one and a half times the fastest move's by default.
    points : int
        Number of durations, both ends included.
    residual_limit, bound, seed, solver
        As for `fastest_move`.
    report : callable, optional
        Called with the number of points done and of all.
    keep : callable, optional
        Called after each duration, the fastest move's first, with the front until then: whoever is
        stopped has it.

    Returns
    -------
    TimeFront
        Method ``"durations"``. A duration whose plan takes more energy than that of a shorter one
        has no point; one in which none was found is among the failures.

    Raises
    ------
    ValueError
        When the task has no band, nothing limits it, or the longest duration is shorter than the
        fastest move's.
    InfeasibleTaskError, SolverFailedError
        When no fastest move is found.
    """
    if task.band is None:
        raise ValueError(
            "the time of a front is until the tip stays within a band, and the task has none; give "
            "one, such as --band 0.1mm or band=1e-4"
        )
    points = whole("points", points, 2, 1000)
    began = time.perf_counter()
    settings: dict[str, Any] = {
        "residual_limit": residual_limit,
        "bound": bound,
        "seed": seed,
        "solver": solver,
    }
    fastest = fastest_move(task, **settings).plan
    shortest = fastest.task.duration
    longest = LONGEST * shortest if longest is None else positive("longest duration", longest, "s")
    if longest <= shortest:
        raise ValueError(
            f"the longest duration is {longest:g} s, and the fastest move takes {shortest:.4g} s; "
            "give a longer one"
        )
    timed = [_point_of(fastest)]
    failures = list[str]()
    guess = fastest.coefficients
    report(1, points)

    def front_until_now() -> TimeFront:
        record = replace(
            fastest.record,
            method="durations",
            settings={"points": points, "longest": longest, **solver.stated},
            seconds=time.perf_counter() - began,
        )
        falling = _falling(timed)
        grown = TimeFront(fastest.task, fastest.profile, falling, record, tuple(failures))
        if keep is not None:
            keep(grown)
        return grown

    solution = front_until_now()
    for number, duration in enumerate(np.linspace(shortest, longest, points)[1:].tolist(), 2):
        try:
            plan = plan_move(
                replace(fastest.task, duration=duration),
                fastest.profile,
                guess=guess,
                starts=1,
                **settings,
            )
        except (InfeasibleTaskError, SolverFailedError) as error:
            failures.append(f"{duration:.4g} s: {error}")
        else:
            guess = plan.coefficients
            timed.append(_point_of(plan))
        report(number, points)
        solution = front_until_now()
    return solution


def _point_of(plan: Plan) -> TimedPoint:
    return TimedPoint(plan.task.duration, plan.acts_after, plan.energy, plan.coefficients)


def _falling(points: list[TimedPoint]) -> tuple[TimedPoint, ...]:
    """The points that no other one beats in both time and energy."""
    kept = list[TimedPoint]()
    for point in sorted(points, key=lambda point: (point.acts_after, point.energy)):
        if not kept or point.energy < kept[-1].energy:
            kept.append(point)
    return tuple(kept)
