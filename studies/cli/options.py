"""The options that commands share, and how they were typed."""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Collection, Iterable, Mapping
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import click
from click.core import ParameterSource
from quietarm.models import Plant, load_plant_file
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.studies.cli.quantities import literal, once, parse_share_of_work
from quietarm.studies.cli.types import LENGTH, SETTING, Named, Parsed
from quietarm.studies.registry.profiles import FAMILIES, POLYNOMIAL
from quietarm.studies.report.progress import count, working
from quietarm.studies.report.saving import STDOUT
from rich.console import Console

F = TypeVar("F", bound=Callable[..., Any])
_PLANTS, _QUIET = "quietarm.plants", "quietarm.quiet"


def _keep(name: str) -> Callable[[click.Context, click.Parameter, Any], None]:
    def keep(context: click.Context, _: click.Parameter, value: Any) -> None:
        context.meta[name] = value

    return keep


COMMON: list[click.Parameter] = [
    click.Option(
        ["--plant-file"], type=Parsed("file", load_plant_file), is_eager=True,
        expose_value=False, hidden=True, callback=_keep(_PLANTS),
        # eager: the plants in it are then known by name
    ),
    click.Option(
        ["--quiet"], is_flag=True, expose_value=False, hidden=True, callback=_keep(_QUIET)
    ),
]  # fmt: skip
COMMON_HELP = (
    "Every command takes --plant-file FILE for a plant of your own (a file in Python, which is "
    "run), --quiet for no progress, and --help."
)


def _refuse_same_file(values: Iterable[object]) -> None:
    """Refuse a line that names one file twice, so that nothing that is read is written over."""
    every = [one for value in values for one in (value if isinstance(value, tuple) else (value,))]
    known = set[str]()
    for path in every:
        if isinstance(path, Path) and path != STDOUT:
            place = os.path.realpath(path)  # of a link, too
            if place in known:
                raise ValueError(f"{path} is given twice; give it once, or another name")
            known.add(place)


class Command(click.Command):
    """A command with the options that all have."""

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Its own options and those of all commands."""
        return [*COMMON, *super().get_params(ctx)]

    def invoke(self, ctx: click.Context) -> Any:
        """Run it, unless one file is named twice."""
        _refuse_same_file(ctx.params.values())
        return super().invoke(ctx)

    def get_help_option(self, ctx: click.Context) -> click.Option | None:
        """--help, which is not repeated in every list."""
        option = super().get_help_option(ctx)
        if option is not None:
            option.hidden = True
        return option

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Say which options all commands have."""
        formatter.write_paragraph()
        formatter.write_text(COMMON_HELP)


command = partial(click.command, cls=Command)
"""The decorator of every command."""


def plant_file() -> Mapping[str, type[Plant]] | None:
    """The plants of the file that --plant-file names, by their names."""
    return click.get_current_context().meta.get(_PLANTS)


def quiet() -> bool:
    """Whether no progress is shown."""
    return bool(click.get_current_context().meta.get(_QUIET))


def busy(what: str) -> AbstractContextManager[None]:
    """Show that work goes on."""
    return working(what, Console(stderr=True), quiet=quiet())


def counting(total: int, what: str) -> AbstractContextManager[Callable[[int, int], None]]:
    """Show how many of many small pieces are done."""
    return count(total, what, Console(stderr=True), quiet=quiet())


option = partial(click.option, show_default=True)
"""The decorator of every option, whose help ends with its default."""


def options(*several: Callable[[F], F]) -> Callable[[F], F]:
    """Several options as one decorator."""

    def add(command: F) -> F:
        for option in reversed(several):
            command = option(command)
        return command

    return add


def typed(option: str) -> bool:
    """Whether the command's option of this name was typed."""
    source = click.get_current_context().get_parameter_source(option)
    return source is ParameterSource.COMMANDLINE


def typed_line() -> str:
    """The whole line that was typed."""
    return shlex.join(["quietarm", *click.get_current_context().obj])


def refuse_typed(names: Collection[str], why: str) -> None:
    """Refuse options that were typed where they have no meaning."""
    for one in click.get_current_context().command.params:
        if one.name in names and typed(one.name):
            name = one.opts[0] if isinstance(one, click.Option) else one.name.upper()
            raise ValueError(f"{name} {why}")


_CYCLOIDS = (
    "How the joint moves: a cycloid of a polynomial, of Gaussians, of a neural network or of a "
    "spline"
)
_OF_SHAPERS = (
    "{0} is an input shaper: it has one motion for a move, and therefore no front; give one of "
    f"{', '.join(FAMILIES)}, or quietarm plan"
)


def profile_options(*others: str, words: str = "") -> Callable[[F], F]:
    """--profile and --terms; `others` are profiles without coefficients."""
    none = {} if others else {name: _OF_SHAPERS.format(name) for name in SHAPERS}
    sizes = ", ".join(f"{family().terms} for {name}" for name, family in FAMILIES.items())
    named = Named("profile", [*FAMILIES, *others], none)
    return options(
        option("--profile", type=named, default=POLYNOMIAL, help=f"{_CYCLOIDS}{words}."),
        option("--terms", type=int, help="Terms of the polynomial, Gaussians, hidden nodes or "
               f"control points. [default: {sizes}]"),
    )  # fmt: skip


bound_option = option(
    "--bound", type=float,
    help="Largest size of a coefficient. [default: none; a search of polynomials needs one]",
)  # fmt: skip
residual_limit_option = option(
    "--residual-limit", type=LENGTH,
    help="Largest tip displacement after arrival. [default: at rest; with --error 5 % of the "
    "plain cycloid's largest deflection, or less]",
)  # fmt: skip
seed_option = option("--seed", default=0, help="Seed of the random numbers; the first of several.")
starts_option = option("--starts", default=4, help="Starts of the solver.")
solver_option = option(
    "--solver", type=Named("solver", SOLVERS), default=SOLVERS[0],
    help="Sequential quadratic programs (quietarm's own, fast), or IPOPT.",
)  # fmt: skip
sensitivities_option = option(
    "--sensitivities", is_flag=True,
    help="List by how much residual and energy change with each parameter of the plant.",
)  # fmt: skip
setting_option = option(
    "--setting", type=SETTING, multiple=True, metavar="NAME=VALUE",
    help="Set another setting of a method, as crossover=0.7, in a bench nsga2.crossover=0.7; may "
    "be repeated. quietarm list METHOD has them.",
)  # fmt: skip
workers_option = option(
    "--workers", type=int, default=1, help="Processes of this machine that share the work."
)
scheduler_option = option(
    "--scheduler", metavar="ADDRESS",
    help="Let the workers of this dask scheduler share the work, as in tcp://host:8786.",
)  # fmt: skip
part_option = option(
    "--part", type=Parsed("i/n", parse_share_of_work), default="1/1",
    help="Do every n-th piece of the work alone, as 2/8 in a queue's array job.",
)  # fmt: skip


def settings_given(pairs: Iterable[tuple[str, str]]) -> dict[str, float | int | bool | str]:
    """Settings as they were typed."""
    return {name: literal(text) for name, text in once(pairs, "setting ").items()}


def settings_by_method(
    pairs: Iterable[tuple[str, str]], methods: Collection[str]
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
