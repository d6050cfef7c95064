"""What the page begins with: a plant, or what a file of a plan, a front or a sweep holds."""

from __future__ import annotations

from contextlib import suppress
from math import pi
from pathlib import Path

from quietarm.models import Plant, known_plants
from quietarm.models.joint_motion import LINEAR, ROTARY
from quietarm.ocp import CycloidPolynomial, Front, PointToPoint, evaluate_coefficients
from quietarm.ocp.objectives import refuse_peaks
from quietarm.studies.answers.read_answers import format_of, load_front, load_plans
from quietarm.studies.explore.move import Explored
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.views.report.words import plant_words


def open_plant(plant: Plant) -> Explored:
    """The plain cycloid of a plant, with the coefficients of six terms to be set."""
    # the paper's first move, and 300 mm of a linear axis
    targets = {ROTARY: pi / 6, LINEAR: 0.3}
    duration = 0.8
    task = PointToPoint(plant, targets[plant.joint], duration)
    profile = CycloidPolynomial()
    return Explored(evaluate_coefficients(task, profile.plain, profile=profile))


def open_file(path: Path) -> Explored:
    """What a file or a folder holds; FileFormatError where that is none of these."""
    if path.is_dir() or path.suffix == ".zarr":
        library = MoveLibrary(path)
        middle = {axis.name: axis.values[len(axis.values) // 2] for axis in library.grid.axes}
        return Explored(library.plan(**middle), library=library)
    if format_of(path) == f"quietarm-{Front.kind}":
        front = load_front(path)
        refuse_peaks(str(path), front.objectives)
        coefficients = front.points[0].coefficients
        plan = evaluate_coefficients(front.task, coefficients, profile=front.profile)
        return Explored(plan, bound=front.record.bound, front=front).pick(0)
    (plan,) = load_plans([path]).values()
    return Explored(plan, residual_limit=plan.residual_limit or None, bound=plan.record.bound)


def is_file(what: str) -> bool:
    """Whether this names a file or a folder of answers, and no plant."""
    path = Path(what)
    machine = path.suffix == ".json" and format_of(path) == "quietarm-machine"
    return path.suffix in (".json", ".zarr") and not machine


def menu(plant: Plant) -> dict[str, Plant]:
    """A plant, and those of its kind of joint that have a value for every parameter, by words."""
    plants = {plant_words(plant): plant}
    for kind in known_plants().values():
        with suppress(TypeError):  # a parameter without a value
            plant_of_kind = kind()
            if plant_of_kind.joint == plant.joint:
                plants.setdefault(plant_words(plant_of_kind), plant_of_kind)
    return plants
