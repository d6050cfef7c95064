"""Plants of a user's own file, which is run only when the user names it."""

from __future__ import annotations

import copyreg
import hashlib
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from inspect import isabstract
from pathlib import Path
from types import ModuleType
from typing import Any

from quietarm.interrupts import interruptible
from quietarm.models.number_checks import words_of_error
from quietarm.models.plant import Plant


@dataclass(frozen=True)
class PlantFile:
    """A file that defines plants: its name, as it was given, and its content."""

    path: str
    source: bytes = field(repr=False)

    @property
    def digest(self) -> str:
        """SHA-256 of the content, in hexadecimal digits."""
        return hashlib.sha256(self.source).hexdigest()


_file_of: dict[type[Plant], PlantFile] = {}
_module_of: dict[bytes, tuple[ModuleType, PlantFile]] = {}
"""The module of every file that was run, by its content."""
_added: list[object] = []
"""Entries of one's own that are no classes, as quantities and figures."""


def note_added(entry: object) -> None:
    """Note an entry of one's own: a file that adds one is a plant file without a plant, too."""
    _added.append(entry)


@interruptible
def load_plant_file(path: str | Path) -> Mapping[str, type[Plant]]:
    """Run a Python file that you trust, and make what it defines known by name.

    Its plants, and profiles, energies, searches, indicators, formats and panels, with or without
    a plant.

    Parameters
    ----------
    path : str or Path
        The file; what it imports stands beside it or is installed.

    Returns
    -------
    mapping of str to type
        Its plants by name. The same content gives the same classes every time.

    Raises
    ------
    ValueError
        When it cannot be read or imported, or defines nothing that is complete.
    """
    if not isinstance(path, str | Path):
        raise TypeError(f"path is {path!r}; give the name of a Python file, such as 'plants.py'")
    if Path(path).suffix != ".py":  # a data file may be valid Python, and is not run by mistake
        raise ValueError(f"plant file {path} is not called .py; give a Python file")
    most_bytes = 1_000_000  # some twenty thousand lines
    try:
        if Path(path).exists() and not Path(path).is_file():  # a pipe or a device may never end
            raise ValueError(f"plant file {path} is no ordinary file; save it as one")
        with open(path, "rb") as file:
            source = file.read(most_bytes + 1)
    except OSError as error:
        raise ValueError(f"plant file {path} cannot be read: {error}; give another file") from None
    if len(source) > most_bytes:
        raise ValueError(f"plant file {path} has over {most_bytes} bytes; is it another file?")
    return dict(_plants_of(PlantFile(str(path), source)))


def file_of_plant(plant: type[Plant]) -> PlantFile | None:
    """The file that a class of plants was loaded from by `load_plant_file`, if it was."""
    return _file_of.get(plant)


class WithPlantFiles:
    """A function that goes to another process together with the user's files that are loaded here.

    What they define beside plants, such as a search, is known there by its name as well.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function

    def __call__(self, *arguments: Any) -> Any:
        """Call the function."""
        return self._function(*arguments)

    def __reduce__(self) -> tuple[object, ...]:
        files = _Loaded(file for _, file in _module_of.values())
        return _second, (files, self._function)  # in this order, as they were loaded here


class _Loaded(tuple[PlantFile, ...]):
    """Files that are run where they arrive."""

    __slots__ = ()

    def __reduce__(self) -> tuple[object, ...]:
        return _load_all, (tuple(self),)


def _load_all(files: Iterable[PlantFile]) -> _Loaded:
    for file in files:
        _plants_of(file)
    return _Loaded(files)


def _second(files: _Loaded, function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, once the files are loaded."""
    del files
    return function


def _plants_of(file: PlantFile) -> Mapping[str, type[Plant]]:
    """The plants of a file by name, from now on known everywhere."""
    if file.source not in _module_of:
        before = dict(Plant._known)
        try:
            _module_of[file.source] = _run(file), file
        except BaseException:
            Plant._known = before
            raise
    module, _ = _module_of[file.source]
    plants = {kind.name: kind for kind in _classes_of(module) if issubclass(kind, Plant)}
    for plant in plants.values():
        copyreg.pickle(plant, _to_other_process)  # which could not import it by name
        _file_of[plant] = file  # by the name that it was given last
    for kind in _classes_of(module):
        if not issubclass(kind, Plant):
            copyreg.pickle(kind, partial(_value_to_other_process, file))
    Plant._known.update(plants)
    return plants


def _classes_of(module: ModuleType) -> Iterator[type[Any]]:
    """Return the complete classes that a file defines, such as plants, profiles and energies."""
    for kind in vars(module).values():
        defined_there = isinstance(kind, type) and kind.__module__ == module.__name__
        if defined_there and not (issubclass(kind, Plant) and _is_incomplete(kind)):
            yield kind


def _has_only_unfinished(module: ModuleType) -> bool:
    """Return whether a file defines plants of which none is complete."""
    kinds = [kind for kind in vars(module).values() if isinstance(kind, type)]
    plants = [
        kind for kind in kinds if issubclass(kind, Plant) and kind.__module__ == module.__name__
    ]
    return bool(plants) and all(map(_is_incomplete, plants))


def _is_incomplete(plant: type[Plant]) -> bool:
    """Return whether a plant is only a base of others."""
    return isabstract(plant) or not isinstance(vars(plant).get("name"), str)


def _run(file: PlantFile) -> ModuleType:
    """The module of a file; ValueError with the line where it fails, or where it has nothing."""
    module = ModuleType(f"plant file {file.path}, {file.digest}")
    added_before = len(_added)
    sys.modules[module.__name__] = module  # dataclasses look their annotations up there
    module.__file__ = file.path
    sys.path.append(folder := str(Path(file.path).resolve().parent))  # it may import its neighbour
    try:
        code = compile(file.source, file.path, "exec", dont_inherit=True)
        exec(code, vars(module))
    except (Exception, SystemExit) as error:
        del sys.modules[module.__name__]
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == file.path]
        line = (lines or [getattr(error, "lineno", None)])[-1]  # of a SyntaxError
        remedy = (
            ""
            if isinstance(error, SystemExit)
            else ("; mend it: what it imports stands beside it or is installed")
        )
        raise ValueError(
            f"plant file {file.path}{f', line {line}' if line else ''}: {words_of_error(error)}"
            f"{remedy}"
        ) from None
    finally:
        sys.path.remove(folder)
    ours = f"{__name__.partition('.')[0]}."
    kinds = list(_classes_of(module))
    bases = {base.__module__ for kind in kinds for base in kind.__mro__[1:]}
    has_own = len(_added) > added_before or any(base.startswith(ours) for base in bases)
    if not has_own or _has_only_unfinished(module):
        raise ValueError(
            f"plant file {file.path} defines no plant; write a class of models.Plant in it, with a "
            f"name, modes, {', '.join(sorted(Plant.__abstractmethods__))}"
        )
    return module


def _to_other_process(plant: Plant) -> tuple[Callable[..., Plant], tuple[object, ...]]:
    entries = {**plant.parameters, "drive": plant.drive}
    return _from_other_process, (_file_of[type(plant)], plant.name, entries)


def _from_other_process(file: PlantFile, name: str, entries: Mapping[str, Any]) -> Plant:
    return _plants_of(file)[name](**entries)


def _value_to_other_process(
    file: PlantFile, value: object
) -> tuple[Callable[..., object], tuple[object, ...]]:
    return _value_from_other_process, (file, type(value).__name__, vars(value))


def _value_from_other_process(file: PlantFile, kind: str, entries: Mapping[str, object]) -> object:
    _plants_of(file)
    value_class = vars(_module_of[file.source][0])[kind]
    value = object.__new__(value_class)
    vars(value).update(entries)
    return value
