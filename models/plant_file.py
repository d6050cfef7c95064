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

from quietarm.interrupts import interruptible
from quietarm.models.checks import words_of_error
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


@interruptible
def load_plant_file(path: str | Path) -> Mapping[str, type[Plant]]:
    """Run a Python file that you trust, and make its plants known by name.

    Profiles and energies that stand beside them are known as well.

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
        When it cannot be read or imported, or defines no plant that is complete.
    """
    if not isinstance(path, str | Path):
        raise TypeError(f"path is {path!r}; give the name of a Python file, as 'plants.py'")
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

    def __init__(self, function: Callable[..., object], files: Iterable[PlantFile] = ()) -> None:
        self._function = function
        self._files = tuple(files) or tuple(
            {file.digest: file for file in _file_of.values()}.values()
        )

    def __call__(self, *arguments: object) -> object:
        """What the function gives."""
        return self._function(*arguments)

    def __reduce__(self) -> tuple[object, ...]:
        return _function_with_files, (self._function, self._files)


def _function_with_files(
    function: Callable[..., object], files: Iterable[PlantFile]
) -> Callable[..., object]:
    """The function, once the files are loaded here."""
    for file in files:
        _plants_of(file)
    return function


def _plants_of(file: PlantFile) -> Mapping[str, type[Plant]]:
    """The plants of a file by name, from now on known everywhere."""
    plants = {plant.name: plant for plant, of in _file_of.items() if of.source == file.source}
    if not plants:
        known = dict(Plant._known)
        try:
            plants = _run(file)
        except BaseException:
            Plant._known = known
            raise
    for plant in plants.values():
        copyreg.pickle(plant, _to_other_process)  # which could not import it by name
        _file_of[plant] = file  # by the name that it was given last
    for kind in _classes_beside(plants):
        copyreg.pickle(kind, partial(_value_to_other_process, file))
    Plant._known.update(plants)
    return plants


def _classes_beside(plants: Mapping[str, type[Plant]]) -> Iterator[type[object]]:
    """What else the file of these plants defines, as profiles and energies."""
    module = _module_of(plants)
    for kind in vars(module).values():
        defined_there = isinstance(kind, type) and kind.__module__ == module.__name__
        if defined_there and not issubclass(kind, Plant):
            yield kind


def _module_of(plants: Mapping[str, type[Plant]]) -> ModuleType:
    """The module of the file that these plants are of."""
    return sys.modules[next(iter(plants.values())).__module__]


def _run(file: PlantFile) -> dict[str, type[Plant]]:
    """The plants that the module of a file defines; ValueError with the line where it fails."""
    module = ModuleType(f"plant file {file.path}, {file.digest}")
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
    plants = {
        name: plant
        for name, plant in Plant._known.items()
        if plant.__module__ == module.__name__ and not isabstract(plant)
    }
    if not plants:
        raise ValueError(
            f"plant file {file.path} defines no plant; write a class of models.Plant in it, with a "
            f"name, modes, {', '.join(sorted(Plant.__abstractmethods__))}"
        )
    return plants


def _to_other_process(plant: Plant) -> tuple[Callable[..., Plant], tuple[object, ...]]:
    return _from_other_process, (_file_of[type(plant)], plant.name, plant.parameters)


def _from_other_process(file: PlantFile, name: str, parameters: Mapping[str, float]) -> Plant:
    return _plants_of(file)[name](**parameters)


def _value_to_other_process(
    file: PlantFile, value: object
) -> tuple[Callable[..., object], tuple[object, ...]]:
    return _value_from_other_process, (file, type(value).__name__, vars(value))


def _value_from_other_process(file: PlantFile, kind: str, entries: Mapping[str, object]) -> object:
    value_class = vars(_module_of(_plants_of(file)))[kind]
    value = object.__new__(value_class)
    vars(value).update(entries)
    return value
