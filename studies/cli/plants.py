"""The plant of a command: by its name or from a file, with the parameters that are set."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields, replace
from math import tau

from quietarm.models import FlexibleBeam, Plant, known_plants
from quietarm.ocp import Uncertainty
from quietarm.ocp.checks import has_no, unknown
from quietarm.studies.cli.quantities import MEASURED, once, parse_quantity, parse_share
from quietarm.studies.identify import Identified
from quietarm.studies.report.words import print_lines
from rich.console import Console

Kind = type[Plant] | Identified | None
"""What PLANT names: a class of plants, an identified machine, or nothing."""


def parse_plant(name: str) -> type[Plant] | Identified:
    """A class of plants by its name, or an identified machine by its file."""
    if name.endswith(".json"):
        return Identified.load(name)
    plants = known_plants()
    if name not in plants:
        also = "; your own by its --plant-file, an identified one by its .json"
        raise ValueError(unknown("plant", name, sorted(plants), also))
    return plants[name]


def uncertainty_of(errors: Iterable[tuple[str, float]], kind: Kind) -> Uncertainty | None:
    """The uncertainty by these errors; None without any."""
    ranges = once(errors, "--error ")
    if ranges.pop(MEASURED, None) is not None:
        if not isinstance(kind, Identified):
            raise ValueError(
                "--error measured is for an identified machine; give its file as PLANT, or errors "
                "as frequency=10%"
            )
        ranges = {**kind.errors, **ranges}
    return Uncertainty(ranges) if ranges else None


def check_machine(
    kind: Kind, settings: Iterable[tuple[str, str]], errors: Iterable[tuple[str, float]]
) -> None:
    """Hold what is set of an identified machine against what was measured of it.

    ValueError where --error measured rests on it. A beam with another tip mass keeps its measured
    frequency, and standard error says so: it may have been weighed anew, or carry another payload.
    """
    if not isinstance(kind, Identified):
        return
    given = values_of_plant(kind.plant, settings)
    if any(name == MEASURED for name, _ in errors):
        kind.check_unchanged(given)
    beam = kind.plant
    if isinstance(beam, FlexibleBeam) and "omega" not in given:
        mass = given.get("tip_mass", beam.tip_mass)
        if mass >= 0 and mass != beam.tip_mass:
            loaded = beam.carrying(mass).omega / tau
            print_lines(
                Console(stderr=True),
                f"warning: tip_mass is {mass:.4g} kg, and was {beam.tip_mass:.4g} kg when the "
                f"frequency of {beam.omega / tau:.4g} Hz was measured, which is kept; if the "
                f"payload has changed, give --set omega={loaded:.4g}Hz, by the beam's equation, or "
                "record it anew",
            )


def units_of_plant(plant: Plant | type[Plant], names: Iterable[str]) -> dict[str, str]:
    """Units of parameters; ValueError where there is no such parameter."""
    known = {entry.name: entry.metadata for entry in fields(plant)}
    for name in names:
        if name not in known:
            its = [other for other, of in known.items() if name in of.get("meaning", "")]
            meant = f"; the {name} is {' or '.join(its)}" if its else ""
            raise ValueError(has_no(plant.name, "parameter", name, known) + meant)
    return {name: plant.units()[name] for name in names}


def values_of_plant(
    plant: Plant | type[Plant], settings: Iterable[tuple[str, str]]
) -> dict[str, float]:
    """What parameters are set to."""
    texts = once(settings, "--set ")
    units = units_of_plant(plant, texts)
    return {
        name: parse_share(text, name)
        if name.startswith(("zeta", "damping"))
        else parse_quantity(text, units[name], f"a value of {name}")
        for name, text in texts.items()
    }


def chosen_plant(
    kind: Kind, own: Mapping[str, type[Plant]] | None, settings: Iterable[tuple[str, str]]
) -> Plant:
    """The plant that was asked for."""
    if kind is None:
        if not own:
            raise ValueError(
                "missing argument PLANT; give one, as single-link, or a file by --plant-file"
            )
        if len(own) > 1:
            raise ValueError(f"the plant file defines {' and '.join(own)}; name one as PLANT")
        (kind,) = own.values()
    if isinstance(kind, Identified):
        return replace(kind.plant, **values_of_plant(kind.plant, settings))
    if own is not None and kind not in own.values():
        raise ValueError(
            f"the plant file defines {' and '.join(own)}, not {kind.name}; leave {kind.name} or "
            "--plant-file out"
        )
    given = values_of_plant(kind, settings)
    for entry in fields(kind):
        if entry.default is entry.default_factory is MISSING and entry.name not in given:
            raise ValueError(
                f"{kind.name} has no value for {entry.name}; give --set {entry.name}=..."
            )
    return kind(**given)
