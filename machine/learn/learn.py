"""`learn`: from a plan and recordings of its executed move to the next plan, which leaves less.

First the model: frequency and damping, where recordings of the swing differ from it clearly. Then
the arrival state: what the machine leaves of a move is compared with what the corrected model says
of its set points, over all moves that the plan was learned from (`arrival_map`), and the next plan
is told to arrive in the state that makes up for the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from quietarm.machine.identify.identified import is_frequency
from quietarm.machine.learn.evidence import Evidence, evidence_of, motion_of
from quietarm.machine.learn.learning import Learning
from quietarm.machine.learn.next_plan import plan_again
from quietarm.machine.learn.reading.find_start import find_start, off_the_path, refuse_exchanged
from quietarm.machine.learn.reading.read_force import read_torque, swing_by_joint
from quietarm.machine.learn.reading.read_move import ReadMove, is_by_joint
from quietarm.machine.learn.reading.read_payload import read_payload
from quietarm.machine.learn.reading.read_swing import AfterMove, check_length, read_swing
from quietarm.machine.learn.refusals.check_clock import check_clock
from quietarm.machine.learn.refusals.check_columns import check_columns, refuse_constant
from quietarm.machine.learn.refusals.check_move import check_move
from quietarm.machine.learn.refusals.check_size import check_size
from quietarm.machine.learn.robots.robot_evidence import refuse_delay, robot_evidence
from quietarm.machine.learn.tip_modes import TipModes
from quietarm.machine.recordings.mending import without_glitches
from quietarm.machine.recordings.recording import Recording, checked_recordings
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.ocp.checks import positive, takes
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.uncertainty import with_values


@takes(plan=Plan, solver=Solver)
def learn(
    plan: Plan,
    recordings: Sequence[Recording | RobotRecording],
    *,
    dearer: float = 0.02,
    solver: Solver = Sqp(),
    delay: float | None = None,
) -> Learning:
    """Learn from recordings of a plan's executed move, and plan the next one.

    Each recording is one execution of the plan, from its start until two periods after arrival or
    longer: of a tip or an accelerometer, or of the joint's angle and its torque. The start is found
    in it. What earlier plans left stands in the plan, if `learn` made it.

    Parameters
    ----------
    plan : Plan
        The plan that was executed.
    recordings : sequence of Recording
        Of its execution, one or several; `RobotRecording` of a robot along a path.
    dearer : float
        Share by which the next plan may take more energy than this one.
    solver : Solver
        As for `plan_move`.
    delay : float, optional
        Of a robot: by how much its torques were recorded late [s], as by an estimator's filter.

    Returns
    -------
    Learning
        What was left, what changes, and the next plan.

    Raises
    ------
    ValueError
        When a recording is too short, of another move or by another clock; when the plan has
        nothing that could change.
    SolverFailedError
        When no motion within the limits makes up for what was left.
    """
    dearer = positive("dearer", dearer)
    check_plan(plan)
    if plan.task.plant.has_path:
        evidence, read, notes = robot_evidence(plan, recordings, delay)
        inertias = ()
    else:
        refuse_delay(delay)
        evidence, read, notes = _evidence(plan, recordings)
        executed = motion_of(evidence.history.moves[-1], plan.task, evidence.told_plant)
        inertias = read_payload(executed, read, plan.task.duration)
    history = evidence.history
    step = evidence.step
    told = evidence.told_next(step)
    again = plan.with_entries(learned=history)
    if step:
        task = replace(plan.task, plant=evidence.plant, final=evidence.modes.state(told))
        again, share, before = plan_again(plan, task, dearer, solver)
        if again.energy > (1 + dearer) * plan.energy:
            notes.append(
                f"the next plan takes {_change(plan.energy, again.energy)} of energy: this move on "
                f"the machine as it was learned takes {_change(plan.energy, before)}, and the "
                f"correction {_change(before, again.energy)} of that, which alone --dearer limits"
            )
        again = again.with_entries(learned=history)
        told = evidence.modes.amplitudes(again.candidate.arrival[0])  # with what the plan misses
        if share < 1:
            step *= share
            notes.append(
                f"only {share:.0%} of the correction is made, as all of it takes more energy than "
                f"{100 * dearer:g} %; allow more by --dearer"
            )
    notes += [note for one in read for note in (one.doubt, *one.after.notes) if note]
    return Learning(
        plan=again,
        left=evidence.left,
        by_frequency=evidence.by_frequency,
        repeatable=evidence.repeatable,
        scatter=evidence.scatter,
        floor=evidence.floor + evidence.beyond,
        next_at_most=evidence.at_most(told),
        changed=evidence.changed,
        estimates=evidence.estimates,
        start={one.recording.name: one.start for one in read},
        step=step,
        machine=evidence.machine(),
        by_joint=evidence.by_joint,
        notes=(*notes, *evidence.doubts),
        allowed=evidence.allowed if evidence.is_as_allowed else 0.0,
        modes=evidence.frequencies,
        inertias=inertias,
    )


def _change(before: float, after: float) -> str:
    """Say by how much an energy changes."""
    return f"{100 * (after / before - 1):+.2g} %"


def _evidence(
    plan: Plan, recordings: Sequence[Recording | RobotRecording]
) -> tuple[Evidence, list[ReadMove], list[str]]:
    """Return what moves of a plan of one joint tell, how they were read, and what was mended."""
    recordings, notes = without_glitches(checked_recordings(recordings))
    read = [read_move(plan, recording) for recording in recordings]
    evidence = evidence_of(plan, read)
    if any(one.by_joint for one in read):  # once more, by the frequency that all moves tell
        read = [one.on(evidence.told_plant, plan.task.target) for one in read]
        evidence = evidence_of(plan, read)
    return evidence, read, notes


def check_plan(plan: Plan) -> None:
    """Refuse a plan of which nothing could be learned."""
    plant = plan.task.plant
    if plan.profile.size == 0:
        raise ValueError(
            f"the plan's profile, {plan.profile.label}, has one motion alone, and nothing to "
            "change; learn from a plan of quietarm plan"
        )
    if plant.has_path:
        return  # its springs are scaled, whatever they are
    if not any(is_frequency(plant, name) for name in plant.measured):
        raise ValueError(
            f"{plant.name} has no parameter that is the frequency of a mode, which recordings "
            "tell; declare it by qa.parameter(..., kind='frequency')"
        )


def read_move(plan: Plan, recording: Recording) -> ReadMove:
    """The start of a plan's move in a recording, and the swing after it."""
    task = plan.task
    refuse_constant(
        recording.name,
        {
            "tip": recording.tip,
            "accelerometer": recording.acceleration,
            "joint": recording.angle,
            "torque": recording.torque,
        },
    )
    fastest = float(TipModes(task.plant, task.target).frequencies[-1])
    check_clock(recording.name, recording.time, task.duration, fastest)
    found = find_start(plan, recording)
    doubt = off_the_path(plan, recording, found)
    start = found.time
    arrival = start + task.duration
    check_length(recording, arrival, task.plant, task.target)
    check_columns(plan, recording, arrival)
    if doubt:
        refuse_exchanged(plan, recording, found)
    note = "" if found.signal == "tip" else check_size(plan, recording, found)
    if not is_by_joint(recording):
        after = read_swing(recording, arrival, task.plant, task.target)
        better = check_move(plan, recording, found, after.measured.values)
        if abs(better - start) * fastest > 1 / 360:
            start, arrival = better, better + task.duration
            check_length(recording, arrival, task.plant, task.target)
            after = read_swing(recording, arrival, task.plant, task.target)
        return ReadMove(recording, start, arrival, _with(after, note), doubt)
    if recording.angle is None:
        raise ValueError(
            f"{recording.name}: a torque alone does not tell how the tip swings; name the column "
            "of the joint by --angle, or that of a tip by --tip"
        )
    check_move(plan, recording, found, {})
    part = read_torque(recording, start, arrival, task.plant)
    plant = with_values(task.plant, part.values)
    after = swing_by_joint(recording, part, arrival, plant, task.target)
    return ReadMove(recording, start, arrival, _with(after, note), doubt)


def _with(after: AfterMove, note: str) -> AfterMove:
    """Return what was read after a move with one more note, if there is one."""
    return replace(after, notes=(*after.notes, note)) if note else after
