"""Commands, and the options that several have, each an object that commands list."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from functools import partial
from pathlib import Path
from typing import Any

import click

from quietarm.metaheuristics.parallel import scheduler_address
from quietarm.models import load_plant_file
from quietarm.ocp.checks import with_article
from quietarm.ocp.limits import QUANTITIES, Quantity
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.planning.named_profiles import POLYNOMIAL, families
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.ocp.solvers.solver import Option, Solver
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.plants import parse_plant
from quietarm.studies.cli.quantities import (
    parse_energy,
    parse_error,
    parse_margin,
    parse_noise,
    parse_objectives,
    parse_share_of_work,
    parse_state,
    parse_usual,
    parse_workers,
)
from quietarm.studies.cli.types import INPUT, SETTING, TIME, Named, Parsed
from quietarm.views.report.progress import count, working
from quietarm.views.report.saving import STDOUT
from quietarm.views.report.terminal import ErrorConsole


def option(*names: str, help: str, multiple: bool = False, **settings: Any) -> click.Option:  # noqa: A002
    """An option, whose help ends with its default, or says that it may be repeated."""
    words = f"{help} May be repeated." if multiple else help
    return click.Option(names, help=words, multiple=multiple, show_default=True, **settings)


COMMON = (
    # eager: what is in it is then known by name
    option("--plant-file", type=Parsed("file", load_plant_file), is_eager=True,
           help="Your own plants, profiles, energies, searches, indicators, formats or panels: a "
           "file in Python, which is run."),
    option("--quiet", is_flag=True, help="Show no progress."),
)  # fmt: skip


class Command(click.Command):
    """A command with the options that all have; its function takes what was `Given`."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse a line; quantities of a plant file are options already."""
        for file in _plant_files(args):
            with suppress(ValueError):  # the option's own reading says what is wrong
                load_plant_file(file)
        _, _, order = self.make_parser(ctx).parse_args(args=list(args))
        _refuse_repeated(order)
        return super().parse_args(ctx, args)

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Return the command's own options and those of all commands."""
        help_option = super().get_params(ctx)[-1]
        return [*self.own_params, *COMMON, help_option]

    @property
    def own_params(self) -> list[click.Parameter]:
        """Arguments and options of the command, with limits of the user's own quantities."""
        params = list(self.params)
        names = [param.name for param in params]
        if LIMITS[-1].name in names:
            last = names.index(LIMITS[-1].name) + 1
            added = [quantity for quantity in QUANTITIES.values() if quantity.limit not in names]
            params[last:last] = map(limit_option, added)
        return params

    def invoke(self, ctx: click.Context) -> None:
        """Run it, unless one file is named twice, or its answer would go nowhere."""
        _refuse_same_file(ctx.params.values())
        _refuse_lost_answer(ctx)
        if self.callback is not None:
            self.callback(Given(ctx))


def _refuse_repeated(order: Sequence[click.Parameter]) -> None:
    """Refuse an option of one value that a line has twice: click would take the last of them."""
    for param in order:
        times = order.count(param)
        of_one_value = isinstance(param, click.Option) and not (param.multiple or param.is_flag)
        if of_one_value and times > 1:
            raise click.UsageError(f"{param.opts[0]} is given {times} times; give it once")


def _plant_files(args: Iterable[str]) -> Iterator[str]:
    """The files of `--plant-file` on a line."""
    following = iter(args)
    for word in following:
        name, equals, file = word.partition("=")
        if name == "--plant-file":
            yield file if equals else next(following, "")


def command(*params: click.Parameter) -> Callable[[Callable[[Given], None]], click.Command]:
    """The decorator of every command, with its arguments and options."""
    return click.command(cls=Command, params=list(params))


def _refuse_same_file(values: Iterable[object]) -> None:
    """Refuse a line that names one file twice, so that nothing that is read is written over."""
    paths = list[Path]()
    for value in values:
        several = value if isinstance(value, tuple) else (value,)
        paths += [path for path in several if isinstance(path, Path) and path != STDOUT]
    places = list(map(os.path.realpath, paths))  # of a link, too
    for path, place in zip(paths, places):
        if places.count(place) > 1:
            raise ValueError(f"{path} is given twice; give it once, or another name")


def _refuse_lost_answer(ctx: click.Context) -> None:
    """Refuse a line whose answer is for standard output alone, where that is closed."""
    output = ctx.params.get("output") or STDOUT
    files = output if isinstance(output, tuple) else (output,)
    closed = getattr(sys.stdout, "name", "") == os.devnull
    shows_a_page = ctx.command.name == "explore"
    if closed and STDOUT in files and not shows_a_page:
        raise ValueError("standard output is closed; give the name of a file")


def progress_console() -> ErrorConsole:
    """Standard error, unless --quiet."""
    return ErrorConsole(quiet=click.get_current_context().params["quiet"])


def busy(what: str) -> AbstractContextManager[None]:
    """Show that work goes on."""
    return working(what, progress_console())


def counting(total: int, what: str) -> AbstractContextManager[Callable[[int, int], None]]:
    """Show how many of many small pieces are done."""
    return count(total, what, progress_console())


def limit_option(quantity: Quantity) -> click.Option:
    """The option of a quantity's limit."""
    words = f"Largest {quantity.label} during the move; by direction as LEAST:LARGEST; "
    words += "`none` for no limit in place of the plant's own."
    return option(quantity.option, metavar=f"[{quantity.unit}]", help=words)


LIMITS = tuple(map(limit_option, QUANTITIES.values()))
SET = option("--set", "parameters", type=SETTING, multiple=True, metavar="NAME=VALUE",
             help="Set a parameter of the plant, such as omega=3.2Hz or length=600mm.")  # fmt: skip
DRIVE = option("--drive", "drive", multiple=True, metavar="NAME=VALUE,...",
               help="Servo, transmission and friction of a plant of one joint, as far as you know "
               "them: position_loop=60/s,speed_loop=40Hz,reset_time=30ms,compliance=6N/um,rotor="
               "18kg,friction_motor=25N,friction_load=20N,dead_time=0.25ms.")  # fmt: skip
ERROR = option("--error", "errors", type=Parsed("NAME=SHARE", parse_error), multiple=True,
               help="Range of the error of frequency, damping or a parameter, such as "
                    "frequency=8%; the "
               "residual is then that of the worst case. `measured`: as identified.")  # fmt: skip
BAND = (
    option("--band", metavar="LENGTH", help="Largest distance of the tip from its target after "
           "arrival, such as 0.1mm, for all errors of --error; without it for those of an "
           "identified machine, 2 % of the frequency at least, or else 5 %."),
    option("--margin", "band_margin", type=Parsed("number", parse_margin), default="3",
           metavar="TIMES", help="Times the residual limit that the band is, for what servo and "
           "dry friction leave besides."),
)  # fmt: skip
"""The band in which the tip may act."""
WAYPOINTS = option("--path", type=INPUT,
                   help="Of a robot: waypoints that its joints pass, as csv with a column a joint, "
                   "or a JointTrajectory in YAML, whose times are dropped.")  # fmt: skip
PATH_TOLERANCE = option("--path-tolerance", metavar="ANGLE",
                        help="How far a joint may be from the straight lines between the points of "
                        "--path, 0.5deg or 2mm; the path is refined until it holds.")  # fmt: skip
SOME_WAYPOINTS = option(
    "--waypoints", metavar="FIRST:LAST", help="Of the points of --path only these, counted from 1: "
    "--waypoints 2:4 begins at the second, where a move before has stopped.",
)  # fmt: skip
BLEND = option(
    "--blend", metavar="LENGTH[,...]", help="Go straight between the points of --path, and round "
    "where the tip is within this radius of one: 50mm, or one of each point but the first and the "
    "last.",
)  # fmt: skip
LINE = (
    option("--line-to", metavar="X,Y,Z[,R,P,Y]", help="Of a robot: a straight line in space from "
           "--start to this place of a link, 400mm,200mm,0.5, or with roll, pitch and yaw to turn "
           "to; by inverse kinematics."),
    option("--line-by", metavar="X,Y,Z", help="The same by its way: --line-by=0,0,-200mm."),
    option("--free-orientation", is_flag=True, help="The line is by the place of the link alone, "
           "which turns as its joints like."),
    option("--link", metavar="NAME", help="The link on the line. [default: the one that carries "
           "the beam, or else the tip]"),
)  # fmt: skip
ROBOT_PATH = (WAYPOINTS, SOME_WAYPOINTS, BLEND, PATH_TOLERANCE, *LINE)
"""In place of a straight path in joint space."""
ENDS = (
    option("--start", default="0", metavar="ANGLE", help="Joint angle at the start; of a robot one "
           "of each joint: --start=0,-80deg,97deg."),
    option("--target", metavar="ANGLE", help="Joint angle at the end, or 300mm of a linear axis; "
           "of a robot one of each joint."),
)  # fmt: skip
"""From where to where a joint moves, or the joints of a robot."""
TASK = (
    click.Argument(["plant"], type=Parsed("plant", parse_plant), required=False, metavar="[PLANT]"),
    SET,
    DRIVE,
    *ENDS,
    option("--duration", metavar="TIME", help="Duration of the move; quietarm plan also takes "
           "`fastest`, the shortest within the limits."),
    *LIMITS,
    option("--torque-speed", metavar="TORQUE@SPEED", help="Torque limit by speed, as points: "
           "1.5Nm@0,0.8Nm@190rpm; of a linear axis 100N@0,40N@500mm/s."),
    option("--residual-window", type=TIME,
           help="Time after arrival in which the residual is measured. [default: 1 s, or two "
           "periods of the slowest mode at the target where these are longer]"),
    option("--initial", type=Parsed("W:W'", parse_state), help="Vibration at the start, modal "
           "amplitudes W [m] and rates W' [m/s]: 5mm:-0.3, or of two modes 5mm,0:0,0.1."),
    option("--final", type=Parsed("W:W'", parse_state),
           help="Vibration wanted on arrival, likewise; none by default."),
    option("--energy", type=Parsed("energy", parse_energy), default="absolute",
           help="What counts as energy: absolute or positive power, copper loss by the motor "
           "constant [N m/W^0.5] as copper:0.12, or a sum as 0.5*absolute+copper:0.12."),
    ERROR,
    *BAND,
)  # fmt: skip
"""What describes a task: a command with these, and a --path, has `Given.read_task`."""
BOUND = option("--bound", type=float, help="Largest size of a coefficient. [default: none; a "
               "search of polynomials needs one]")  # fmt: skip
RESIDUAL_LIMIT = option("--residual-limit", metavar="LENGTH", help="Largest tip displacement after "
                        "arrival. [default: at rest; with --band that over --margin; with --error "
                        "5 % of the plain cycloid's "
                        "largest deflection, or less]")  # fmt: skip
SEED = option("--seed", default=0, help="Seed of the random numbers; the first of several.")
STARTS = option("--starts", default=4, help="Starts of the solver.")


def solver_options(solvers: Mapping[str, type[Solver]] = SOLVERS) -> tuple[click.Option, ...]:
    """--solver, and an option for each that one of them has: their fields say all of it."""
    entries: dict[str, dict[str, Option]] = {}
    for name, kind in solvers.items():
        for entry in kind.stated_options():
            entries.setdefault(entry.name, {})[name] = entry
    return (
        option("--solver", type=Named("solver", solvers), default=next(iter(solvers)),
               help="Sequential quadratic programs (quietarm's own, fast), or IPOPT."),
        *(_solver_option(of_kinds, len(of_kinds) == len(solvers)) for of_kinds in entries.values()),
    )  # fmt: skip


def _solver_option(of_kinds: Mapping[str, Option], all_have_it: bool) -> click.Option:
    """An option that some kinds of solver have; None where it was not typed."""
    entry = next(iter(of_kinds.values()))
    words = entry.name.replace("_", "-")
    defaults = {name: _default_words(one.default) for name, one in of_kinds.items()}
    shown = ", ".join(f"{text} of {name}" for name, text in defaults.items())
    if len({*defaults.values()}) == 1:
        shown = next(iter(defaults.values()))
    whose = "" if all_have_it else f"Of {' and '.join(of_kinds)}: "
    flag = f"--{words}/--no-{words}" if entry.kind is bool else f"--{words}"
    help_text = f"{whose}{entry.meaning} [default: {shown}]"
    return option(flag, type=_type_of(entry), default=None, help=help_text)


def _type_of(entry: Option) -> Any:
    """Return how an option of a solver is read: a number in its unit, or one of several words."""
    if entry.kind is float:
        return Parsed(entry.word, partial(parse_usual, entry.unit, with_article(entry.word)))
    return Named(entry.name.replace("_", " "), entry.words) if entry.words else entry.kind


def _default_words(default: object) -> str:
    if default is None:
        return "none"
    return f"{default:g}" if isinstance(default, float) else str(default)


SOLVER = solver_options()
"""What describes a solver: a command with these has `Given.read_solver`."""
SENSITIVITIES = option("--sensitivities", is_flag=True, help="List by how much residual and energy "
                       "change with each parameter of the plant.")  # fmt: skip

VERBOSE = option("--verbose", is_flag=True, help="Show in detail how the answer was found and "
                 "checked.")  # fmt: skip


def objectives_option(
    parse: Callable[[str], tuple[str, ...]] = parse_objectives, more: str = ""
) -> click.Option:
    """--objectives; a command may have `more` to say of them."""
    return option("--objectives", type=Parsed("names", parse),
                  default=",".join(RESIDUAL_AND_ENERGY), metavar="NAME,NAME,...",
                  help="residual, energy and peaks beside them, such as "
                       "residual,energy,peak-torque; "
                  f"quietarm list objectives has them.{more}")  # fmt: skip


OBJECTIVES = objectives_option()
NOISE = (
    option("--noise", type=Parsed("share", parse_noise), default="0", metavar="SHARE",
           help="Noise of residual and energy, a standard deviation as 1%: a simulator with "
           "errors, or a machine that is measured. The front at the end has the true values."),
    option("--reevaluate", default=1, metavar="NUMBER",
           help="Evaluations of a candidate that is kept, whose mean counts; each is counted."),
)  # fmt: skip
METHOD_SETTING = option("--setting", "settings", type=SETTING, multiple=True, metavar="NAME=VALUE",
                        help="A setting of the method, such as crossover=0.7, or in a bench "
                        "nsga2.crossover=0.7; quietarm list METHOD has them all.")  # fmt: skip
WORKERS = option("--workers", type=Parsed("number", parse_workers), default="1",
                 help="Processes of this machine that share the work.")  # fmt: skip
YES = option("--yes", is_flag=True, help="Start even if the work takes more than ten core-hours.")
SCHEDULER = option("--scheduler", metavar="ADDRESS",
                   type=Parsed("address", scheduler_address),
                   help="Let the workers of this dask scheduler share the work, as in "
                   "tcp://host:8786.")  # fmt: skip
PART = option("--part", type=Parsed("i/n", parse_share_of_work), default="1/1",
              help="Do every n-th piece alone, such as 2/8 in a queue's array job.")  # fmt: skip


def profile_options(*more: str, words: str = "") -> tuple[click.Option, click.Option]:
    """--profile and --terms; `more` are profiles without coefficients."""
    no_front = (
        "{0} is an input shaper: it has one motion for a move, and therefore no front; give one of "
        f"{', '.join(families())}, or quietarm plan"
    )
    none = {} if more else {name: no_front.format(name) for name in SHAPERS}
    sizes = ", ".join(f"{family.terms} for {name}" for name, family in families().items())
    sizes += "; of a polynomial within limits 18, or 24 where the plant has several modes"
    return (
        option("--profile", type=Named("profile", lambda: [*families(), *more], none),
               default=POLYNOMIAL,
               help="How the joint moves: a cycloid of a polynomial, of Gaussians, of a neural "
               f"network or of a spline{words}."),
        option("--terms", type=int, help="Terms of the polynomial, Gaussians, hidden nodes or "
               f"control points. [default: {sizes}]"),
    )  # fmt: skip


def method_option(
    methods: Iterable[str] | Callable[[], Iterable[str]],
    elsewhere: Mapping[str, str],
    default: str,
    words: str,
) -> click.Option:
    """--method; an error says of methods `elsewhere` which command has them."""
    return option("--method", type=Named("method", methods, elsewhere), default=default, help=words)
