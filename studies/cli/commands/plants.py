"""`quietarm plants`: the plants, and what each of their parameters means."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from typing import Any

import click
from quietarm.models import Plant, known_plants
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.task import plant_file_option
from quietarm.studies.cli.types import PLANT
from quietarm.studies.document.blocks import Document, Facts, Lines


@click.command()
@click.argument("plant", type=PLANT, required=False)
@plant_file_option()
def plants(plant: type[Plant] | None, plant_file: Mapping[str, type[Plant]] | None) -> None:
    """List the plants; or the parameters of one, with value, unit, meaning and source.

    \b
    Examples:
      quietarm plants
      quietarm plants single-link
      quietarm plants --plant-file crane.py
    """  # noqa: D301  # \b is click's: do not rewrap
    known = known_plants() if plant_file is None else dict(plant_file)
    if plant is None and len(known) == 1:
        (plant,) = known.values()
    if plant is not None:
        rows = [(entry.name, _in_words(entry)) for entry in fields(plant)]
        title, then = plant.name, "--set NAME=VALUE sets one; also as 2Hz, 600mm or 200g."
    else:
        rows = [(name, (kind.__doc__ or "").partition("\n")[0]) for name, kind in known.items()]
        title, then = "", "quietarm plants NAME lists its parameters."
    finish([], Document(title, [Facts(rows), Lines(["", then])]))


def _in_words(entry: Field[Any]) -> str:
    """A parameter's value, meaning and source."""
    told = entry.metadata
    value = "no default" if entry.default is MISSING else f"{entry.default:.5g}"
    unit = "" if told.get("unit", "-") == "-" else f" {told['unit']}"
    meaning = f": {told['meaning']}" if told.get("meaning") else ""
    source = f"  ({told['source']})" if told.get("source") else ""
    return f"{value}{unit}{meaning}{source}"
