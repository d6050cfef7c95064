"""Sentences and rows of what executed moves taught: a sentence first, then what it rests on."""

from __future__ import annotations

from math import pi

from quietarm.machine.identify.identified import is_frequency
from quietarm.machine.learn import Learning
from quietarm.models import Plant
from quietarm.ocp import Plan
from quietarm.views.report.acting_words import acting_words, arrival_words
from quietarm.views.report.words import counted
from quietarm.views.tips import tip_words

Row = tuple[str, str]


def learning_sentence(learned: Learning) -> str:
    """Say what was left, what of it changes, what the next move leaves, and what always stays."""
    plant = learned.plan.task.plant
    left = with_unit(learned.left, plant)
    floor = with_unit(learned.floor, plant)
    whose = _of_floor(learned)
    if learned.is_done and learned.allowed > 0 and learned.left > learned.floor:
        beside = f" beside a floor {whose} of {floor}" if learned.left > learned.allowed else ""
        return (
            f"Nothing more to learn: the move leaves what the plan allows "
            f"({with_unit(learned.allowed, plant)}){beside}: {left}; the next move is this one. "
            "For less, plan with a smaller --residual-limit."
        )
    if learned.is_done and learned.left <= learned.floor:
        return (
            f"Nothing more to learn: the move left {left}, within the floor {whose}, {floor}; the "
            "next move is this one."
        )
    if learned.is_done:
        return (
            f"The move left {left}, of which nothing is sure enough to correct, beside a floor "
            f"{whose} of {floor}; the next move is this one: record it several times."
        )
    least = with_unit(learned.next_at_most, plant)
    return f"The move left {left}; the next move leaves at most {least}."


def _acting(learned: Learning) -> list[Row]:
    """Say when the tool may act, by what the next move leaves; nothing without a band."""
    task = learned.plan.task
    if task.band is None:
        return []
    least = with_unit(learned.next_at_most, task.plant)
    band = tip_words(task.band, "m")
    if learned.next_at_most > task.band:
        return [("tool", f"not sure to stay within {band}: the next move may leave {least}")]
    history = learned.plan.learned
    wanted = None if history is None else history.wanted
    motion = learned.plan.candidate
    # a state on arrival that makes up for the machine is what the model does, and not the machine
    words = acting_words(motion) if task.final == wanted else arrival_words(motion)
    return [("tool", words)]


def _of_floor(learned: Learning) -> str:
    """Say whereby a floor stays, which no plan takes away."""
    if learned.plan.task.plant.has_path:
        return "by noise and moves that differ"
    if learned.by_joint:
        return "by friction, noise and what a torque does not tell"
    return "by friction and noise"


def _shares(learned: Learning) -> list[Row]:
    """Return of what the swing is made, and what stays; nothing if there is nothing to correct."""
    if learned.is_done:
        return []
    plant = learned.plan.task.plant
    rows = [("floor", f"{with_unit(learned.floor, plant)}, {_of_floor(learned)}")]
    if changed := _changed(learned):
        by_frequency = f"{with_unit(learned.by_frequency, plant)}: {changed}"
        rows = [
            ("by frequency", by_frequency),
            ("repeatable", with_unit(learned.repeatable, plant)),
            *rows,
        ]
    return rows


def learning_rows(plan: Plan, learned: Learning) -> list[Row]:
    """Return what the sentence rests on: starts, intervals, scatter, the next plan beside this."""
    plant = plan.task.plant
    moves = learned.plan.learned.moves if learned.plan.learned else ()
    recordings = sum(len(move.measured) for move in moves)
    rows = [
        *_acting(learned),
        *_shares(learned),
        ("learned from", f"{counted(len(moves), 'move')}, {counted(recordings, 'recording')}"),
        *(
            (name, f"starts at {round(time, 4) + 0.0:.4f} s of the recording")
            for name, time in learned.start.items()
        ),
    ]
    when = "during the moves" if learned.by_joint else "after the moves"
    for name, (model, measured) in learned.modes.items():
        rows.append((name, f"{measured:.4g} Hz after the moves, model {model:.4g} Hz"))
    for estimate in learned.estimates:
        size, unit = (2 * pi, " Hz") if is_frequency(plant, estimate.parameter) else (1.0, "")
        low, high = estimate.low / size, estimate.high / size
        rows.append(
            (
                estimate.parameter,
                f"{estimate.value / size:.5g}{unit} {when}, within {low:.5g} to {high:.5g}{unit} "
                "(95 %)",
            )
        )
    for inertia in learned.inertias:
        words = (
            f"{inertia.value:.3g} times the plan's, within {inertia.low:.3g} to {inertia.high:.3g}"
        )
        rows.append((inertia.parameter, f"{words} (95 %, by the torque)"))
    if learned.scatter is not None:
        rows.append(("scatter", f"{with_unit(learned.scatter, plant)} from move to move"))
    if not learned.is_done:
        more = 100 * (learned.plan.energy / plan.energy - 1)
        rows.append(("step", f"{learned.step:.0%} of the correction"))
        rows.append(("energy", f"{learned.plan.energy:.4g} J ({more:+.1f} %)"))
    return rows


def _changed(learned: Learning) -> str:
    """The frequencies that are changed, in words; empty where none is."""
    plant = learned.plan.task.plant
    words = [
        f"{new / (2 * pi):.4g} Hz during the move, model {model / (2 * pi):.4g} Hz"
        for name, (model, new) in learned.changed.items()
        if is_frequency(plant, name)
    ]
    if plant.has_path:
        modes = [f"{new:.4g} Hz, model {model:.4g} Hz" for model, new in learned.modes.values()]
        words += [
            f"springs {new / model:.4g} times as stiff, {', '.join(modes)}"
            for model, new in learned.changed.values()
        ]
    return "; ".join(words)


def _number(length: float, plant: Plant) -> str:
    """A displacement of the tip in mm, of one that turns in degrees: two digits."""
    least = 1e-4
    value = 1e3 * length if plant.tip_unit == "m" else 180 / pi * length
    if 0 < value < least:
        return f"below {least}"
    return f"{value:.3g}" if value >= 1 else f"{value:.2g}"


def with_unit(length: float, plant: Plant) -> str:
    """A displacement of the tip with its unit."""
    return f"{_number(length, plant)} {'mm' if plant.tip_unit == 'm' else 'deg'}"
