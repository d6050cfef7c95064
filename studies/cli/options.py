"""The command line's types and the options that its commands share."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import click
from quietarm.models import Plant, load_plant_file
from quietarm.ocp.base.files import check_folder, check_writable
from quietarm.ocp.base.names import unknown
from quietarm.ocp.profiles.shapers import SHAPERS
from quietarm.ocp.program.solving import SOLVERS
from quietarm.ocp.task.quantities import QUANTITIES, Quantity
from quietarm.studies.cli.plants import parse_error, parse_plant, parse_setting
from quietarm.studies.cli.quantities import (
    is_number,
    literal,
    parse_angle,
    parse_coefficients,
    parse_length,
    parse_number,
    parse_rate,
    parse_share,
    parse_time,
    parse_weights,
    parse_whole,
)
from quietarm.studies.display.pictures import check_figure
from quietarm.studies.display.saving import STDOUT
from quietarm.studies.registry.profiles import FAMILIES, POLYNOMIAL, PROFILES

_BARE = "quietarm.bare_angles"
F = TypeVar("F", bound=Callable[..., Any])


class Parsed(click.ParamType):
    """A value read by a function that raises ValueError with a message for the user."""

    def __init__(self, name: str, parse: Callable[[str], Any]) -> None:
        self.name, self.parse = name, parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read the text; a click error names the option."""
        if not isinstance(value, str):
            return value
        try:
            return self.parse(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)


class _Angle(Parsed):
    """An angle; `bare_angles` tells which were typed as a number alone."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read the text, and note where it has no unit."""
        if isinstance(value, str) and is_number(value) and param and ctx:
            ctx.meta.setdefault(_BARE, {})[param.name] = value.strip()
        return super().convert(value, param, ctx)


class Named(click.Choice):  # pyright: ignore[reportMissingTypeArgument]
    """One of several names; an error suggests the nearest one, or says why a name is none here."""

    def __init__(self, what: str, names: Iterable[str], none: Mapping[str, str] | None = None):
        super().__init__(list(names))
        self._what, self._none = what, none or {}

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The name."""
        if value in self._none:
            self.fail(self._none[value], param, ctx)
        if isinstance(value, str) and value not in self.choices:
            self.fail(unknown(self._what, value, self.choices), param, ctx)
        return super().convert(value, param, ctx)


def bare_angles(context: click.Context) -> dict[str, str]:
    """The angles that were typed without a unit, by the name of their option."""
    return context.meta.get(_BARE, {})


def _is_file(text: str) -> Path:
    if text == str(STDOUT):
        raise ValueError(f"this is for a file, not for standard output; give its name, or ./{text}")
    return check_writable(_named(text))


def _is_output(text: str) -> Path:
    if text == str(STDOUT):
        return STDOUT
    return check_writable(_named(text))


def _is_page(text: str) -> Path:
    path = _is_output(text)
    if path is not STDOUT and path.suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"{text} is for a page of HTML; end its name in .html")
    return path


def _is_picture(text: str) -> Path:
    return check_figure(_named(text))


def _named(text: str) -> str:
    if not text:
        raise ValueError("the name is empty; give one")
    return text


def _is_folder(text: str) -> Path:
    if text == str(STDOUT):
        raise ValueError(f"this is for a folder, not for standard output; give ./{text} or another")
    return check_folder(_named(text))


def _is_input(text: str) -> Path:
    return Path(_named(text))


def _is_plant_file(text: str) -> Mapping[str, type[Plant]]:
    return load_plant_file(_named(text))


PLANT = Parsed("plant", parse_plant)
SETTING = Parsed("parameter=value", partial(parse_setting, what="a parameter", example="omega=9"))
METHOD_SETTING = Parsed(
    "name=value", partial(parse_setting, what="a setting", example="mutation=1")
)
ERROR = Parsed("name=share", parse_error)
ANGLE = _Angle("angle", parse_angle)
LENGTH = Parsed("length", parse_length)
TIME = Parsed("time", parse_time)
SHARE = Parsed("share", parse_share)
WHOLE = Parsed("integer", parse_whole)
NUMBER = Parsed("float", parse_number)
COEFFICIENTS = Parsed("numbers", parse_coefficients)
WEIGHTS = Parsed("weights", parse_weights)
INPUT = Parsed("file", _is_input)
PLANT_FILE = Parsed("file", _is_plant_file)
OUTPUT = Parsed("file", _is_output)
STATE = Parsed("file", _is_file)
PAGE = Parsed("page", _is_page)
PICTURE = Parsed("picture", _is_picture)
FOLDER = Parsed("folder", _is_folder)

_DEFAULT_TERMS = ", ".join(f"{family().terms} for {name}" for name, family in FAMILIES.items())
_OF_CYCLOIDS = (
    "How the joint moves: the cycloid of a polynomial, of Gaussians, of a neural network or of a "
    "quintic spline"
)
profile_option = click.option(
    "--profile", type=Named("profile", PROFILES), default=POLYNOMIAL, show_default=True,
    help=f"{_OF_CYCLOIDS}; or the plain cycloid through an input shaper for the plant's "
    "frequencies at the target.",
)  # fmt: skip
_OF_SHAPERS = {
    name: f"{name} is an input shaper: it has one motion for a move, and therefore no front; give "
    f"one of {', '.join(FAMILIES)}, or quietarm plan"
    for name in SHAPERS
}
family_option = click.option(
    "--profile", type=Named("profile", FAMILIES, _OF_SHAPERS), default=POLYNOMIAL,
    show_default=True,
    help=f"{_OF_CYCLOIDS}.",
)  # fmt: skip
terms_option = click.option(
    "--terms", type=WHOLE,
    help="Size of the profile: terms of the polynomial, Gaussians, hidden nodes, or control "
    f"points. [default: {_DEFAULT_TERMS}]",
)  # fmt: skip


def _limit_option(quantity: Quantity) -> Callable[[F], F]:
    option, words = f"--{quantity.name}-limit", f"Largest {quantity.label} on the way"
    if quantity.unit == "m":
        return click.option(option, type=LENGTH, help=f"{words}.")
    if quantity.derivative is not None:
        parse = partial(parse_rate, order=quantity.derivative)
        help_text = f"{words} [{quantity.unit}], or as 60deg."
        return click.option(option, type=Parsed(quantity.name, parse), help=help_text)
    return click.option(option, type=NUMBER, help=f"{words} [{quantity.unit}].")


def method_settings_option(example: str) -> Callable[[F], F]:
    """The option for what else a metaheuristic is set to."""
    return click.option(
        "--setting", type=METHOD_SETTING, multiple=True,
        help=f"Metaheuristic: set one of its settings, {example}; may be repeated. "
        "docs/methods.md lists them.",
    )  # fmt: skip


def settings_of_one(pairs: Iterable[tuple[str, str]]) -> dict[str, float | int | bool | str]:
    """Settings of the only method that runs; ValueError where one is an option of its own."""
    given = settings_given(pairs)
    for name in given:
        if name in ("population", "generations"):
            raise ValueError(
                f"{name} is no setting but an option of quietarm front: give it there, as --{name} "
                f"{given[name]}"
            )
    return given


def settings_given(pairs: Iterable[tuple[str, str]]) -> dict[str, float | int | bool | str]:
    """Settings as they were typed; ValueError where one is given twice."""
    given: dict[str, float | int | bool | str] = {}
    for name, text in pairs:
        if name in given:
            raise ValueError(f"setting {name} is given twice; give it once")
        given[name] = literal(text)
    return given


def settings_by_method(
    pairs: Iterable[tuple[str, str]], methods: Sequence[str]
) -> dict[str, dict[str, float | int | bool | str]]:
    """Settings of several methods, each typed as ``method.name=value``, by method."""
    found: dict[str, dict[str, float | int | bool | str]] = {}
    for name, value in settings_given(pairs).items():
        method, dot, own = name.partition(".")
        if not dot or method not in methods:
            raise ValueError(
                f"setting {name} names no method that runs; begin it with one of these and a dot: "
                f"{', '.join(methods)}"
            )
        found.setdefault(method, {})[own] = value
    return found


plant_file_option = partial(
    click.option, "--plant-file", type=PLANT_FILE,
    is_eager=True,  # the plants in it are then known by name
    help="A plant of your own: a file in Python, which is run.",
)  # fmt: skip


_TASK_OPTIONS = (
    click.argument("plant", type=PLANT, required=False, metavar="PLANT"),
    plant_file_option(),
    click.option("--set", type=SETTING, multiple=True,
                 help="Set a parameter of the plant, as omega=9 (SI units); may be repeated."),
    click.option("--start", type=ANGLE, default=0.0, show_default=True,
                 help="Joint angle at the start."),
    click.option("--target", type=ANGLE, required=True, help="Joint angle at the end."),
    click.option("--duration", type=TIME, required=True, help="Travelling time."),
    *map(_limit_option, QUANTITIES.values()),
    click.option("--residual-window", type=TIME, default=1.0, show_default=True,
                 help="Time after arrival in which the residual is measured."),
)  # fmt: skip
_OUTPUT_OPTIONS = (
    click.option("--output", type=OUTPUT,
                 help="Write the plan to this JSON file; - is standard output."),
    click.option("--csv", "csv_file", type=OUTPUT, help="Write the move to this CSV file."),
    click.option("--sample-rate", type=NUMBER, default=1000.0, show_default=True,
                 help="Rows per second of the CSV file [Hz]."),
    click.option("--figure", type=PICTURE,
                 help="Draw the move over the plain cycloid (.png, .pdf or .svg)."),
)  # fmt: skip
_SHARE = "Processes of this machine that share the work; 1 stays in this one."
_WORKERS = click.option("--workers", type=WHOLE, default=1, show_default=True, help=_SHARE)
_WORKERS_AT_HAND = click.option(
    "--workers",
    type=WHOLE,
    help=f"{_SHARE} By default one for each core, up to 4, if dask is here.",
)
_SCHEDULER = click.option(
    "--scheduler", metavar="ADDRESS",
    help="Let the workers of this dask scheduler share the work, as in tcp://host:8786.",
)  # fmt: skip


robust_option = click.option(
    "--robust", type=ERROR, multiple=True, metavar="NAME=SHARE",
    help="Count as the residual the largest one while the frequency, the damping or a parameter of "
    "the plant is wrong by up to this, as frequency=10%; may be repeated.",
)  # fmt: skip
solver_option = click.option(
    "--solver", type=Named("solver", SOLVERS), default=SOLVERS[0], show_default=True,
    help="The gradient's: sequential quadratic programs, all starts and points at once, or IPOPT, "
    "one after another.",
)  # fmt: skip
quiet_option = click.option("--quiet", is_flag=True, help="Show no progress.")


def task_options(command: F) -> F:
    """Add the plant and the options that describe a task."""
    return _with(_TASK_OPTIONS, command)


def output_options(command: F) -> F:
    """Add the options for what to write."""
    return _with(_OUTPUT_OPTIONS, command)


def workers_options(command: F) -> F:
    """Add the options for where the work is done."""
    return _with((_WORKERS, _SCHEDULER), command)


def workers_at_hand_options(command: F) -> F:
    """The same for long work, which takes the cores at hand by default."""
    return _with((_WORKERS_AT_HAND, _SCHEDULER), command)


def _with(options: tuple[Callable[[F], F], ...], command: F) -> F:
    for option in reversed(options):
        command = option(command)
    return command
