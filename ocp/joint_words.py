"""What quantities of the joints are called, each in the words and the unit of its joint's kind."""

from __future__ import annotations

from quietarm.models import Plant
from quietarm.models.dimensions import Unit, Words
from quietarm.models.joint_motion import MIXED
from quietarm.ocp.figures import Figure, further_figures
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import QUANTITIES


def heading_unit(unit: str) -> str:
    """Return a unit as it stands in the heading of a column: rad_s2, Nm."""
    return unit.replace("/", "_").replace("^", "").replace(" ", "")


def joint_headings(plant: Plant, *columns: tuple[Words, Unit]) -> list[str]:
    """Return the headings of columns of a plant's joints, those of a joint beside each other.

    Columns such as (ANGLE, WAY): angle_rad, of one that slides position_m. Several joints have
    their names in front: elbow_angle_rad.
    """
    names = plant.joint_names
    fronts = [f"{name}_" for name in names] if len(names) > 1 else [""]
    return [
        f"{front}{word.of(kind)}_{heading_unit(unit.of(kind))}"
        for front, kind in zip(fronts, plant.joint_kinds)
        for word, unit in columns
    ]


def further_words(candidate: JudgedMotion, place: str) -> list[str]:
    """Figures of one's own that stand in a place, in words: "RMS torque 0.09 N m"."""
    return [
        f"{figure.label_on(candidate.task.plant)} {figure_words(candidate, figure)}"
        for figure in further_figures(place, candidate.task)
        if figure.name in candidate.figures
    ]


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
