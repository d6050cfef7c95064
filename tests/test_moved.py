"""Names that have moved say where they are."""

import importlib

import pytest

import quietarm as qa


def test_a_name_that_has_moved_says_where_it_is():
    with pytest.raises(AttributeError, match=r"quietarm\.figures has moved to quietarm\.pictures"):
        qa.figures.draw_fronts([])


@pytest.mark.parametrize(
    ("package", "name", "now"),
    [
        ("models", "joint_unit", "models.Unit"),
        ("ocp", "Motion", "ocp.Figures"),
        ("pictures", "QUANTITIES_DRAWN", "pictures.drawn_quantities"),
    ],
)
def test_so_does_a_name_of_a_package(package, name, now):
    with pytest.raises(AttributeError, match=rf"{name} has moved to quietarm\.(views\.)?{now}$"):
        getattr(getattr(qa, package), name)


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
