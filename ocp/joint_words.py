"""Names of quantities of the joints, each in the words and the unit of its joint's kind."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.models.joint_motion import MIXED
from quietarm.ocp.figures import Figure, further_figures
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import QUANTITIES


def heading_unit(unit: str) -> str:
    """Return a unit as it stands in the heading of a column: rad_s2, Nm."""
    return unit.replace("/", "_").replace("^", "").replace(" ", "")


def further_words(candidate: JudgedMotion, place: str) -> list[str]:
    """Figures of one's own that stand in a place, in words: "RMS torque 0.09 N m"."""
    return [
        f"{figure.label_on(candidate.task.plant)} {figure_words(candidate, figure)}"
        for figure in further_figures(place, candidate.task)
        if figure.name in candidate.figures
    ]


def spans_in_words(candidates: Sequence[JudgedMotion], place: str) -> list[str]:
    """Return the range over several motions of each further figure: "RMS torque 0.05 to 0.09 N m".

    A figure that one of the motions lacks is left out.
    """
    words = list[str]()
    for figure in further_figures(place, candidates[0].task) if candidates else []:
        known = [motion for motion in candidates if figure.name in motion.figures]
        if known and len(known) == len(candidates):
            by_size = sorted(known, key=lambda motion: motion.figures[figure.name])
            first = figure_words(by_size[0], figure)
            last = figure_words(by_size[-1], figure)
            plant = known[0].task.plant
            unit = f" {figure.unit_on(plant)}"
            low = first.removesuffix(unit) if last.endswith(unit) else first
            span = last if first == last else f"{low} to {last}"
            words.append(f"{figure.label_on(plant)} {span}")
    return words


def figure_words(candidate: JudgedMotion, figure: Figure, drawn: bool = False) -> str:
    """Return a figure in its unit; a peak of joints of both kinds is that of each kind.

    As it is `drawn` powers of units are raised.
    """
    plant = candidate.task.plant
    quantity = QUANTITIES.get(figure.quantity)
    if quantity is None or plant.joint != MIXED or not quantity.of_joints:
        return figure.words(candidate.figures[figure.name], plant, drawn)
    peaks = candidate.peaks_of_joints(quantity).tolist()
    largest = dict[str, tuple[float, str]]()
    for peak, joint, kind in zip(peaks, plant.joint_names, plant.joint_kinds):
        own = figure.unit.on(kind, plant.tip_unit)
        unit = own.drawn if drawn else str(own)
        largest[unit] = max(largest.get(unit, (0.0, joint)), (peak, joint))
    return " and ".join(
        f"{peak:.{figure.digits}g} {unit} ({joint})" for unit, (peak, joint) in largest.items()
    )
