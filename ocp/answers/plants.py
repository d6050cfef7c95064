"""What documents say of a plant: the file it was loaded from, and how far it may be wrong."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from msgspec import Meta
from quietarm.models import Plant, file_of_plant, known_plants

PLANT_FILE = "plant_file"
"""The entry of a plant that tells of its file."""
UNCERTAIN = "uncertain"
"""The entry of a plant that tells how far it may be wrong."""
_SHOWN = 12
"""Digits of a digest that a message shows."""


@dataclass(frozen=True)
class Uncertainty:
    """The entry of an uncertain plant beside those of the assumed one; see `UncertainPlant`."""

    ranges: Mapping[str, float]
    samples: Annotated[tuple[tuple[float, ...], ...], Meta(min_length=1)]


def without_uncertainty(entry: Any) -> tuple[Any, Any]:
    """The entry of the assumed plant, and how far it may be wrong; None where it may not be."""
    if not isinstance(entry, dict) or UNCERTAIN not in entry:
        return entry, None
    rest = dict(entry)
    uncertainty = rest.pop(UNCERTAIN)
    return rest, uncertainty


def file_entry(plant: Plant) -> dict[str, dict[str, str]]:
    """What a document says of the file of a plant; nothing where it was not loaded from one."""
    file = file_of_plant(type(plant))
    return {} if file is None else {PLANT_FILE: {"path": file.path, "sha256": file.digest}}


def without_file(entry: Any) -> Any:
    """The entry of a plant without that of its file, which is checked.

    Nothing is run for it: the user names the file, by `load_plant_file`.

    Parameters
    ----------
    entry : Any
        The document's entry of a plant.

    Returns
    -------
    Any
        The rest of it.

    Raises
    ------
    ValueError
        When the plant of that name here is of another file, or the file has changed.
    """
    if not isinstance(entry, dict) or PLANT_FILE not in entry:
        return entry
    rest = dict(entry)
    file, name = rest.pop(PLANT_FILE), reprlib.repr(rest.get("name"))
    path, digest = (file.get(key) if isinstance(file, dict) else None for key in ("path", "sha256"))
    if not isinstance(path, str) or not isinstance(digest, str):
        raise ValueError(
            f"{PLANT_FILE} is {reprlib.repr(file)}; give a table with its path and sha256"
        )
    plant = known_plants().get(str(rest.get("name")))
    mine = None if plant is None else file_of_plant(plant)
    if mine is None:
        here = "is not known here" if plant is None else "is not the one that is known here"
        raise ValueError(
            f"its plant {name} {here}; give its file {path!r} again, by --plant-file or "
            "load_plant_file"
        )
    if mine.digest != digest:
        raise ValueError(
            f"its plant {name} was in {path!r} with SHA-256 {digest[:_SHOWN]!r}, and "
            f"{mine.path!r} has {mine.digest[:_SHOWN]!r}: the equations may have changed; give the "
            "file as it was, or compute anew"
        )
    return rest
