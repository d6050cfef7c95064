"""What documents say of the file that a user's plant was loaded from."""

from __future__ import annotations

import reprlib
from typing import Any

from models import Plant, file_of_plant, known_plants

PLANT_FILE = "plant_file"
"""The entry of a plant that tells of its file."""
_SHOWN = 12
"""Digits of a digest that a message shows."""


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
