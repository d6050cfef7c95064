"""The plant of a command: by its name or from a file, with the parameters that are set."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import MISSING, fields, replace
from math import tau
from typing import Any

from quietarm.machine.identify import Identified
from quietarm.machine.identify.identified import LEAST_OF_FREQUENCY, is_modal
from quietarm.models import FlexibleBeam, Plant, Robot, RobotOnPath, known_plants
from quietarm.models.drive import Recorded
from quietarm.models.plant import FREQUENCY
from quietarm.ocp import Uncertainty
from quietarm.ocp.checks import unknown
from quietarm.ocp.task import RANGE_OF_BAND
from quietarm.studies.cli.quantities import MEASURED, once, parse_parameters
from quietarm.views.report.acting_words import ranges_words
from quietarm.views.report.terminal import ErrorConsole, print_lines
from quietarm.views.report.words import note_lines

Kind = type[Plant] | Identified | Robot
"""What PLANT names: a class of plants, an identified machine, or a robot."""
OF_ROBOTS = (".yaml", ".yml")
"""Endings of the files of robots."""
ROBOT_IS_NO_PLANT = (
    "a robot is a plant on a path alone; give it to quietarm plan, evaluate, front or search, with "
    "--start and --target or --path"
)


def parse_plant(name: str) -> Kind:
    """A class of plants by its name, or an identified machine or a robot by its file."""
    if name.endswith(".json"):
        return Identified.load(name)
    if name.endswith(OF_ROBOTS):
        return Robot.load(name)
    plants = {known: plant for known, plant in known_plants().items() if plant is not RobotOnPath}
    if name not in plants:
        also = (
            "; your own by its --plant-file, an identified one by its .json, a robot by its .yaml"
        )
        raise ValueError(unknown("plant", name, sorted(plants), also))
    return plants[name]


def choose_kind(named: Kind | None, of_file: Mapping[str, type[Plant]] | None) -> Kind:
    """Return what PLANT names, or else the only plant of a plant file."""
    if named is not None:
        return named
    if not of_file:
        raise ValueError(
            "missing argument PLANT; give one, such as single-link, or a file by --plant-file"
        )
    if len(of_file) > 1:
        raise ValueError(f"the plant file defines {' and '.join(of_file)}; name one as PLANT")
    return next(iter(of_file.values()))


def parameters_of(kind: Kind, settings: Iterable[tuple[str, str]]) -> dict[str, tuple[float, ...]]:
    """The parameters that were set, each with its value, or several."""
    if isinstance(kind, Robot):
        raise ValueError(ROBOT_IS_NO_PLANT)
    return parse_parameters(kind.plant if isinstance(kind, Identified) else kind, settings)


def build_plant(kind: Kind, values: Mapping[str, Any]) -> Plant:
    """The plant with these values; of an identified machine it keeps the others."""
    if isinstance(kind, Robot):
        raise ValueError(ROBOT_IS_NO_PLANT)
    if isinstance(kind, Identified):
        return replace(kind.plant, **values)
    for entry in fields(kind):
        is_needed = entry.default is entry.default_factory is MISSING
        if is_needed and entry.name not in values:
            raise ValueError(
                f"{kind.name} has no value for {entry.name}; give --set {entry.name}=..."
            )
    return kind(**values)


def recorded_of(kind: Kind, changed: Collection[str]) -> Recorded | None:
    """Return how an identified machine's frequencies were recorded, unless other ones are set."""
    if not isinstance(kind, Identified) or any(is_modal(kind.plant, name) for name in changed):
        return None
    return kind.recorded


def build_uncertainty(
    kind: Kind, errors: Iterable[tuple[str, float]], changed: Collection[str]
) -> Uncertainty | None:
    """The uncertainty by these errors; None without any.

    ValueError where `MEASURED` is of no machine, or rests on parameters that are changed.
    """
    ranges = once(errors, "--error ")
    if ranges.pop(MEASURED, None) is not None:
        if not isinstance(kind, Identified):
            raise ValueError(
                "--error measured is for an identified machine; give its file as PLANT, or errors "
                "as frequency=10%"
            )
        kind.check_unchanged(changed)
        ranges = {**kind.ranges, **ranges}
    return Uncertainty(ranges) if ranges else None


def floor_words(kind: Kind, errors: Iterable[tuple[str, float]]) -> list[str]:
    """Frequencies for which `MEASURED` stands for more than the recordings show, in words."""
    if not isinstance(kind, Identified) or MEASURED not in dict(errors):
        return []
    shown = kind.errors
    return [
        f"{name} is {100 * shown[name]:.2g} % uncertain by the recordings, and {100 * size:g} % "
        "here, as another day or the servo in place of the brake shows more"
        for name, size in kind.ranges.items()
        if size > shown[name]
    ]


def uncertainty_of_band(kind: Kind, changed: Collection[str]) -> tuple[Uncertainty, str]:
    """The errors for which a tip stays in its band where none are typed, and why these in words."""
    usual = Uncertainty(RANGE_OF_BAND)
    words = f"{ranges_words(usual.ranges).removeprefix('for ')}, as no --error is given"
    if not isinstance(kind, Identified):
        return usual, words
    try:
        kind.check_unchanged(changed)
    except ValueError as error:
        return usual, f"{words} and its file has no range: {error}"
    try:
        ranges = kind.ranges
    except ValueError as error:
        least = usual.ranges[FREQUENCY]
        if kind.error_of_frequency <= least:
            return usual, f"{words} and its file has no range: {error}"
        own = Uncertainty({FREQUENCY: kind.error_of_frequency})
        words = ranges_words(own.ranges).removeprefix("for ")
        return (
            own,
            f"{words}, by its file, which has no range to plan for: {error}",
        )
    floor = f", {100 * LEAST_OF_FREQUENCY:g} % of a frequency at least"
    return Uncertainty(ranges), f"{ranges_words(ranges).removeprefix('for ')}, as identified{floor}"


def warn_of_notes(plant: Plant) -> None:
    """Say before the work what a plant's files leave open or have wrong."""
    lines = note_lines(plant)
    if lines:
        print_lines(ErrorConsole(), *lines)


def warn_of_payload(kind: Kind, plant: Plant, changed: Collection[str]) -> None:
    """Say that an identified beam with another tip mass keeps its measured frequency.

    It may have been weighed anew, or carry another payload.
    """
    beam = getattr(kind, "plant", None)
    mass = plant.parameters.get("tip_mass", 0.0)
    if not isinstance(beam, FlexibleBeam) or mass == beam.tip_mass or "omega" in changed:
        return
    loaded = beam.carrying(mass).omega / tau
    print_lines(
        ErrorConsole(),
        f"warning: tip_mass is {mass:.4g} kg, and was {beam.tip_mass:.4g} kg when the frequency of "
        f"{beam.omega / tau:.4g} Hz was measured, which is kept; if the payload has changed, give "
        f"--set omega={loaded:.4g}Hz, by the beam's equation, or record it anew",
    )
