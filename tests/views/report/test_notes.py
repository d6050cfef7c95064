"""Notes of any plant stand beside the figures that they touch."""

from dataclasses import dataclass
from typing import ClassVar

import quietarm as qa
from quietarm.models import SingleLinkManipulator
from quietarm.models.notes import Note
from quietarm.views.report.plan_rows import plan_rows
from quietarm.views.report.words import note_lines

LOAD = Note("the load is a guess", ("energy", "torque"))
GRIP = Note("the gripper was not weighed")


def test_notes_of_a_plant_stand_beside_what_they_touch():
    @dataclass(frozen=True)
    class Guessed(SingleLinkManipulator):
        """A link of whose load little is known."""

        name: ClassVar[str] = "guessed"
        notes: ClassVar[tuple[Note, ...]] = (LOAD, GRIP)

    task = qa.PointToPoint(Guessed(), target=0.5, duration=0.8)
    rows = plan_rows(qa.evaluate_coefficients(task, [0.0]))
    warned = [name for name, words in rows if "(warning: the load is a guess)" in words]
    assert warned == ["energy", "peak torque"]
    assert ("warning", "the gripper was not weighed") in rows
    assert note_lines(task.plant) == [
        "warning: the load is a guess",
        "warning: the gripper was not weighed",
    ]
    assert note_lines(SingleLinkManipulator()) == []
