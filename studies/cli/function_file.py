"""A user's own function, from a Python file that is run: --function FILE.py:NAME."""

from __future__ import annotations

import importlib.util
import inspect
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quietarm.ocp.checks import clipped, listed, nearest, quoted, words_of_error


@dataclass(frozen=True)
class FunctionOfFile:
    """Place of a function: its file, which is run, and its name there.

    A worker gets these words and runs the file itself.
    """

    path: str
    name: str

    @classmethod
    def read(cls, text: str) -> FunctionOfFile:
        """Read FILE.py:NAME; ValueError where it is not written so, or the file is missing."""
        path, colon, name = text.rpartition(":")
        if not colon or not path.endswith(".py") or not name.isidentifier():
            raise ValueError(
                f"{quoted(text)} names no function; give the file and the name, as "
                "simulator.py:measure"
            )
        if not Path(path).is_file():
            raise ValueError(f"{path} is no file; give a Python file that has {name}")
        return cls(path, name)

    def load(self) -> Callable[..., Any]:
        """Run the file and return the function; ValueError says in one line what is wrong."""
        module = self._run()
        own = {
            name: value
            for name, value in vars(module).items()
            if callable(value) and getattr(value, "__module__", None) == module.__name__
        }
        function = vars(module).get(self.name)
        if function is None:
            names = listed(own) or "no function"
            hint = nearest(self.name, own)
            raise ValueError(
                f"{self.path} has no {self.name}; give one of what it defines: {names}{hint}"
            )
        if inspect.isclass(function):
            raise ValueError(
                f"{self.name} of {self.path} is a class; give the name of an object of it, or of a "
                "function"
            )
        if not callable(function):
            raise ValueError(
                f"{self.name} of {self.path} is {quoted(function)}; give the name of a function"
            )
        return function

    def _run(self) -> Any:
        spec = importlib.util.spec_from_file_location(Path(self.path).stem, self.path)
        if spec is None or spec.loader is None:
            raise ValueError(f"{self.path} is no Python file; give one")
        module = importlib.util.module_from_spec(spec)
        here = Path(self.path).resolve()
        with _importing_beside(Path(self.path)):
            try:
                spec.loader.exec_module(module)
            except (Exception, SystemExit) as error:
                frames = traceback.extract_tb(error.__traceback__)
                lines = [frame.lineno for frame in frames if Path(frame.filename).resolve() == here]
                line = getattr(error, "lineno", None) or (lines[-1] if lines else None)
                place = f", line {line}" if line else ""
                raise ValueError(
                    f"{self.path}{place} fails: {clipped(words_of_error(error), 200)}; mend it"
                ) from None
        return module


@contextmanager
def _importing_beside(path: Path) -> Iterator[None]:
    """Let a file import what stands beside it, also when it does so later, in a function."""
    folder = str(path.resolve().parent)
    if folder not in sys.path:
        sys.path.append(folder)
    yield
