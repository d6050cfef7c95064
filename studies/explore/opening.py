"""What the page begins with: a plant, or what a file of a plan, a front or a sweep holds."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from pathlib import Path

import msgspec
import numpy as np
from quietarm.models import Plant
from quietarm.ocp import CycloidPolynomial, Plan, PointToPoint, evaluate_coefficients
from quietarm.ocp.files import read_bytes
from quietarm.studies.display.words import plant_words
from quietarm.studies.explore.state import Explored
from quietarm.studies.reading.saved import load_front, load_plans
from quietarm.studies.sweep.library import MoveLibrary

_TARGET, _DURATION = pi / 6, 0.8
"""The paper's first move."""


def of_plant(plant: Plant) -> Explored:
    """The plain cycloid of a plant, with the coefficients of six terms to be set."""
    task = PointToPoint(plant, _TARGET, _DURATION)
    profile = CycloidPolynomial()
    return Explored(evaluate_coefficients(task, profile.plain, profile=profile))


def of_file(path: Path) -> Explored:
    """What a file or a folder holds; FileFormatError where that is none of these."""
    if path.is_dir() or path.suffix == ".zarr":
        return _of_library(MoveLibrary(path))
    if _kind(path) == "quietarm-front":
        front = load_front(path)
        bound = front.settings.get("bound")
        stillest = evaluate_coefficients(
            front.task, front.points[0].coefficients, profile=front.profile, method=front.method
        )
        return Explored(stillest, bound=None if bound is None else float(bound), front=front)
    (plan,) = load_plans([path]).values()
    return _of_plan(plan)


def is_file(what: str) -> bool:
    """Whether this names a file or a folder of answers, and no plant."""
    path = Path(what)
    machine = path.suffix == ".json" and _kind(path) == "quietarm-machine"
    return path.suffix in (".json", ".zarr") and not machine


def _of_plan(plan: Plan) -> Explored:
    asked = plan.provenance.settings
    if asked is None:
        return Explored(plan)
    return Explored(plan, residual_limit=asked.residual_limit or None, bound=asked.bound)


def _of_library(library: MoveLibrary) -> Explored:
    """The cell in the middle of a grid."""
    middle = {axis.name: float(np.sort(axis.values)[len(axis.values) // 2])
              for axis in library.grid.axes}  # fmt: skip
    return Explored(library.plan(**middle), library=library)


def _kind(path: Path) -> object:
    """The format that a file states; None where it is no JSON, for its reader to refuse."""
    try:
        return msgspec.json.decode(read_bytes(path)).get("format")
    except (msgspec.DecodeError, UnicodeDecodeError, AttributeError):
        return None


def menu(plant: Plant, kinds: Mapping[str, type[Plant]]) -> dict[str, Plant]:
    """A plant, and those of other kinds that have a value for every parameter, by their words."""
    found = {plant_words(plant): plant}
    for kind in kinds.values():
        try:
            other = kind()
        except TypeError:  # a parameter without a value
            continue
        found.setdefault(plant_words(other), other)
    return found
