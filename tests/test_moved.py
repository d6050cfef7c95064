"""Names that have moved say where they are."""

import importlib

import pytest

import quietarm as qa
from quietarm.moved import ROOMS, MovedRooms


def test_a_name_that_has_moved_says_where_it_is():
    with pytest.raises(ImportError, match=r"quietarm\.figures has moved to quietarm\.pictures"):
        qa.figures.draw_fronts([])


def test_a_class_that_has_another_name_says_it():
    with pytest.raises(ImportError, match=r"ocp\.Motion has moved to .*ocp\.Figures"):
        _ = qa.ocp.Motion


@pytest.mark.parametrize(
    ("package", "name", "now"),
    [
        ("models", "joint_unit", "models.dimensions.WAY.of"),
        ("ocp", "Motion", "ocp.Figures"),
        ("pictures", "QUANTITIES_DRAWN", "pictures.drawn_quantities"),
        ("studies", "export", "views"),
        ("ocp", "Candidate", "ocp.JudgedMotion"),
        ("ocp", "Worst", "ocp.JudgedMotion"),
        ("compare", "JudgedMotion", "compare.ComparedMotion"),
        ("studies", "identify", "machine.identify"),
    ],
)
def test_so_does_a_name_of_a_package(package, name, now):
    with pytest.raises(ImportError, match=rf"{name} has moved to quietarm\.(views\.)?{now}"):
        getattr(getattr(qa, package), name)


def test_an_import_by_name_says_it_as_well():
    with pytest.raises(ImportError, match=r"Motion has moved to quietarm\.ocp\.Figures"):
        from quietarm.ocp import Motion  # noqa: F401  # pyright: ignore


@pytest.mark.parametrize(
    ("room", "now"),
    [
        ("studies.identify", "machine.identify"),
        ("studies.figures.motion", "views.pictures"),
        ("studies.export", "views"),
        ("metaheuristics.gradient", "metaheuristics.methods.gradient_methods"),
        ("models.checks", "models.number_checks"),
    ],
)
def test_a_room_that_has_moved_says_where_it_is(room, now):
    with pytest.raises(ImportError, match=rf"has moved to quietarm\.{now}$"):
        importlib.import_module(f"quietarm.{room}")
    importlib.import_module(f"quietarm.{now}")


def test_every_place_that_is_named_is_there():
    for room, now in ROOMS.items():
        importlib.import_module(f"quietarm.{now}")
        with pytest.raises(ImportError, match=rf"{room} has moved to quietarm\.{now}$"):
            MovedRooms.find_spec(f"quietarm.{room}")
