"""Plants in documents: by name, with the file that a plant of one's own was loaded from."""

from __future__ import annotations

from typing import Any

from models import Plant, file_of_plant, known_plants

_SHOWN = 12
"""Digits of a digest that a message shows."""


def plant_file_entry(plant: Plant) -> dict[str, dict[str, str]]:
    """What a document says of the file of a plant; nothing where it was not loaded from one."""
    file = file_of_plant(type(plant))
    return {} if file is None else {"plant_file": {"path": file.path, "sha256": file.digest}}


def known_plant(name: object, file: Any = None) -> type[Plant]:
    """The class that a document means. Nothing is run for it: the user names the file.

    Parameters
    ----------
    name : object
        The plant's name in the document.
    file : Any
        The document's entry `plant_file`, if it has one.

    Returns
    -------
    type
        The class of plants.

    Raises
    ------
    ValueError
        When the plant is not known here, or it is of another file, or the file has changed.
    """
    if file is not None and not (
        isinstance(file, dict) and all(isinstance(file.get(k), str) for k in ("path", "sha256"))
    ):
        raise ValueError(f"plant_file is {file!r}, not a table with path and sha256")
    plant = known_plants().get(name) if isinstance(name, str) else None
    give = (
        "import the file that defines it first"
        if file is None
        else f"give its file {file['path']!r} again, by --plant-file or load_plant_file"
    )
    if plant is None:
        known = ", ".join(sorted(known_plants()))
        raise ValueError(f"its plant {name!r} is not known here (known: {known}); {give}")
    if file is None:
        return plant
    mine = file_of_plant(plant)
    if mine is None:
        raise ValueError(f"its plant {name!r} is not the one that is known here; {give}")
    if mine.digest != file["sha256"]:
        raise ValueError(
            f"its plant {name!r} was in {file['path']!r} with SHA-256 "
            f"{file['sha256'][:_SHOWN]!r}, and {mine.path!r} has {mine.digest[:_SHOWN]!r}: the "
            "equations may have changed; give the file as it was, or compute anew"
        )
    return plant
