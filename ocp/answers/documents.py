"""JSON documents with a format name and a version; never pickle, never anything that runs."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from models import __version__, known_plants
from ocp.base.checks import finite
from ocp.base.errors import FileFormatError
from ocp.base.files import write_whole
from ocp.profiles.joint_profile import JointProfile, known_profiles
from ocp.simulation.objective import Motion
from ocp.task.point_to_point import LIMITS, PointToPoint

Document = dict[str, Any]


def versions() -> dict[str, str]:
    """Versions of what computed an answer."""
    return {
        "quietarm": __version__,
        "casadi": ca.CasadiMeta.version(),
        "numpy": np.__version__,
        "python": platform.python_version(),
    }


def write_document(path: str | Path, kind: str, version: int, content: Mapping[str, Any]) -> None:
    """Write a document whole or not at all.

    Parameters
    ----------
    path : str or Path
        The file.
    kind : str
        Format name.
    version : int
        Format version.
    content : mapping
        The rest, of JSON's types.

    Raises
    ------
    ValueError
        When the file cannot be written.
    """
    document = {"format": kind, "version": version, **content}
    write_whole(path, json.dumps(document, indent=2, allow_nan=False) + "\n")


def read_document(path: str | Path, kind: str, version: int, oldest: int = 1) -> Document:
    """Read a document of one kind, of this version or older.

    Parameters
    ----------
    path : str or Path
        The file.
    kind : str
        Format name that it must have.
    version, oldest : int
        Newest and oldest version that can be read.

    Returns
    -------
    dict
        The document.

    Raises
    ------
    FileFormatError
        When the file cannot be read, is not of this kind, or is newer or too old.
    """
    name = kind.removeprefix("quietarm-")
    try:
        document = json.loads(
            Path(path).read_text(encoding="utf-8"), parse_constant=_no_constant, parse_float=_finite
        )
    except OSError as error:
        reason = error.strerror or str(error)
        raise FileFormatError(f"{path} cannot be read: {reason.lower()}") from None
    except (ValueError, RecursionError):
        raise FileFormatError(f"{path} is not a {name}: it is not whole, valid JSON") from None
    if not isinstance(document, dict) or document.get("format") != kind:
        found = document.get("format") if isinstance(document, dict) else None
        says = f"its format is {found!r}" if found else "it has no quietarm format name"
        raise FileFormatError(f"{path} is not a {name}: {says}")
    found = document.get("version")
    if not isinstance(found, int) or isinstance(found, bool) or found < 1:
        raise FileFormatError(f"{path} is not a {name}: its version is {found!r}")
    if found > version:
        raise FileFormatError(
            f"{path} has version {found} of the {name} format and this quietarm reads up to "
            f"{version}; install a newer quietarm"
        )
    if found < oldest:
        raise FileFormatError(
            f"{path} has version {found} of the {name} format and this quietarm reads "
            f"{version if oldest == version else f'{oldest} to {version}'}; find the {name} again"
        )
    return document


@contextmanager
def reading(path: str | Path, name: str) -> Iterator[None]:
    """Turn a missing or wrong entry met while reading a document into one clear error."""
    try:
        yield
    except FileFormatError:
        raise
    except KeyError as error:
        raise FileFormatError(f"{path} is not a whole {name}: {error} is missing") from None
    except ValueError as error:
        raise FileFormatError(f"{path} is not a valid {name}: {error}") from None
    except (TypeError, AttributeError, OverflowError):  # in Python's own words, which help nobody
        raise FileFormatError(
            f"{path} is not a valid {name}: an entry is not of the kind it should be; write the "
            f"{name} again"
        ) from None


def task_to_document(task: PointToPoint) -> Document:
    """A task in JSON's types, SI units."""
    return {
        "plant": task.plant.name,
        "plant_parameters": task.plant.parameters,
        "start": task.start,
        "target": task.target,
        "duration": task.duration,
        "residual_window": task.residual_window,
        "limits": task.limits,
    }


def task_from_document(document: Document) -> PointToPoint:
    """The task of a document; KeyError, TypeError or ValueError where it is not one."""
    name = document["plant"]
    plant = known_plants().get(name) if isinstance(name, str) else None
    if plant is None:
        raise ValueError(
            f"its plant {name!r} is not known here (known: {', '.join(sorted(known_plants()))}); "
            "import the file that defines it first"
        )
    limits = {f"{name}_limit": value for name, value in _table(document, "limits").items()}
    unknown = sorted(set(limits) - set(LIMITS))
    if unknown:
        raise ValueError(f"unknown limit {unknown[0]!r}")
    return PointToPoint(
        plant=made(plant, _table(document, "plant_parameters")),
        start=document["start"],
        target=document["target"],
        duration=document["duration"],
        residual_window=document["residual_window"],
        **limits,
    )


def profile_to_document(profile: JointProfile) -> Document:
    """A profile in JSON's types; ValueError where its class could not be found by its name."""
    own = type(profile)
    if known_profiles().get(profile.name) is not own:
        raise ValueError(
            f"{own.__name__} has no name of its own, and {profile.name!r} would load as another "
            "profile; set `name` in the class"
        )
    return {"name": profile.name, **vars(profile)}


def profile_from_document(document: Document) -> JointProfile:
    """The profile of a document; KeyError, TypeError or ValueError where it is not one."""
    arguments = dict(document)
    name = arguments.pop("name")
    profile = known_profiles().get(name) if isinstance(name, str) else None
    if profile is None:
        raise ValueError(f"its profile {name!r} is not known here")
    return made(profile, arguments)


_Made = TypeVar("_Made")


def made(kind: type[_Made], arguments: Mapping[str, Any]) -> _Made:
    """An object of its arguments.

    Parameters
    ----------
    kind : type
        Its class.
    arguments : mapping
        What it takes, by name.

    Returns
    -------
    object
        The object.

    Raises
    ------
    KeyError
        When an argument is missing.
    ValueError
        When it takes no such argument.
    """
    entries = fields(kind) if is_dataclass(kind) else ()
    for entry in entries:
        if entry.init and entry.default is MISSING and entry.default_factory is MISSING:
            arguments[entry.name]
    known = {entry.name for entry in entries} or set(arguments)
    unknown = sorted(set(arguments) - known)
    if unknown:
        raise ValueError(f"{kind.__name__} has no {unknown[0]!r}")
    return kind(**arguments)


def _table(document: Document, name: str) -> Mapping[str, Any]:
    if not isinstance(document[name], dict):
        raise ValueError(f"{name} is {document[name]!r}, not a table of names and values")
    return document[name]


def motion_of(figures: Document) -> Motion:
    """The figures of a motion, with a jerk or none; KeyError or ValueError where one is wrong."""
    optional = {entry.name for entry in fields(Motion) if entry.default is None}
    absent = {name for name in optional if figures.get(name) is None}
    return Motion(
        **numbers_of(figures, [entry.name for entry in fields(Motion) if entry.name not in absent])
    )


def numbers_of(document: Document, names: Iterable[str]) -> dict[str, float]:
    """The entries of these names, each a finite number; KeyError or ValueError otherwise."""
    return {name: finite(name, document[name]) for name in names}


def _finite(text: str) -> float:
    return finite("a number of the file", float(text))


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number of JSON")
