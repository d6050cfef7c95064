"""Plan: the coefficients of a motion, its figures and where they come from."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from quietarm.interrupts import interruptible
from quietarm.models.dimensions import ACCELERATION, ANGLE, EFFORT, SPEED, TORQUE, WAY, Words
from quietarm.ocp.checks import IF_STATED, CountFromOne, NotNegative, count_of, positive, takes
from quietarm.ocp.errors import InfeasibleTaskError, SolveStatus
from quietarm.ocp.escapes import csv_table
from quietarm.ocp.figures import ENERGY, figures_in
from quietarm.ocp.files import write_whole
from quietarm.ocp.joint_words import figure_words, joint_headings
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import NOTEBOOK, RESIDUAL, Limit
from quietarm.ocp.motion_answer import MotionAnswer
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.executed import MoveHistory
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointPath, JointProfile
from quietarm.ocp.record import REST, Record, Setting, Verification
from quietarm.ocp.robustness import Sensitivity, Worst, peaks_between, sensitivities
from quietarm.ocp.saved import to_html
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.simulation.trajectory import Trajectory
from quietarm.ocp.solvers.problem import MOST_SOLVER_STEPS, still_of
from quietarm.ocp.task import PointToPoint

_MOST_ROWS = 500_000
"""Of a table to drive a joint with."""


@dataclass(frozen=True)
class Plan(MotionAnswer):
    """One motion of one task: its coefficients and how they were found.

    What it costs and leaves is computed by CVODES when it is first asked for: `energy`, `residual`,
    all of its `motion`, the `worst` case, and the `verification` by fixed steps.

    Attributes
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    coefficients : tuple of float
        The profile's coefficients, a_1 to a_N of eq (6).
    status : SolveStatus
        How the solve ended.
    record : Record
        Method, settings, versions, time.
    steps : int
        Fixed steps that the solver took, by which `verification` compares.
    residual_limit : float or None
        Largest residual that was asked for [m]; None where none was.
    shadow_prices : mapping of str to float
        Decrease of the least energy per unit of a widened limit [J by the limit's unit]: sums of
        multipliers, by the limit's name. Of the residual also if rest on arrival was required;
        empty if nothing was optimised.
    learned : MoveHistory or None
        The executed moves that it was learned from by `quietarm.learn`; None of any other plan.
    """

    example: ClassVar[str] = "a plan, as Plan.load('plan.json')"
    kind: ClassVar[str] = "plan"
    version: ClassVar[int] = 5
    read_by_2_0 = (4,)

    task: PointToPoint
    profile: JointProfile
    coefficients: tuple[float, ...]
    status: SolveStatus
    record: Record
    steps: CountFromOne
    residual_limit: NotNegative | None = None
    shadow_prices: Mapping[str, float] = field(default_factory=dict, hash=False)
    learned: MoveHistory | None = field(default=None, metadata=IF_STATED)

    def __post_init__(self) -> None:
        prices = {name: float(price) for name, price in sorted(self.shadow_prices.items())}
        object.__setattr__(self, "shadow_prices", prices)
        object.__setattr__(self, "coefficients", self.profile.checked(self.coefficients))

    @classmethod
    @takes(candidate=JudgedMotion)
    def of_candidate(cls, candidate: JudgedMotion, **entries: Any) -> Plan:
        """The plan of a motion along a profile, which is not evaluated again; other entries."""
        if candidate.profile is None:
            raise ValueError("a free motion has no profile; give a motion along one")
        plan = cls(
            task=candidate.task,
            profile=candidate.profile,
            coefficients=candidate.coefficients,
            **entries,
        )
        return plan.with_candidate(candidate)

    @cached_property
    def candidate(self) -> JudgedMotion:
        """The motion, evaluated by CVODES."""
        return JudgedMotion.of_profile(self.task, self.profile, self.coefficients)

    @cached_property
    def peaks(self) -> tuple[Worst, ...]:
        """Peaks of the residual within the ranges of an uncertain task; the worst first."""
        return tuple(peaks_between(self.candidate))

    @property
    def worst(self) -> Worst | None:
        """The worst case of an uncertain task; None if the task is certain.

        These are the errors within its ranges with the largest residual, also between the
        scenarios.
        """
        return self.peaks[0] if self.peaks else None

    @property
    def excess(self) -> float | None:
        """Relative excess of `worst` over the residual limit, negative if the limit is kept.

        None if the task is not uncertain, or no limit was asked for.
        """
        if self.worst is None or not self.residual_limit:
            return None
        return self.worst.residual / self.residual_limit - 1

    @cached_property
    def verification(self) -> Verification:
        """Distance of its figures by fixed steps from those by CVODES.

        The steps are doubled, at most three times, while they do not agree with CVODES.
        """
        check = self._verify_by(self.steps)
        for doublings in (1, 2, 3):
            steps = 2**doublings * self.steps
            if check.agrees or steps > MOST_SOLVER_STEPS:
                break
            check = self._verify_by(steps)
        return check

    def _verify_by(self, steps: int) -> Verification:
        """The same by so many steps."""
        evaluator = self.candidate.by_steps(steps, quantities=())
        evaluation = evaluator([self.coefficients])
        energy = float(evaluation.energy[0, 0])
        residual = float(evaluation.residual.max())
        return Verification.between(steps, energy, residual, self.motion)

    def on(self, task: PointToPoint) -> Plan:
        """The same motion for an uncertain task with the same nominal plant."""
        return replace(self, task=task)

    @property
    def path(self) -> JointPath:
        """The joint's motion as a callable of time and derivative order."""
        return self.profile.path(self.coefficients, *self.task.move)

    @cached_property
    def sensitivities(self) -> tuple[Sensitivity, ...]:
        """What energy and arrival change with each parameter of the plant; see `Sensitivity`."""
        return sensitivities(self.candidate)

    @property
    def turns_back(self) -> float:
        """How far the joint moves backwards [rad], on either side of the target."""
        times = np.linspace(0.0, self.task.duration, 2001)
        forward = np.sign(self.task.span) * self.path(times)
        return float((np.maximum.accumulate(forward) - forward).max())

    @cached_property
    def trajectory(self) -> Trajectory:
        """The move and the residual window after it, by CVODES; `sampled` gives any times."""
        arrival = self.task.duration
        end = arrival + self.task.residual_window
        times = np.linspace(0.0, end, 1500)
        return self.sampled(np.union1d(times, [arrival]))

    def sampled(self, times: ArrayLike) -> Trajectory:
        """The motion at given times by CVODES; see `JudgedMotion.sample`."""
        return self.candidate.sample(times)

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        task = self.task
        motion = self.motion
        residual = "at rest"
        if motion.residual > REST * task.smallness:
            residual = f"{motion.residual:.3g} {task.plant.tip_unit}"
        prices = [f"{name}: {price:.4g}" for name, price in self.shadow_prices.items()]
        peaks = {
            figure.label_on(task.plant): figure_words(self.candidate, figure, drawn=True)
            for figure in figures_in(NOTEBOOK)
            if figure.name not in (RESIDUAL, ENERGY) and figure.name in self.figures
        }
        rows = {
            "plant": task.plant.name,
            "move": f"{task.ends} in {task.duration:g} s",
            "energy F2": f"{motion.energy:.5g} J",
            f"residual vibration F1 within {task.residual_window:.4g} s": residual,
            **self._robust_rows(),
            "limits": ", ".join(map(str, task.limits)) or "-",
            **peaks,
            "shadow prices [J per SI unit of the limit]": ", ".join(prices) or "-",
            "coefficients": ", ".join(f"{a:.4g}" for a in self.coefficients) or "-",
            "status": self.status.text,
        }
        return to_html(rows.items())

    def _robust_rows(self) -> dict[str, str]:
        """What a notebook shows of parameter errors: their ranges, and the worst case."""
        rows = dict[str, str]()
        unit = self.task.plant.tip_unit
        if ranges := self.task.ranges:
            words = (f"{name} +-{100 * size:.3g} %" for name, size in ranges.items())
            rows["parameter errors"] = ", ".join(words)
        if self.worst is not None:
            errors = (f"{name} {100 * size:+.3g} %" for name, size in self.worst.errors.items())
            rows["worst-case residual"] = (
                f"{self.worst.residual:.3g} {unit} with {', '.join(errors)}"
            )
        if self.residual_limit:
            rows["residual limit"] = f"{self.residual_limit:.3g} {unit}"
        return rows

    @interruptible
    def save_csv(self, path: str | Path, sample_rate: float = 1000.0) -> None:
        """Write the move as a table to drive a joint with, so many rows a second [Hz].

        Its header names the quantities with their units. The last row is the first tick at or after
        arrival. ValueError when the rate is out of range or the file cannot be written.
        """
        ticks = ticks_of_move(self.task.duration, sample_rate)
        sampled = self.sampled(np.arange(ticks + 1) / sample_rate)
        plant = self.task.plant
        tip_names = [f"{name}_{plant.tip_unit}" for name in plant.tip_names]
        orders = (ANGLE, WAY), (Words("speed"), SPEED), (Words("acceleration"), ACCELERATION)
        header = ["time_s", *joint_headings(plant, *orders), *tip_names]
        header += [*joint_headings(plant, (TORQUE, EFFORT)), "power_W"]
        sample = sampled.sample
        moving = [value for joint in sample.joints for value in joint[:3]]
        table = np.column_stack(
            [sampled.time, *moving, sampled.tips, *sample.torques, sampled.power]
        )
        write_whole(path, csv_table(dict(zip(header, table.T)), "%.10g"))


@takes(task=PointToPoint, profile=JointProfile)
def evaluate_coefficients(
    task: PointToPoint,
    coefficients: ArrayLike,
    *,
    profile: JointProfile | None = None,
    method: str = "given coefficients",
    settings: Mapping[str, Setting] | None = None,
) -> Plan:
    """Evaluate one motion of a profile: a plan whose status says that nothing was optimised.

    Parameters
    ----------
    task : PointToPoint
        The move.
    coefficients : array_like, shape (profile.size,)
        The profile's coefficients; none for the plain cycloid.
    profile : JointProfile, optional
        How the joint moves; by default a `CycloidPolynomial` of as many terms, eq (6).
    method, settings
        Where the coefficients come from, for the plan's record.

    Raises
    ------
    ValueError, SolverFailedError
        When coefficients or duration do not fit the profile; when CVODES fails.
    """
    began = time.perf_counter()
    if profile is None:
        profile = CycloidPolynomial.of_size(count_of("coefficients", coefficients))
    candidate = JudgedMotion.of_profile(task, profile, coefficients)
    plan = Plan.of_candidate(
        candidate,
        status=SolveStatus.NOT_OPTIMISED,
        record=Record(method, {} if settings is None else settings),
        steps=default_steps(task),
    )
    _ = plan.energy, plan.residual, plan.worst  # a motion that fails does so here
    return plan.restated(seconds=time.perf_counter() - began)


def only_motion(
    task: PointToPoint, profile: JointProfile, residual_limit: float | None = None
) -> Plan:
    """The figures of the only motion that a profile has, within the task's limits."""
    plan = evaluate_coefficients(task, [], profile=profile, method="evaluated")
    limits = {limit.name: limit for limit in task.limits}
    if residual_limit is not None:
        residual = Limit.of_residual(max(residual_limit, still_of(task)), task.plant.tip_unit)
        limits = {residual.name: residual} | limits
    broken = list[str]()
    for name in plan.motion.exceeded(limits.values(), OVERRUN):
        limit = limits[name]
        peak = limit.describe(limit.peak_of(plan.motion))
        broken.append(f"its {limit.label} reaches {peak}, above {limit.bounds}")
    if broken:
        raise InfeasibleTaskError(
            f"the {profile.label} has one motion for this move, and {'; '.join(broken)}: "
            "widen what is broken, or give a longer duration or another profile"
        )
    return plan.with_entries(residual_limit=residual_limit)


def ticks_of_move(duration: float, sample_rate: float) -> int:
    """Ticks from the start to the first at or after arrival."""
    ticks = duration * positive("sample rate", sample_rate, "Hz")
    if ticks < 1e-4:
        raise ValueError(
            f"sample rate is {sample_rate:g} Hz, a tick long after the arrival; give a higher rate"
        )
    if ticks > _MOST_ROWS:
        raise ValueError(
            f"sample rate {sample_rate:g} Hz asks for {ticks:.0f} rows, of at most "
            f"{_MOST_ROWS}; give at most {_MOST_ROWS / duration:.6g} Hz"
        )
    return max(1, math.ceil(ticks - 1e-9))
