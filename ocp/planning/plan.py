"""Plan: the coefficients of a motion, its figures and where they come from."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from quietarm.interrupts import interruptible
from quietarm.models import JointMotion
from quietarm.ocp.checks import IF_STATED, CountFromOne, NotNegative, count_of, takes
from quietarm.ocp.errors import InfeasibleTaskError, SolveStatus
from quietarm.ocp.figures import ENERGY, figures_in
from quietarm.ocp.files import write_whole
from quietarm.ocp.joint_words import figure_words, passed_words
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import NOTEBOOK, RESIDUAL, Limit
from quietarm.ocp.motion_answer import MotionAnswer
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.cycle import Cycle, Shuttle
from quietarm.ocp.planning.executed import MoveHistory
from quietarm.ocp.planning.move_table import USUAL_RATE, move_csv, ticks_of_move
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointPath, JointProfile
from quietarm.ocp.record import Record, Setting, Verification
from quietarm.ocp.rest import is_at_rest, rest_of, still_of
from quietarm.ocp.robustness import Sensitivity, peaks_between, sensitivities
from quietarm.ocp.saved import to_html
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.simulation.trajectory import Trajectory
from quietarm.ocp.solvers.problem import MOST_SOLVER_STEPS
from quietarm.ocp.task import PointToPoint

STATED_CYCLE = "stated_cycle"
"""Entry of a file: the figures of a plan's cycles."""


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
    shuttle : Shuttle or None
        The cycles that the plan is reported for, there and back; None where none were asked for.
    learned : MoveHistory or None
        The executed moves that it was learned from by `quietarm.learn`; None of any other plan.
    """

    example: ClassVar[str] = "a plan, such as Plan.load('plan.json')"
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
    shuttle: Shuttle | None = field(default=None, metadata=IF_STATED)
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
    def peaks(self) -> tuple[JudgedMotion, ...]:
        """The motion where its residual peaks within the ranges of its task; the worst first."""
        return tuple(peaks_between(self.candidate))

    @property
    def worst(self) -> JudgedMotion | None:
        """The motion in the worst case of an uncertain task; None if the task is certain.

        Its `errors` are those within the ranges with the largest residual, also between the
        scenarios.
        """
        return self.peaks[0] if self.peaks else None

    @property
    def acts_after(self) -> float:
        """Time from the command's start until the tip stays within the task's band [s].

        In the worst case of the task's errors. It may be before the motion's end, or after it;
        infinite where the tip never stays within the band, no number where the task has none.
        """
        return self.candidate.acts_after

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
        """Verify the plan by so many steps."""
        evaluator = self.candidate.by_steps(steps, quantities=())
        evaluation = evaluator([self.coefficients])
        energy = float(evaluation.energy[0, 0])
        residual = float(evaluation.residual.max())
        return Verification.between(steps, energy, residual, self.figures, rest_of(self.task))

    def on(self, task: PointToPoint) -> Plan:
        """Return this motion for an uncertain task with the same nominal plant."""
        return replace(self, task=task)

    @property
    def path(self) -> JointPath:
        """The joint's motion as a callable of time and derivative order."""
        return self.profile.path(self.coefficients, *self.task.move)

    @cached_property
    def sensitivities(self) -> tuple[Sensitivity, ...]:
        """Sensitivities of energy and arrival to each parameter of the plant; see `Sensitivity`."""
        return sensitivities(self.candidate)

    @property
    def turns_back(self) -> float:
        """Largest way that the joint moves backwards [rad], on either side of the target."""
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

    @cached_property
    def cycles(self) -> Cycle | None:
        """Cycles of its `shuttle`, with what they take and leave; None where it has none."""
        return None if self.shuttle is None else Cycle(self.candidate, self.shuttle)

    def _content(self) -> dict[str, Any]:
        stated = {} if self.cycles is None else {STATED_CYCLE: self.cycles.stated}
        return super()._content() | stated

    @classmethod
    def _entries_of(cls, content: Mapping[str, Any]) -> dict[str, Any]:
        entries = super()._entries_of(content)
        return {name: entry for name, entry in entries.items() if name != STATED_CYCLE}

    def cycle(
        self, dwell: float = 0.0, repeat: int = 1, errors: Mapping[str, float] | None = None
    ) -> Cycle:
        """Return what cycles of this move there and back take and leave.

        Parameters
        ----------
        dwell : float
            Time between arrival and the next start [s].
        repeat : int
            How many cycles.
        errors : mapping of str to float, optional
            Relative errors of the plant's parameters, for what is left.
        """
        return Cycle(self.candidate, Shuttle(dwell, repeat), {} if errors is None else errors)

    def commanded(self, sample_rate: float = 1000.0) -> Trajectory:
        """Return the motion that a controller is given, rows at a rate [Hz].

        Its joints are the set points of the plant's drive, where it has one whose loops are known:
        the load then follows the planned path, which `sample.path` has. All else is as planned. The
        last row is the first tick at or after arrival, or at which the servo has settled.
        """
        ticks = ticks_of_move(self.task.duration, sample_rate)
        if not self.candidate.inverts_drive:
            return self.sampled(np.arange(ticks + 1) / sample_rate)
        points = self.candidate.set_points(sample_rate)
        planned = self.sampled(points.time)
        (joint,) = planned.sample.joints
        asked = JointMotion(points.place, points.speed, points.acceleration, joint.jerk)
        return Trajectory(planned.time, planned.sample._replace(joints=[asked]))

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        task = self.task
        motion = self.motion
        residual = "at rest"
        if not is_at_rest(motion.residual, task):
            residual = f"{motion.residual:.3g} {task.plant.tip_unit}"
        prices = [f"{name}: {price:.4g}" for name, price in self.shadow_prices.items()]
        peaks = {
            figure.label_on(task.plant): figure_words(self.candidate, figure, drawn=True)
            for figure in figures_in(NOTEBOOK, task)
            if figure.name not in (RESIDUAL, ENERGY) and figure.name in self.figures
        }
        rows = {
            "plant": task.plant.name,
            "move": f"{task.ends} in {task.duration:g} s",
            "energy": f"{motion.energy:.5g} J",
            f"residual vibration within {task.residual_window:.4g} s": residual,
            **self._robust_rows(),
            "limits": ", ".join(map(str, task.limits)) or "-",
            **peaks,
            "shadow prices [J per SI unit of the limit]": ", ".join(prices) or "-",
            "coefficients": ", ".join(f"{a:.4g}" for a in self.coefficients) or "-",
            "status": self.status.text,
        }
        return to_html(rows.items())

    def _robust_rows(self) -> dict[str, str]:
        """Return the rows of parameter errors in a notebook: their ranges, and the worst case."""
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
    def save_csv(self, path: str | Path, sample_rate: float = USUAL_RATE) -> None:
        """Write the move as a table to drive a joint with, so many rows a second [Hz].

        Its heading names the quantities with their units: time, and of every joint angle, speed,
        acceleration and torque, the tips, the power. `quietarm.views.export_plan` takes columns and
        units. The last row is the first tick at or after arrival. ValueError when the rate is out
        of range or the file cannot be written.
        """
        write_whole(path, move_csv(self, rate=sample_rate))


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
        broken.append(f"its {limit.label} is {passed_words(limit, plan.candidate, OVERRUN)}")
    if broken:
        raise InfeasibleTaskError(
            f"the {profile.label} has one motion for this move, and {'; '.join(broken)}: "
            "widen what is broken, or give a longer duration or another profile"
        )
    return plan.with_entries(residual_limit=residual_limit)
