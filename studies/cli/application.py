"""The group of commands, each loaded when it is asked for, and the handling of errors."""

from __future__ import annotations

import os
import sys
import traceback
import warnings
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path

import click

from quietarm.interrupts import INTERRUPTED, exit_status_of
from quietarm.ocp import QuietarmError
from quietarm.ocp.checks import cut, unknown, words_of_error
from quietarm.ocp.escapes import one_line
from quietarm.studies.cli.interrupted import InterruptedCommandError

BAD_INPUT = 2
NOT_SOLVED = 1

COMMANDS = {
    "plan": "Find the move of least energy that arrives at rest.",
    "evaluate": "Evaluate coefficients, a path, or a table of results.",
    "front": "Find the trade-off of residual and energy by the gradient.",
    "search": "Find the trade-off with a metaheuristic.",
    "compare": "Compare fronts, or plans with shapers and under parameter errors.",
    "bench": "Run methods on problems from many seeds, and rank them.",
    "reproduce": "Recompute the paper.",
    "sweep": "Plan every move of a grid.",
    "identify": "Fit a plant's parameters to recordings of a machine.",
    "learn": "Plan the next move from a recording of the last one.",
    "export": "Write a plan for a controller, or as an animation.",
    "explore": "Change a move by hand, on a page in the browser.",
    "list": "List plants, problems or methods.",
}
"""What each command does. `NAME` is the function `NAME` of `commands.NAME_command`, and `list` is
`list_`."""


class LazyGroup(click.Group):
    """A group that knows only what its commands do, and loads one when it is asked for."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str, click.Command, list[str]]:
        """The name and the command that was asked for, and the other words."""
        name, *rest = args
        if name not in COMMANDS:
            raise ValueError(unknown("command", name, COMMANDS))
        return name, command_of(name), rest


def command_of(name: str) -> click.Command:
    """A command by its name."""
    function = "list_" if name == "list" else name
    return getattr(import_module(f"quietarm.studies.cli.commands.{name}_command"), function)


@click.group(
    cls=LazyGroup,
    commands=[click.Command(name, short_help=does) for name, does in COMMANDS.items()],
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    no_args_is_help=True,
)
@click.version_option(package_name="quietarm")
def quietarm() -> None:
    """Plan point-to-point moves of flexible robot arms that arrive at rest and take little energy.

    PLANT is single-link, arm-on-flexible-link, dual-link, flexible-beam or linear-axis, one of
    --plant-file, or the file of an identified machine. Angles are radians, or 30deg, pi/6, -pi/2;
    speeds rad/s, or 60deg/s; lengths metres, or 1mm; times seconds, or 800ms.

    Every command takes --plant-file FILE for a plant of your own (a file in Python, which is run),
    --quiet for no progress, and --help.

    \b
    Examples:
      quietarm reproduce --output results
      quietarm plan single-link --target 30deg --duration 0.8 --output move.png
      quietarm plan arm-on-flexible-link --start=-pi/2 --target pi/4 --duration 1.0 \\
          --torque-limit 0.4 --output plan.json --output move.csv
      quietarm evaluate single-link --target pi/6 --duration 0.8 \\
          --coefficients=0.003347,-0.1697
    """  # noqa: D301  # \b is click's: do not rewrap


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command within Python, by default of the process's words; SystemExit at its end."""
    try:
        status = run_as_process() if arguments is None else _run(arguments)
    except KeyboardInterrupt as stop:
        status = _complain(INTERRUPTED, exit_status_of(stop))
    sys.exit(status)


def run_as_process() -> int:
    """Run the command whose words the process was given; its status, unless Ctrl-C ends it."""
    os.environ["MPLBACKEND"] = "agg"  # to files: no window, whatever the user's notebooks use
    warnings.filterwarnings("ignore", ".* more than a turn")  # they had a unit
    _open_what_is_closed()
    return _run(None)


def _open_what_is_closed() -> None:
    """Let words go nowhere where a stream is closed, as by `>&-`; no file takes its place."""
    standard_error = 2  # the last of the numbers that a system gives to a process's own streams
    while (number := os.open(os.devnull, os.O_RDWR)) <= standard_error:
        os.set_inheritable(number, True)  # workers have them, too
    os.close(number)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115


def _run(arguments: Sequence[str] | None) -> int:
    if os.environ.get("COLUMNS") == "0":  # as some terminals have it that do not know their width
        del os.environ["COLUMNS"]
    words = sys.argv[1:] if arguments is None else list(arguments)
    passed = None if arguments is None else words  # of None click looks for files on Windows
    try:
        status = quietarm.main(passed, prog_name="quietarm", standalone_mode=False, obj=words)
        sys.stdout.flush()
        return status or 0
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        return BAD_INPUT
    except click.ClickException as error:
        return _complain(error.format_message(), BAD_INPUT)
    except ValueError as error:
        return _complain(str(error), BAD_INPUT)
    except InterruptedCommandError as error:
        return _complain(str(error), error.status)
    except QuietarmError as error:
        return _complain(str(error), NOT_SOLVED)
    except SystemExit as error:
        if isinstance(error.__context__, BrokenPipeError):  # click's: the reader has read enough
            return 0
        return _complain(f"{_place_of(error)}{words_of_error(error)}", BAD_INPUT)
    except click.Abort as stop:  # click's name for it
        raise KeyboardInterrupt(*getattr(stop.__cause__, "args", ())) from None
    except MemoryError:
        return _complain("out of memory; give a smaller population or fewer workers", NOT_SOLVED)
    except BrokenPipeError:  # the reader has read enough, as head does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        place = f"{error.filename}: " if error.filename else _stream_of(error)
        return _complain(f"{place}{reason}; choose another place", BAD_INPUT)


def _stream_of(error: OSError) -> str:
    """Standard output, where what prints to it has failed; nothing else is said without its name.

    What writes files names them where the system does not.
    """
    last = Path(traceback.extract_tb(error.__traceback__)[-1].filename)
    printed = last == Path(__file__) or bool({"rich", "click"} & {*last.parts})
    return "standard output: " if printed else "a file: "


def _place_of(error: BaseException) -> str:
    """The last line of a file of the user's own that led to an error, for a message."""
    ours = (Path(__file__).parents[3], *map(Path, {sys.prefix, sys.base_prefix}))
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        is_file = Path(frame.filename).suffix == ".py"
        if is_file and not any(Path(frame.filename).is_relative_to(place) for place in ours):
            return f"{frame.filename}, line {frame.lineno}: "
    return ""


def _complain(message: str, status: int) -> int:
    # a name in it may have a hundred thousand letters; the remedy stands at its end
    line = cut(one_line(" ".join(message.split())), 2000)
    with suppress(BrokenPipeError):  # nobody reads it; the status says it all the same
        click.echo(f"quietarm: {line}", err=True)
    return status
