"""A robot that was identified from ring-downs, on the screen."""

from __future__ import annotations

from quietarm.machine.held_robots.identify_robot import HeldMode, IdentifiedRobot
from quietarm.machine.held_robots.robot_lines import measured_lines
from quietarm.machine.identify import Estimate
from quietarm.models.robot.robot_notes import notes_of_fit
from quietarm.ocp.checks import joined
from quietarm.views.report.robot_rows import WARNING
from quietarm.views.report.words import counted

Row = tuple[str, str]


def robot_answer(found: IdentifiedRobot) -> str:
    """Return the answer in a sentence: how a robot swings, and what springs and load that tells."""
    slowest = min(mode.mode for mode in found.modes)
    first = [mode for mode in found.modes if mode.mode == slowest]
    hertz = joined(f"{mode.frequency.value:.4g} Hz (+-{_half(mode.frequency)})" for mode in first)
    damping = joined(f"{100 * mode.damping.value:.2g} %" for mode in first)
    which = "" if slowest == 1 else f" in mode {slowest}"
    springs = f"its springs are {found.stiffness.value:.4g} times as stiff as in its file"
    load = "the load is not told"
    if found.payload is not None:
        load = f"the load is {found.payload.value:.4g} kg (+-{_half(found.payload)})"
    begin = "The robot"
    if found.unfit:
        begin = (
            "The torques at rest do not fit the posture (check --posture, or are they external "
            "torques?). If it is right, the robot"
        )
    return (
        f"{begin} swings at {hertz}{which}, with a damping of {damping}: {springs} "
        f"(+-{_half(found.stiffness)}), and {load}."
    )


def identified_robot_rows(found: IdentifiedRobot) -> list[Row]:
    """The multiples with their intervals, then every mode at every posture."""
    rows = [("stiffness", f"{_with_interval(found.stiffness)} times that of the robot's file")]
    if found.unfit:
        rows.append((WARNING, f"{_UNFIT}: they differ by {100 * found.unfit:.2g} %"))
    rows += [(WARNING, note.words) for note in notes_of_fit(found.robot.fit)]
    if found.payload is None:
        stated = f"{found.robot.payload:.4g} kg, as in the file: " if found.robot.payload else ""
        rows.append(("load", f"{stated}{found.payload_by}"))
    else:
        rows.append(("load", f"{_with_interval(found.payload)} kg, {found.payload_by}"))
    if any(one.damping is not None for one in found.robot.measurements):
        rows.append(("dampers", f"{found.damping:.3g} times those of the robot's file"))
    names = dict[tuple[float, ...], str]()
    for mode in found.modes:
        posture = ", ".join(f"{place:.4g}" for place in mode.posture)
        names.setdefault(mode.posture, f"at {posture}")
        rows.append((names[mode.posture], _mode_words(mode)))
    return rows


def robot_notes(found: IdentifiedRobot) -> list[str]:
    """Return how ring-downs were read, and the lines for the robot's file."""
    lines = measured_lines(found.robot.measurements)
    notes = [*found.notes]
    if found.payload is not None:
        notes.append(f"for the robot's file, in its beam: tip_mass: {found.payload.value:.4g}")
    doubt = f"; {_UNFIT}, check it first" if found.unfit else ""
    return [*notes, f"for the robot's file{doubt}:", *lines]


_UNFIT = "the torques at rest are not those that hold this robot at this posture"


def _mode_words(mode: HeldMode) -> str:
    frequency, damping = mode.frequency, mode.damping
    return (
        f"mode {mode.mode} {_with_interval(frequency)} Hz, damping "
        f"{100 * damping.value:.3g} % ({100 * damping.low:.3g} to {100 * damping.high:.3g} %), "
        f"misfit {100 * mode.misfit:+.2g} %, by {counted(len(mode.recordings), 'recording')}"
    )


def _with_interval(estimate: Estimate) -> str:
    return f"{estimate.value:.5g} ({estimate.low:.5g} to {estimate.high:.5g})"


def _half(estimate: Estimate) -> str:
    """Half the width of an interval, as a share."""
    return f"{50 * (estimate.high - estimate.low) / estimate.value:.2g} %"
