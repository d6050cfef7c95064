"""What the page says of a motion: its figures, and what it trades."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from quietarm.models.joint_motion import joint_label, joint_unit
from quietarm.ocp import Plan, PointToPoint
from quietarm.ocp.record import REST
from quietarm.studies.export.tradeoff.moves import Choice, Move
from quietarm.studies.report.report import percents
from quietarm.studies.tips import tip_scale


@dataclass(frozen=True)
class Figures:
    """The figures of a motion in SI units, in the order of `figure_names`."""

    residual: float
    energy: float
    peak_torque: float
    peak_power: float
    peak_tip: float

    @classmethod
    def of(cls, plan: Plan, residual: float, energy: float) -> Self:
        """Those of a motion, F1 and F2 as its front states them."""
        motion = plan.motion
        peak_power = float(np.abs(plan.trajectory.power).max())
        return cls(residual, energy, motion.peak_torque, peak_power, motion.peak_deflection)

    def cells(self, task: PointToPoint) -> list[str]:
        """The figures as a table shows them."""
        factor = tip_scale(task.plant.tip_unit)[1]
        residual = "at rest" if self.residual < REST else f"{factor * self.residual:.4g}"
        others = self.energy, self.peak_torque, self.peak_power, factor * self.peak_tip
        return [residual, *(f"{value:.4g}" for value in others)]


def figure_names(task: PointToPoint) -> list[str]:
    """What the figures are, with their units."""
    plant = task.plant
    unit = tip_scale(plant.tip_unit)[0]
    torque = joint_label("joint torque", plant.joint)
    return [
        f"residual vibration F1 [{unit}]",
        "energy F2 [J]",
        f"peak {torque} [{joint_unit('N m', plant.joint)}]",
        "peak power [W]",
        f"peak tip displacement, moving [{unit}]",
    ]


def spot_words(choice: Choice) -> str:
    """Where a motion lies: "14.7 mm, 0.0334 J"."""
    return f"{_residual(choice)}, {_joules(choice)}"


def swing_words(residual: float, tip_unit: str) -> str:
    """What the tip does after arrival."""
    if residual < REST:
        return "at rest"
    return f"swings \u00b1{_tip(residual, tip_unit)}"


def sentence(move: Move, choice: Choice) -> str:
    """What a motion trades: residual vibration for energy, beside the stillest of its front."""
    stillest = move.choices[0]
    if not move.is_front or choice is stillest:
        return _against_cycloid(move, choice) + _next_step(move, choice)
    saved = 1 - choice.energy / stillest.energy
    at_rest = "arriving at rest"
    if stillest.residual >= REST:
        at_rest = f"the stillest motion, {_residual(stillest)},"
    return (
        f"{_residual(choice)} of residual vibration saves {percents([saved])} of the energy: "
        f"{_joules(choice)}, where {at_rest} takes {_joules(stillest)}."
        f"{_next_step(move, choice)}"
    )


def _residual(choice: Choice) -> str:
    if choice.residual < REST:
        return "at rest"
    return _tip(choice.residual, choice.plan.task.plant.tip_unit)


def _tip(displacement: float, tip_unit: str) -> str:
    unit, factor = tip_scale(tip_unit)
    return f"{_three_digits(factor * displacement)} {unit}"


def _joules(choice: Choice) -> str:
    return f"{_three_digits(choice.energy)} J"


def _three_digits(value: float) -> str:
    """A number with three significant digits, zeros at the end among them."""
    written_out = 1e-4 <= value < 1e3  # beyond it with a power of ten
    return f"{value:#.3g}".rstrip(".") if written_out else f"{value:.3g}"


def _against_cycloid(move: Move, choice: Choice) -> str:
    """A motion beside the plain cycloid."""
    tip_unit = move.task.plant.tip_unit
    name = f"{choice.name}: the" if choice.name and len(move.choices) > 1 else "The"
    arrives = f"tip swings by up to {_residual(choice)} after arrival"
    if choice.residual < REST:
        arrives = "tip arrives at rest"
    share = choice.energy / move.cycloid.energy - 1
    than = f"{percents([abs(share)])} {'less' if share < 0 else 'more'} than"
    if abs(share) < 0.005:
        than = "as much as"
    cycloid = "arrives at rest, too"
    if move.cycloid.residual >= REST:
        left = _tip(move.cycloid.residual, tip_unit)
        cycloid = f"leaves it swinging by up to {left}"
    return f"{name} {arrives} for {_joules(choice)}, {than} the plain cycloid, which {cycloid}."


def _next_step(move: Move, choice: Choice) -> str:
    """What a little more residual vibration would save, by the shadow price."""
    last = move.choices[-1]
    if not choice.price or choice.price < 0 or choice is last:
        return ""
    step, step_words = _step_of(move)
    more = " more" if choice.residual >= REST else " of residual vibration"
    return f" {step_words}{more} would save about {_about(step * choice.price)}."


def _step_of(move: Move) -> tuple[float, str]:
    """A step of the residual that is small beside the front's, and its words."""
    if move.task.plant.tip_unit != "m":
        return 0.01, "0.01 rad"
    some_millimetres = 5e-3
    if move.choices[-1].residual < some_millimetres:
        return 1e-4, "A tenth of a millimetre"
    return 1e-3, "One millimetre"


def _about(energy: float) -> str:
    """An energy [J] with two digits."""
    millijoules = 1e3 * energy
    return f"{millijoules:.2g} mJ" if millijoules < 100 else f"{energy:.2g} J"


def robust_note(task: PointToPoint) -> str:
    """What F1 is of an uncertain task; nothing of others."""
    if not task.ranges:
        return ""
    scenarios = len(task.scenarios)
    return (
        f"F1 is the worst of {scenarios} plants within the errors; the motion shown is the nominal "
        "plant's."
    )
