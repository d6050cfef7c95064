"""The options that several commands share, and how they were typed."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, TypeVar

import click
from click.core import ParameterSource
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.studies.cli.quantities import literal, once
from quietarm.studies.cli.types import METHOD_SETTING, OUTPUT, WHOLE, Named, Parsed
from quietarm.studies.registry.profiles import FAMILIES, POLYNOMIAL, PROFILES
from rich.console import Console

F = TypeVar("F", bound=Callable[..., Any])


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
            raise ValueError(f"{one.opts[0]} {why}")


def refuse_idle(method: str, only_for: Mapping[str, Sequence[str]], called: str = "") -> None:
    """Refuse an option that would have no effect; ValueError says what it is for."""
    for name, methods in only_for.items():
        if typed(name) and method not in methods:
            *some, last = methods
            known = called or (f"{', '.join(some)} and {last}" if some else last)
            raise ValueError(f"--{name} is for {known}, not for {method}; leave it out")


sensitivities_option = click.option(
    "--sensitivities", "sensitive", is_flag=True,
    help="Say what residual and energy change with each parameter of the plant.",
)  # fmt: skip
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
    """Settings as they were typed."""
    return {name: literal(text) for name, text in once(pairs, "setting ").items()}


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


_SHARE = "Processes of this machine that share the work; 1 stays in this one."
_SCHEDULER = click.option(
    "--scheduler", metavar="ADDRESS",
    help="Let the workers of this dask scheduler share the work, as in tcp://host:8786.",
)  # fmt: skip
workers_options = options(
    click.option("--workers", type=WHOLE, default=1, show_default=True, help=_SHARE), _SCHEDULER
)
_AT_HAND = f"{_SHARE} By default one for each core, up to 4."
workers_at_hand_options = options(click.option("--workers", type=WHOLE, help=_AT_HAND), _SCHEDULER)


def warn_of_workers(console: Console, workers: int, pieces: int) -> None:
    """Warn where more workers start than there are cores; no more start than pieces of work."""
    # a plan by the gradient needs no workers
    from joblib import cpu_count

    cores, workers = cpu_count(), min(workers, pieces)
    if workers > cores:
        words = f"{workers} workers will share {cores} core{'s' * (cores > 1)}"
        console.print(words, highlight=False)


def _part(text: str) -> tuple[int, int]:
    number, slash, of = text.partition("/")
    if not (slash and number.isdigit() and of.isdigit() and 1 <= int(number) <= int(of)):
        raise ValueError(f"{text!r} is no part; give the second of eight as 2/8")
    return int(number), int(of)


latex_option = click.option(
    "--latex", type=OUTPUT, help="Write the tables as LaTeX, with the rules of booktabs."
)


def part_option(pieces: str) -> Callable[[F], F]:
    """The option for a share of the work, as in a queue's array job."""
    return click.option(
        "--part", type=Parsed("i/n", _part), default="1/1",
        help=f"Do every n-th {pieces} alone, as 2/8 in a queue's array job.",
    )  # fmt: skip


solver_option = click.option(
    "--solver", type=Named("solver", SOLVERS), default=SOLVERS[0], show_default=True,
    help="The gradient's: sequential quadratic programs, all starts and points at once, or IPOPT, "
    "one after another.",
)  # fmt: skip
quiet_option = click.option("--quiet", is_flag=True, help="Show no progress.")
