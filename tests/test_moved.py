"""Names that have moved say where they are."""

import importlib

import pytest

import quietarm as qa


def test_a_name_that_has_moved_says_where_it_is():
    with pytest.raises(AttributeError, match=r"quietarm\.figures has moved to quietarm\.pictures"):
        qa.figures.draw_fronts([])


def test_a_class_that_has_another_name_says_it():
    with pytest.raises(AttributeError, match=r"ocp\.Figures has moved to .*ocp\.PlantFigures"):
        _ = qa.ocp.Figures


@pytest.mark.parametrize(
    ("room", "now"),
    [
        ("studies.identify", "machine.identify"),
        ("studies.figures.motion", "views.pictures"),
        ("studies.export", "views"),
    ],
)
def test_a_room_that_has_moved_says_where_it_is(room, now):
    with pytest.raises(ImportError, match=rf"has moved to quietarm\.{now}$"):
        importlib.import_module(f"quietarm.{room}")
    importlib.import_module(f"quietarm.{now}")
