"""What quantities of the joints are called, each in the words and the unit of its joint's kind."""

from __future__ import annotations

from quietarm.models import Plant
from quietarm.models.joint_motion import MIXED, joint_label, joint_unit
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.limits import quantities_of, units_of_joints


def heading_unit(unit: str) -> str:
    """Return a unit as it stands in the heading of a column: rad_s2, Nm."""
    return unit.replace("/", "_").replace("^", "").replace(" ", "")


def joint_headings(plant: Plant, *columns: tuple[str, str]) -> list[str]:
    """Return the headings of columns of a plant's joints, those of a joint beside each other.

    Columns are given as of a rotary joint, such as ("angle", "rad"); of one that slides the heading
    is position_m. Several joints have their names in front: elbow_angle_rad.
    """
    names = plant.joint_names
    fronts = [f"{name}_" for name in names] if len(names) > 1 else [""]
    return [
        f"{front}{joint_label(word, kind)}_{heading_unit(joint_unit(unit, kind))}"
        for front, kind in zip(fronts, plant.joint_kinds)
        for word, unit in columns
    ]


def peak_words(candidate: Candidate, name: str) -> str:
    """Return the peak of a quantity in its unit; of joints of both kinds the peak of each kind."""
    plant = candidate.task.plant
    quantity = quantities_of(plant.joint, plant.tip_unit)[name]
    if plant.joint != MIXED or not quantity.of_joints:
        return f"{candidate.motion.peak(name):.4g} {quantity.unit}"
    peaks = zip(candidate.peaks_of_joints(quantity).tolist(), units_of_joints(name, plant).items())
    largest = dict[str, tuple[float, str]]()
    for peak, (joint, unit) in peaks:
        largest[unit] = max(largest.get(unit, (0.0, joint)), (peak, joint))
    return " and ".join(f"{peak:.4g} {unit} ({joint})" for unit, (peak, joint) in largest.items())
