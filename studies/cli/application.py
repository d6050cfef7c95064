"""The group of commands, each loaded when it is asked for, and the handling of errors."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib import import_module
from keyword import iskeyword

import click
from quietarm.ocp import FileFormatError, QuietarmError
from quietarm.ocp.base.files import written
from quietarm.ocp.base.interrupts import as_ctrl_c
from quietarm.ocp.base.names import unknown
from quietarm.studies.cli.refusals import in_our_words
from quietarm.studies.cli.streams import patient_streams

BAD_INPUT, NOT_SOLVED = 2, 1

COMMANDS = {
    "plan": ("moves", "Find the still move of least energy."),
    "evaluate": ("moves", "Compute the figures of given coefficients."),
    "front": ("fronts", "Find the trade-off of residual and energy."),
    "import": ("fronts", "Make a front of coefficients that another program found."),
    "polish": ("fronts", "Improve a front by the gradient."),
    "compare": ("fronts", "Compare fronts of one task."),
    "floor": ("moves", "Find the least energy over all joint motions."),
    "robustness": ("moves", "Show what plans leave when the plant is not the assumed one."),
    "problems": ("fronts", "List named problems with their exact fronts."),
    "animate": ("moves", "Draw plans in motion, as a GIF or an MP4."),
    "study": ("studies", "Run every method on a task, and write one report."),
    "contest": ("studies", "Hold methods with equal evaluations against exact fronts."),
    "reproduce": ("studies", "Recompute the paper."),
}
"""The room of each command and what it does. `NAME` is the function `NAME` of
`commands.ROOM.NAME`, with an underscore behind it where NAME is a word of Python's."""


class LazyGroup(click.Group):
    """A group that knows only what its commands do, and loads one when it is asked for."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The name and the command that was asked for, and the other words."""
        if not args[0].startswith("-") and args[0] not in COMMANDS:
            raise ValueError(unknown("command", args[0], COMMANDS))
        name, command, others = super().resolve_command(ctx, args)
        if name is not None:
            own = f"{name}_" if iskeyword(name) else name
            room, _ = COMMANDS[name]
            command = getattr(import_module(f"quietarm.studies.cli.commands.{room}.{own}"), own)
        return name, command, others


def _say_version(ctx: click.Context, param: click.Parameter, wanted: bool) -> None:
    if wanted:
        from quietarm.models import __version__

        click.echo(f"quietarm, version {__version__}")
        ctx.exit()


@click.group(
    cls=LazyGroup,
    commands=[click.Command(name, short_help=does) for name, (_, does) in COMMANDS.items()],
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    no_args_is_help=True,
)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_say_version,
    help="Show the version and exit.",
)  # fmt: skip
def quietarm() -> None:
    """Plan point-to-point moves of flexible robot arms that arrive still and spend little energy.

    PLANT is single-link, arm-on-flexible-link or dual-link, or that of a --plant-file. Angles are
    radians, or 30deg, pi/6, -pi/2; speeds rad/s, or 60deg; lengths metres, or 1mm; times seconds,
    or 800ms.

    \b
    Examples:
      quietarm reproduce --output results
      quietarm plan single-link --target 30deg --duration 0.8 --figure move.png
      quietarm plan arm-on-flexible-link --start=-pi/2 --target pi/4 --duration 1.0 \\
          --torque-limit 0.4 --output plan.json --csv move.csv
      quietarm evaluate single-link --target pi/6 --duration 0.8 \\
          --coefficients=0.003347,-0.1697
    """  # noqa: D301  # \b is click's: do not rewrap


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command and end the process with its status."""
    written.clear()
    if arguments is None:  # pictures go to files: no window, whatever the user's notebooks use
        os.environ["MPLBACKEND"] = "agg"
    try:
        with patient_streams() as out, as_ctrl_c():
            status = _run(arguments)
            out.flush()
            if out.trouble:
                status = _complain(
                    f"standard output cannot be written: {out.trouble}; send it elsewhere",
                    BAD_INPUT,
                )
    except KeyboardInterrupt:  # one more, while the first was being answered
        status = NOT_SOLVED
    sys.exit(status)


def _run(arguments: Sequence[str] | None) -> int:
    try:
        return quietarm.main(arguments, prog_name="quietarm", standalone_mode=False) or 0
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        return BAD_INPUT
    except click.ClickException as error:
        return _complain(in_our_words(error), BAD_INPUT)
    except (FileFormatError, ValueError) as error:
        return _complain(str(error), BAD_INPUT)
    except QuietarmError as error:
        return _complain(str(error), NOT_SOLVED)
    except (KeyboardInterrupt, click.Abort):
        return _complain(f"interrupted; {_what_is_kept()}", NOT_SOLVED)
    except MemoryError:
        return _complain("out of memory; give a smaller population or fewer workers", NOT_SOLVED)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        place = f"{error.filename}: " if error.filename else ""
        return _complain(f"{place}{reason}; choose another place", BAD_INPUT)


def _what_is_kept() -> str:
    """What was written before an interruption that nothing else told of."""
    if not written:
        return "nothing was written"
    if len(written) == 1:
        return f"wrote {written[0]}"
    return f"wrote {len(written)} files, the last {written[-1]}"


def _complain(message: str, status: int) -> int:
    line = " ".join(message.split())
    click.echo(f"quietarm: {line}", err=True)
    return status


if __name__ == "__main__":
    main()
