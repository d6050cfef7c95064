"""Words of the page on a motion: its figures, and what it trades."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isnan, nan
from typing import Self

import numpy as np

from quietarm.models import Plant
from quietarm.ocp import Plan, PointToPoint
from quietarm.ocp.figures import ENERGY, Figure, figures_in
from quietarm.ocp.joint_words import peaks_beyond
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import PAGE, QUANTITIES, RESIDUAL, Limit
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.rest import is_at_rest
from quietarm.views.page.page_moves import Choice, Move
from quietarm.views.pictures.meaning import is_plain_cycloid
from quietarm.views.pictures.motion import heading, names_of_curves, scale_of
from quietarm.views.report.report import percents
from quietarm.views.tips import tip_scale

_PREFIXES = {"nJ": 1e-9, "\u00b5J": 1e-6, "mJ": 1e-3, "J": 1.0}
"""Units of an energy, by which it has few zeros."""

_ALIKE = 0.005
"""Share by which two energies may differ and are the same to a reader."""


@dataclass(frozen=True)
class ShownFigures:
    """The figures of a motion in SI units, by name, in the order of `figure_names`.

    Of several joints `peak_joint` is the one with the largest torque; else it is empty.
    """

    values: Mapping[str, float]
    peak_joint: str = ""

    @classmethod
    def of(cls, plan: Plan, residual: float, energy: float) -> Self:
        """Return the figures of a motion, with residual and energy as its front states them."""
        values = {
            figure.name: plan.figures.get(figure.name, nan)
            for figure in figures_in(PAGE, plan.task)
        }
        joints = names_of_curves(plan.task.plant, "torque")
        peak_joint = ""
        if len(joints) > 1:
            torques = plan.candidate.peaks_of_joints(QUANTITIES["torque"])
            peak_joint = joints[int(torques.argmax())]
        return cls({**values, RESIDUAL: residual, ENERGY: energy}, peak_joint)

    def cells(self, task: PointToPoint) -> list[str]:
        """The figures as a table shows them."""
        cells = list[str]()
        for figure in figures_in(PAGE, task):
            value = self.values[figure.name]
            if figure.name == RESIDUAL and is_at_rest(value, task):
                cells.append("at rest" if task.final is None else "as asked")
            elif isnan(value):
                cells.append("-")
            else:
                factor = tip_scale(task.plant.tip_unit)[1] if figure.unit.is_tip_way else 1.0
                cells.append(f"{factor * value:.4g}")
        return cells

    def notes(self) -> list[str]:
        """Notes below each of the figures: the joint of the largest torque."""
        return [
            self.peak_joint if name == QUANTITIES["torque"].peak else "" for name in self.values
        ]


def figure_names(task: PointToPoint) -> list[str]:
    """Return the names of the figures, with their units."""
    return [_figure_name(figure, task.plant) for figure in figures_in(PAGE, task)]


def _figure_name(figure: Figure, plant: Plant) -> str:
    unit = figure.unit.on(plant.joint, plant.tip_unit)
    shown = tip_scale(plant.tip_unit)[0] if unit.is_tip_way else unit.drawn or "-"
    label = {RESIDUAL: "residual vibration", ENERGY: "energy"}.get(figure.name)
    if figure.quantity:
        label = f"peak {QUANTITIES[figure.quantity].label.of(plant.joint)}, moving"
    return f"{label or figure.label_on(plant)} [{shown}]"


def spot_words(choice: Choice) -> str:
    """Say where a motion lies: "14.7 mm, 0.0334 J"."""
    return f"{_residual(choice)}, {_joules(choice.energy)}"


def swing_words(choice: Choice) -> str:
    """Say what the tip does after arrival."""
    if choice.at_rest:
        return _residual(choice)
    task = choice.plan.task
    worst = " at worst" if task.ranges else ""
    if task.final is not None:
        return f"\u00b1{_residual(choice)} off what is asked{worst}"
    return f"swings \u00b1{_residual(choice)}{worst}"


def sentence(move: Move, choice: Choice) -> str:
    """Say what a motion trades: residual vibration for energy, beside the stillest of its front."""
    stillest = move.choices[0]
    if not move.is_front or choice is stillest:
        return _against_cycloid(move, choice) + _next_step(move, choice)
    worst = " in the worst case" if move.task.ranges else ""
    energy, of_stillest = _apart(choice.energy, stillest.energy)
    saved = percents([1 - choice.energy / stillest.energy])  # a front's energies fall
    at_rest = "arriving at rest" if move.task.final is None else "arriving as asked"
    if not stillest.at_rest:
        at_rest = f"the stillest motion, {_residual(stillest)},"
    return (
        f"{_residual(choice)} of residual vibration{worst} saves {saved} of the energy: {energy}, "
        f"where {at_rest} takes {of_stillest}.{_next_step(move, choice)}"
    )


def _residual(choice: Choice) -> str:
    task = choice.plan.task
    if choice.at_rest:
        return "at rest" if task.final is None else "as asked"
    unit, factor = tip_scale(task.plant.tip_unit)
    return f"{_digits(factor * choice.residual)} {unit}"


def _joules(energy: float, digits: int = 3) -> str:
    return f"{_digits(energy, digits)} J"


def _apart(first: float, second: float) -> tuple[str, str]:
    """Return two energies with as many digits as tell them apart, three at least."""
    least = 3
    most = 6
    for digits in range(least, most):
        if _joules(first, digits) != _joules(second, digits):
            return _joules(first, digits), _joules(second, digits)
    return _joules(first, least), _joules(second, least)


def _digits(value: float, digits: int = 3) -> str:
    """A number with three significant digits or more, zeros at the end among them."""
    written_out = 1e-4 <= value < 1e3  # beyond it with a power of ten
    return f"{value:#.{digits}g}".rstrip(".") if written_out else f"{value:.{digits}g}"


def _against_cycloid(move: Move, choice: Choice) -> str:
    """A motion beside the plain cycloid."""
    name = f"{choice.name}: the" if choice.name and len(move.choices) > 1 else "The"
    arrives = f"{name} tip {_arrival(choice)}"
    takes = _joules(choice.energy)
    if is_plain_cycloid(choice.plan):
        return f"{arrives} and takes {takes}; this is the plain cycloid itself."
    cycloid = Choice(move.cycloid, move.cycloid.residual, move.cycloid.energy)
    than = _compared(choice.energy, cycloid.energy)
    does = f"leaves it swinging by up to {_residual(cycloid)}"
    if move.task.final is not None:
        does = f"is off that by up to {_residual(cycloid)}"
    if cycloid.at_rest:
        does = f"arrives {_residual(cycloid)}, too"
    broken = _broken_by_cycloid(move, choice.plan.task)
    if not _buys_stillness(choice, cycloid):
        return f"{arrives} and takes {takes}, {than} the plain cycloid, which {does}.{broken}"
    bought = "a still arrival" if choice.at_rest else "a stiller arrival"
    return (
        f"{arrives}. That takes {takes}, {than} the plain cycloid, and buys {bought}: the cycloid "
        f"{does}.{broken}"
    )


def _broken_by_cycloid(move: Move, task: PointToPoint) -> str:
    """The limits of a task that the plain cycloid breaks, in a sentence."""
    cycloid = move.cycloid
    peaks = {limit: limit.peak_of(cycloid.motion) for limit in task.limits}
    words = [
        _beyond_of_joints(limit, cycloid.candidate) or _beyond(limit, peak, task.plant.tip_unit)
        for limit, peak in peaks.items()
        if not limit.keeps(peak, OVERRUN)
    ]
    return f" The cycloid would reach {' and '.join(words)}." if words else ""


def _beyond_of_joints(limit: Limit, cycloid: JudgedMotion) -> str:
    """Peaks of joints beyond their limits: "40.5 N m of torque at elbow_joint, beyond ..."."""
    return " and ".join(
        f"{_digits(peak.value)} {peak.bounds.unit} of {limit.label} at {peak.bounds.name}, beyond "
        f"the limit of {peak.bounds.text}"
        for peak in peaks_beyond(limit, cycloid, OVERRUN)
    )


def _beyond(limit: Limit, peak: float, tip_unit: str) -> str:
    """A peak beyond its limit: "0.363 N m of torque, beyond the limit of 0.15 N m"."""
    if not limit.is_peak:
        return f"{_digits(peak / limit.size)} times its {limit.label} limit"
    scale = scale_of(limit.name, tip_unit)
    unit = heading(limit.name, limit.quantity.joint, tip_unit).partition(" [")[2].removesuffix("]")
    return (
        f"{_digits(scale * peak)} {unit} of {limit.label}, beyond the limit of "
        f"{scale * limit.size:g} {unit}"
    )


def _buys_stillness(choice: Choice, cycloid: Choice) -> bool:
    """Return whether a motion takes more energy than the plain cycloid, but vibrates less."""
    takes_more = choice.energy > (1 + _ALIKE) * cycloid.energy
    return takes_more and choice.residual < cycloid.residual


def _arrival(choice: Choice) -> str:
    """Say what the tip does from the arrival on, as the second half of a sentence."""
    task = choice.plan.task
    if choice.at_rest:
        return f"arrives {_residual(choice)}"
    worst = " in the worst case" if task.ranges else ""
    if task.final is not None:
        return f"swings by up to {_residual(choice)} off what is asked after arrival{worst}"
    return f"swings by up to {_residual(choice)} after arrival{worst}"


def _compared(energy: float, of_cycloid: float) -> str:
    """An energy beside the plain cycloid's: "51 % less energy than"."""
    if abs(energy - of_cycloid) <= _ALIKE * abs(of_cycloid):
        return "as much energy as"
    if of_cycloid <= 0:
        return f"{_joules(energy - of_cycloid)} more energy than"
    share = energy / of_cycloid - 1
    return f"{percents([abs(share)])} {'less' if share < 0 else 'more'} energy than"


def _next_step(move: Move, choice: Choice) -> str:
    """Say what a little more residual vibration would save, by the shadow price.

    Nothing where the front ends before, and no more than the front's cheapest motion saves.
    """
    last = move.choices[-1]
    if not choice.price or choice.price < 0:
        return ""
    step = _step_of(move)
    if choice.residual + step > last.residual:
        return ""
    more = " more" if not choice.at_rest else " of residual vibration"
    saved = min(step * choice.price, choice.energy - last.energy)
    if saved <= 0:
        return ""
    return f" {_step_words(step, move.task)}{more} would save about {_about(saved)}."


def _step_of(move: Move) -> float:
    """A step of the residual [m]: the power of ten of a millimetre that is small in its front."""
    small = 0.2
    span = small * (move.choices[-1].residual - move.choices[0].residual)
    if span <= 0:
        return float("inf")
    return float(10.0 ** np.floor(np.log10(span) + 1e-9))


def _step_words(step: float, task: PointToPoint) -> str:
    unit, factor = tip_scale(task.plant.tip_unit)
    words = {1.0: "One millimetre", 10.0: "Ten millimetres", 0.1: "A tenth of a millimetre"}
    shown = float(f"{factor * step:.3g}")
    return words[shown] if unit == "mm" and shown in words else f"{shown:g} {unit}"


def _about(energy: float) -> str:
    """An energy [J] with two digits, in the largest unit in which it is 0.1 at least."""
    fitting = [unit for unit, size in _PREFIXES.items() if energy >= 0.0999 * size]
    unit = fitting[-1] if fitting else "nJ"
    return f"{float(f'{energy / _PREFIXES[unit]:.2g}'):g} {unit}"


def robust_note(task: PointToPoint) -> str:
    """Say what the residual of an uncertain task is; nothing of others."""
    if not task.ranges:
        return ""
    scenarios = len(task.scenarios)
    return (
        f"The residual is the worst of {scenarios} plants within the errors; the motion shown is "
        "the nominal plant's."
    )
