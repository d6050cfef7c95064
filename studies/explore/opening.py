"""What the page begins with: a plant, or what a file of a plan, a front or a sweep holds."""

from __future__ import annotations

import json
from contextlib import suppress
from math import pi
from pathlib import Path

from quietarm.models import Plant, known_plants
from quietarm.models.joint_motion import LINEAR, ROTARY
from quietarm.ocp import CycloidPolynomial, PointToPoint, evaluate_coefficients
from quietarm.ocp.files import read_bytes
from quietarm.studies.explore.move import Explored
from quietarm.studies.reading.saved import load_front, load_plans
from quietarm.studies.report.words import plant_words
from quietarm.studies.sweep.library import MoveLibrary

_TARGETS, _DURATION = {ROTARY: pi / 6, LINEAR: 0.3}, 0.8
"""The paper's first move, and 300 mm of a linear axis."""


def open_plant(plant: Plant) -> Explored:
    """The plain cycloid of a plant, with the coefficients of six terms to be set."""
    task, profile = PointToPoint(plant, _TARGETS[plant.joint], _DURATION), CycloidPolynomial()
    return Explored(evaluate_coefficients(task, profile.plain, profile=profile))


def open_file(path: Path) -> Explored:
    """What a file or a folder holds; FileFormatError where that is none of these."""
    if path.is_dir() or path.suffix == ".zarr":
        library = MoveLibrary(path)
        middle = {axis.name: axis.values[len(axis.values) // 2] for axis in library.grid.axes}
        return Explored(library.plan(**middle), library=library)
    if _format_of(path) == "quietarm-front":
        front = load_front(path)
        first = evaluate_coefficients(
            front.task,
            front.points[0].coefficients,
            profile=front.profile,
            method=front.record.method,
        )
        return Explored(first, bound=front.record.bound, front=front)
    (plan,) = load_plans([path]).values()
    return Explored(plan, residual_limit=plan.residual_limit or None, bound=plan.record.bound)


def is_file(what: str) -> bool:
    """Whether this names a file or a folder of answers, and no plant."""
    path = Path(what)
    machine = path.suffix == ".json" and _format_of(path) == "quietarm-machine"
    return path.suffix in (".json", ".zarr") and not machine


def _format_of(path: Path) -> object:
    """The format that a file states; None where it is no JSON, for its reader to refuse."""
    with suppress(ValueError, AttributeError):
        return json.loads(read_bytes(path)).get("format")
    return None


def menu(plant: Plant) -> dict[str, Plant]:
    """A plant, and those of its kind of joint that have a value for every parameter, by words."""
    plants = {plant_words(plant): plant}
    for kind in known_plants().values():
        with suppress(TypeError):  # a parameter without a value
            other = kind()
            if other.joint == plant.joint:
                plants.setdefault(plant_words(other), other)
    return plants
