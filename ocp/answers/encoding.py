"""Values in JSON's types and back: `plain` and `typed`.

The names are those of the attributes. msgspec checks every entry against its type; what it says is
told here with the entry's value.
"""

from __future__ import annotations

import dataclasses
import re
import reprlib
from collections.abc import Mapping
from enum import Enum
from typing import Annotated, Any, TypeVar

import msgspec
import numpy as np
from quietarm.models import Plant, file_of_plant, known_plants
from quietarm.ocp.profiles.joint_profile import JointProfile, known_profiles
from quietarm.ocp.robustness.uncertain import UncertainPlant

T = TypeVar("T")

PLANT_FILE = "plant_file"
"""The entry of a plant that tells of the file it was loaded from."""
UNCERTAIN = "uncertain"
"""The entry of a plant that tells how far it may be wrong."""
_SHOWN = 12
"""Digits of a digest that a message shows."""


@dataclasses.dataclass(frozen=True)
class _PlantFile:
    path: str
    sha256: str


@dataclasses.dataclass(frozen=True)
class _Uncertainty:
    """The entry of an uncertain plant beside those of the assumed one; see `UncertainPlant`."""

    ranges: Mapping[str, float]
    samples: Annotated[tuple[tuple[float, ...], ...], msgspec.Meta(min_length=1)]


def plain(value: Any) -> Any:
    """A value in JSON's types, SI units and radians."""
    if isinstance(value, UncertainPlant):
        return {**plain(value.assumed), UNCERTAIN: _entries(value, "ranges", "samples")}
    if isinstance(value, Plant):
        file = file_of_plant(type(value))
        recorded = {} if file is None else {PLANT_FILE: plain(_PlantFile(file.path, file.digest))}
        return {"name": _name_of(value), **recorded, **_entries(value)}
    if isinstance(value, JointProfile):
        return {"name": _name_of(value), **_entries(value)}
    if dataclasses.is_dataclass(value):
        return _entries(value)
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Mapping):
        return {name: plain(entry) for name, entry in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return value


def typed(document: Any, kind: type[T], name: str = "") -> T:
    """The value of a document: the opposite of `plain`."""
    try:
        value = msgspec.convert(document, kind, dec_hook=_named_or_array)
    except msgspec.ValidationError as error:
        raise _in_words(str(error), document, name) from None
    _refuse_other_entries(document, plain(value), f"{name}." if name else "")
    return value


def _entries(value: Any, *only: str) -> dict[str, Any]:
    names = only or [entry.name for entry in dataclasses.fields(value) if entry.init]
    return {name: plain(getattr(value, name)) for name in names}


def _name_of(value: Plant | JointProfile) -> str:
    known = known_plants() if isinstance(value, Plant) else known_profiles()
    own = type(value)
    if known.get(value.name) is not own:
        raise ValueError(
            f"{own.__name__} has no name of its own, and {value.name!r} would load as another "
            "class; set `name` in the class"
        )
    return value.name


def _named_or_array(kind: Any, entry: Any) -> Any:
    """What msgspec does not know: plants and profiles by their name, arrays."""
    if kind is Plant:
        return _plant(_table("plant", entry))
    if kind is JointProfile:
        return _named("profile", _table("profile", entry), known_profiles())
    try:
        return np.array(msgspec.convert(entry, list[float]), dtype=float)
    except msgspec.ValidationError:
        raise ValueError(f"{reprlib.repr(entry)} is no list of numbers") from None


def _table(what: str, entry: Any) -> dict[str, Any]:
    if not isinstance(entry, dict):
        raise ValueError(f"{what} is {reprlib.repr(entry)}; give a table with its name")
    return dict(entry)


def _plant(entry: dict[str, Any]) -> Plant:
    """The plant of an entry, whose file is checked: nothing is run but what the user named."""
    file, uncertain = entry.pop(PLANT_FILE, None), entry.pop(UNCERTAIN, None)
    if file is not None:
        _check_file(entry["name"], typed(file, _PlantFile, PLANT_FILE))
    plant = _named("plant", entry, known_plants())
    if uncertain is None:
        return plant
    return UncertainPlant(plant, **vars(typed(uncertain, _Uncertainty, UNCERTAIN)))


def _check_file(name: str, file: _PlantFile) -> None:
    """ValueError when the plant of that name here is of another file, or the file has changed."""
    plant = known_plants().get(name)
    mine = None if plant is None else file_of_plant(plant)
    if mine is None:
        here = "is not known here" if plant is None else "is not the one that is known here"
        raise ValueError(
            f"its plant {name!r} {here}; give its file {file.path!r} again, by --plant-file or "
            "load_plant_file"
        )
    if mine.digest != file.sha256:
        raise ValueError(
            f"its plant {name!r} was in {file.path!r} with SHA-256 {file.sha256[:_SHOWN]!r}, and "
            f"{mine.path!r} has {mine.digest[:_SHOWN]!r}: the equations may have changed; give the "
            "file as it was, or compute anew"
        )


def _named(what: str, entry: dict[str, Any], known: Mapping[str, type[Any]]) -> Any:
    name = entry["name"]
    if not isinstance(name, str) or name not in known:
        raise ValueError(
            f"its {what} {reprlib.repr(name)} is not known here (known: "
            f"{', '.join(sorted(known))}); import the file that defines it first"
            + (", or name it by --plant-file" if what == "plant" else "")
        )
    arguments = {key: value for key, value in entry.items() if key != "name"}
    fields = {field.name: field for field in dataclasses.fields(known[name])}
    unknown = sorted(arguments.keys() - fields)
    if unknown:
        raise ValueError(f"its {what} {name!r} has no {reprlib.repr(unknown[0])}; take it out")
    for field in fields.values():
        if field.default is field.default_factory is dataclasses.MISSING:
            arguments[field.name]
    try:
        return known[name](**arguments)
    except OverflowError:
        raise ValueError(f"a number of its {what} is beyond double precision") from None


def _refuse_other_entries(found: Any, wanted: Any, place: str = "") -> None:
    """ValueError or KeyError where a document has other entries than are written."""
    if isinstance(wanted, dict):
        unknown = [name for name in found if name not in wanted]
        if unknown:
            raise ValueError(
                f"its entry {place + unknown[0]!r} is not known here; take it out, or install a "
                "newer quietarm"
            )
        for name, entry in wanted.items():
            if name in found:
                _refuse_other_entries(found[name], entry, f"{place}{name}.")
            elif entry is not None and name != PLANT_FILE:  # a script's own plant has no file
                raise KeyError(place + name)
    elif isinstance(wanted, list):
        for i, (entry, written) in enumerate(zip(found, wanted, strict=True)):
            _refuse_other_entries(entry, written, f"{place.removesuffix('.')}[{i}].")


def _in_words(text: str, document: Any, name: str) -> KeyError | ValueError:
    """The error that says what msgspec's text does, with the entry's value and a remedy."""
    said, *places = " ".join(text.split()).split(" - at `$")
    place = "".join(part.rstrip("`") for part in reversed(places)).lstrip(".")
    missing = re.fullmatch(r"Object missing required field `(.*)`", said)
    if missing:
        return KeyError(".".join(filter(None, [name, place, missing[1]])))
    expected = re.fullmatch(r"Expected `([^`]*)`(.*?)(, got .*)?", said)
    if expected:
        kinds = " or ".join(_KINDS.get(kind, kind) for kind in expected[1].split(" | "))
        each = " in every entry" if place.endswith("[...]") else ""
        return ValueError(f"{_with_value(place, document, name)}; give {kinds}{expected[2]}{each}")
    if said.startswith("Invalid enum value"):
        return ValueError(f"{_with_value(place, document, name)}, which is not known here")
    if said.endswith("out of range"):
        return ValueError(
            f"{_with_value(place, document, name)}; give a number of double precision"
        )
    return ValueError(f"{said} (at {place})" if place else said)  # the words of the value itself


_KINDS = {
    "float": "a number", "int": "a whole number", "str": "a text", "bool": "true or false",
    "array": "a list", "object": "a table",
}  # fmt: skip


def _with_value(place: str, document: Any, name: str) -> str:
    """The place of an entry and its value; where msgspec leaves out a name, that of the table."""
    known = place.partition("[...]")[0]
    for key, index in re.findall(r"(\w+)|\[(\d+)\]", known):
        document = document[int(index) if index else key]
    path = ".".join(filter(None, [name, known])).replace(".[", "[") or "it"
    return f"{path} is {reprlib.repr(document)}"
