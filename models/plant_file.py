"""Plants of a user's own file, which is run only when the user names it."""

from __future__ import annotations

import copyreg
import hashlib
import inspect
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

from quietarm.models.plant import Plant


@dataclass(frozen=True)
class PlantFile:
    """A file that defines plants.

    Attributes
    ----------
    path : str
        Its name, as it was given.
    source : bytes
        Its content.
    """

    path: str
    source: bytes = field(repr=False)

    @property
    def digest(self) -> str:
        """SHA-256 of the content, in hexadecimal digits."""
        return hashlib.sha256(self.source).hexdigest()


_by_digest: dict[str, dict[str, type[Plant]]] = {}
_file_of: dict[type[Plant], PlantFile] = {}


def load_plant_file(path: str | Path) -> Mapping[str, type[Plant]]:
    """Import a file as a module, and make its plants known by name.

    The file is run: name only one that you trust. Its content is one file: what it imports must be
    installed.

    Parameters
    ----------
    path : str or Path
        The file, in Python.

    Returns
    -------
    mapping of str to type
        Its plants by name. The same content gives the same classes every time.

    Raises
    ------
    ValueError
        When it cannot be read or imported, or defines no plant that is complete.
    """
    return dict(_loaded(PlantFile(str(path), _read(Path(path)))))


def file_of_plant(plant: type[Plant]) -> PlantFile | None:
    """The file that a class of plants was loaded from by `load_plant_file`, if it was."""
    return _file_of.get(plant)


def _read(path: Path) -> bytes:
    if path.suffix != ".py":  # a data file may be valid Python, and is not run by mistake
        raise ValueError(
            f"plant file {path} is not called .py; give a Python file, such as crane.py"
        )
    try:
        return path.read_bytes()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ValueError(f"plant file {path} cannot be read: {reason}; give another file") from None


def _loaded(file: PlantFile) -> Mapping[str, type[Plant]]:
    plants = _by_digest.get(file.digest)
    if plants is None:
        known = dict(Plant._known)
        try:
            plants = _plants_of(_run(file), file.path)
        except BaseException:
            Plant._known.clear()
            Plant._known.update(known)
            raise
        _by_digest[file.digest] = plants
        for plant in plants.values():
            copyreg.pickle(plant, _to_other_process)  # which could not import it by name
    _file_of.update(dict.fromkeys(plants.values(), file))  # the name that it was given last
    Plant._known.update(plants)
    return plants


def _run(file: PlantFile) -> ModuleType:
    """The module of a file; ValueError with the line where it cannot be imported."""
    module = ModuleType(f"plant file {file.path}")
    module.__file__ = file.path
    sys.modules[module.__name__] = module  # dataclasses look their annotations up there
    try:
        exec(compile(file.source, file.path, "exec", dont_inherit=True), vars(module))
    except Exception as error:
        del sys.modules[module.__name__]
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
                 if frame.filename == file.path]  # fmt: skip
        if isinstance(error, SyntaxError):
            lines = [error.lineno]
        place = f", line {lines[-1]}" if lines and lines[-1] else ""
        text = " ".join(f"{type(error).__name__}: {error}".split())
        raise ValueError(
            f"plant file {file.path}{place}: {text}; mend it: a plant is one file, and what it "
            "imports is installed"
        ) from None
    return module


def _plants_of(module: ModuleType, path: str) -> dict[str, type[Plant]]:
    """The plants that a module defines, by name."""
    defined: dict[str, type[Plant]] = {}
    unfinished = "write a class in it that is a models.Plant, with a name of its own"
    for entry in vars(module).values():
        own = isinstance(entry, type) and issubclass(entry, Plant)
        if not own or entry.__module__ != module.__name__:
            continue
        missing = sorted(entry.__abstractmethods__) if inspect.isabstract(entry) else []
        if not isinstance(entry.__dict__.get("name"), str):
            unfinished = (
                f"write name: ClassVar[str] = 'crane' or the like in class {entry.__name__}"
            )
        elif missing:
            unfinished = f"write {' and '.join(missing)} in class {entry.__name__}"
        else:
            defined[entry.name] = entry
    if not defined:
        raise ValueError(f"plant file {path} defines no plant; {unfinished}")
    return defined


def _to_other_process(plant: Plant) -> tuple[Callable[..., Plant], tuple[object, ...]]:
    return _from_other_process, (_file_of[type(plant)], plant.name, plant.parameters)


def _from_other_process(file: PlantFile, name: str, parameters: Mapping[str, float]) -> Plant:
    return _loaded(file)[name](**parameters)
