"""What an option may be: quantities with units, names, files."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import click
from quietarm.models import load_plant_file
from quietarm.ocp.checks import unknown
from quietarm.ocp.files import check_writable
from quietarm.studies.cli.folders import check_folder
from quietarm.studies.cli.plants import parse_error, parse_plant, parse_setting
from quietarm.studies.cli.quantities import (
    parse_coefficients,
    parse_duration,
    parse_energy,
    parse_joint_angle,
    parse_length,
    parse_residual,
    parse_share,
    parse_state,
    parse_torque,
    parse_weights,
    parse_whole,
)
from quietarm.studies.display.pictures import check_figure
from quietarm.studies.display.saving import STDOUT


class Parsed(click.ParamType):
    """A value read by a function that raises ValueError with a message for the user."""

    def __init__(self, name: str, parse: Callable[[str], Any], example: str = "") -> None:
        self.name, self.parse, self._example = name, parse, example

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read the text; a click error names the option."""
        if not isinstance(value, str):
            return value
        try:
            return self.parse(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)

    def get_missing_message(
        self, param: click.Parameter, ctx: click.Context | None = None
    ) -> str | None:
        """How the option is given."""
        return f"Give it as {param.opts[0]} {self._example}" if self._example else None


class Named(click.Choice):  # pyright: ignore[reportMissingTypeArgument]
    """One of several names; an error suggests the nearest one, or says why a name is none here."""

    def __init__(self, what: str, names: Iterable[str], none: Mapping[str, str] | None = None):
        super().__init__(list(names))
        self._what, self._none = what, none or {}

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The name."""
        if value not in self.choices:
            known = unknown(self._what, value, self.choices)
            self.fail(self._none.get(value, known), param, ctx)
        return value


class FileName(Parsed):
    """A file or folder; no two arguments of a line name the same one, unless both are read."""

    def __init__(self, name: str, check: Callable[[str], Path], use: str) -> None:
        super().__init__(name, check)
        self._use = use

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path."""
        path = super().convert(value, param, ctx)
        if ctx is None or param is None:
            return path
        is_option = isinstance(param, click.Option)
        name = param.opts[0] if is_option else param.human_readable_name
        place = os.path.realpath(path)  # of a link, too
        named: list[tuple[str, str, str]] = ctx.meta.setdefault("quietarm.files", [])
        for other, there, use in named:
            if there == place and {use, self._use} not in _MAY_BE_ONE:
                self.fail(f"{other} and {name} are both {path}; give two files", None, ctx)
        named.append((name, place, self._use))
        return path


READ, KEPT, WRITTEN = "read", "kept", "written"
_MAY_BE_ONE = ({READ}, {READ, KEPT})
"""A checkpoint may be kept where the one that it continues was read."""


def _is_input(text: str) -> Path:
    if not text:
        raise ValueError("the name is empty; give one")
    return Path(text)


def _is_output(text: str) -> Path:
    return STDOUT if text == str(STDOUT) else check_writable(text)


def _ends_in(endings: tuple[str, ...], what: str, text: str) -> Path:
    path = _is_output(text)
    if path is not STDOUT and path.suffix.lower() not in endings:
        raise ValueError(f"{text} is for {what}; end its name in {endings[0]}")
    return path


def _in_place(check: Callable[[str], Path], text: str) -> Path:
    if text == str(STDOUT):
        raise ValueError(f"this cannot go to standard output; give a name, or ./{text}")
    return check(text)


def _is_dataset(text: str) -> Path:
    if Path(text).suffix not in (".zarr", ""):
        raise ValueError(f"{text} becomes a folder of Zarr; end its name in .zarr")
    return check_folder(text)


PLANT = Parsed("plant", parse_plant)
PLANT_FILE = Parsed("file", load_plant_file)
SETTING = Parsed("parameter=value", partial(parse_setting, what="a parameter", example="omega=9"))
METHOD_SETTING = Parsed(
    "name=value", partial(parse_setting, what="a setting", example="mutation=1")
)
ERROR = Parsed("name=share", parse_error)
ENERGY = Parsed("energy", parse_energy)
ANGLE = Parsed("angle", parse_joint_angle, "30deg")
LENGTH = Parsed("length", parse_length)
RESIDUAL = Parsed("length", parse_residual)
TIME = Parsed("time", parse_duration, "0.8")
TORQUE = Parsed("torque", parse_torque)
SHARE = Parsed("share", parse_share)
MODES = Parsed("W:W'", parse_state)
WHOLE = Parsed("integer", parse_whole)
COEFFICIENTS = Parsed("numbers", parse_coefficients)
WEIGHTS = Parsed("weights", parse_weights)
INPUT = FileName("file", _is_input, READ)
OUTPUT = FileName("file", _is_output, WRITTEN)
STATE = FileName("file", partial(_in_place, check_writable), KEPT)
JSON_FILE = FileName("file", partial(_ends_in, (".json", ""), "JSON"), WRITTEN)
CSV_FILE = FileName("file", partial(_ends_in, (".csv", ".txt", ""), "a table as CSV"), WRITTEN)
PAGE = FileName("page", partial(_ends_in, (".html", ".htm"), "a page of HTML"), WRITTEN)
PICTURE = FileName("picture", check_figure, WRITTEN)
DATASET = FileName("folder", partial(_in_place, _is_dataset), WRITTEN)
FOLDER = FileName("folder", partial(_in_place, check_folder), WRITTEN)
