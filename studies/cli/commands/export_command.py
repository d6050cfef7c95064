"""`quietarm export`: moves for a controller, as films, and as a page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from quietarm.ocp import Plan
from quietarm.ocp.files import check_writable, write_whole
from quietarm.studies.answers.read_answers import load_fronts_and_plans, load_plans
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import busy, command, counting, option
from quietarm.studies.cli.outputs import finish
from quietarm.studies.cli.types import INPUT, SHARE, Named, Parsed
from quietarm.views.formats.between_rows import OF_POINTS, interpolation_note
from quietarm.views.formats.formats import (
    COLUMNS,
    FORMATS,
    FRAMES,
    JOINT,
    RATE,
    WIDTHS,
    content_of,
    export_plan,
    format_of,
)
from quietarm.views.formats.move_tables import columns_of
from quietarm.views.pictures.motion import Line
from quietarm.views.report.saving import STDOUT, File
from quietarm.views.report.words import counted

_TO_STDOUT = [name for name, form in FORMATS.items() if form.to_stdout]


def _output(text: str) -> Path:
    """A file that can be written, or standard output."""
    path = Path(text)
    return path if path == STDOUT else check_writable(path)


@command(
    click.Argument(["plans"], nargs=-1, type=INPUT, metavar="PLAN|FRONT ..."),
    option("--output", "-o", type=Parsed("file", _output), required=True,
           help="The file, whose ending is the format; move.c has move.h beside it. - is standard "
           "output."),
    option("--format", "form", type=Named("format", FORMATS),
           help=f"Of standard output: {' or '.join(_TO_STDOUT)}. [default: {_TO_STDOUT[0]}]"),
    option("--columns", default=COLUMNS, help="Of csv and mat, with units: time:ms,angle:deg,"
           "speed,acceleration,jerk,tip:mm,torque,power."),
    option("--rate", type=float, help="Rows, points or frames in a second [Hz]. [default: "
           f"{RATE:g}, {FRAMES:g} of a film]"),
    option("--joint", default=JOINT, help="The joint's name, for ROS."),
    option("--speed", type=SHARE, default="100%", help="Of a film's clock; 25% is slow motion."),
    option("--deflection-scale", type=float, help="Draw deflections so many times larger. "
           "[default: the largest becomes up to a fifth of the structure]"),
    option("--width", type=click.IntRange(*WIDTHS), default=800, help="Of a film, in pixels."),
)  # fmt: skip
def export(given: Given) -> None:
    """Write a saved PLAN for a controller (csv, C, ROS 2, MATLAB), as a film (gif, mp4) or a page.

    The C source gives angle, speed and acceleration at any time from the coefficients, with nothing
    but math.h. The PLAN may be the dataset of quietarm sweep, whose moves are written as C with the
    interpolation between them.

    A film shows several PLANs side by side on one clock, one alone beside the plain cycloid of its
    move. Links bend as their modes do; the picture says how far that is exaggerated. An mp4 needs
    the program ffmpeg.

    The page (html) is one file that needs no network. Of a saved FRONT one drags along the
    trade-off and sees each point's motion; further fronts and plans of the move lie beside it.

    \b
    Examples:
      quietarm export plan.json --output move.c
      quietarm export plan.json --output move.csv --columns time:ms,angle:deg,torque --rate 500
      quietarm export plan.json --output move.yaml --joint shoulder_pan_joint --rate 100
      quietarm export plan.json --output - --columns time,angle:deg
      quietarm export moves.zarr --output moves.c
      quietarm export plan.json zvd.json --output move.gif --speed 25%
      quietarm export front.json nsga2.json --output front.html
    """  # noqa: D301  # \b is click's: do not rewrap
    plans = given.plans
    output = given.output
    name = _format(given)
    settings = _settings(given, name)
    form = FORMATS[name]
    if not (form.is_film or form.is_page) and len(plans) > 1:
        raise ValueError(f"{name} is of one plan, and {len(plans)} are given; give one")
    written = [output]
    notes = list[str]()
    files = list[File]()
    if len(plans) == 1 and plans[0].is_dir():
        if name != "c":
            raise ValueError(f"{plans[0]} has many moves, which are exported as C; give a .c file")
        from quietarm.studies.sweep.library_in_c import export_moves

        written = export_moves(plans[0], output)
    elif form.is_film:
        notes = [_write_film(plans, output, settings)]
    elif form.is_page:
        notes = [_write_page(plans, output, settings)]
    else:
        (plan,) = load_plans(plans).values()
        notes = _notes(plan, name, settings)
        if output == STDOUT:
            content = content_of(plan, name, **settings)
            files = [(STDOUT, lambda path: write_whole(path, content))]
            written = []
        else:
            written = export_plan(plan, output, **settings)
    finish(files, *notes, *(f"wrote {path}" for path in written))


def _format(given: Given) -> str:
    """The format by the file's ending; of standard output by --format."""
    if given.output != STDOUT:
        given.refuse(["form"], "is for --output - alone: a file's ending says its format")
        return format_of(given.output)
    name = given.form or _TO_STDOUT[0]
    if name not in _TO_STDOUT:
        raise ValueError(
            f"{name} cannot go to standard output, only {' and '.join(_TO_STDOUT)}; give a name, "
            f"as move{FORMATS[name].endings[0]}"
        )
    return name


def _settings(given: Given, name: str) -> dict[str, Any]:
    """What was typed of the format's settings; those of other formats are refused."""
    for setting in dict.fromkeys(name for form in FORMATS.values() for name in form.takes):
        takers = [taker for taker, form in FORMATS.items() if setting in form.takes]
        if name not in takers:
            given.refuse([setting], f"is for {', '.join(takers)}, not for {name}")
    typed = given.pick(*FORMATS[name].takes)
    return {setting: value for setting, value in typed.items() if value is not None}


def _notes(plan: Plan, name: str, settings: dict[str, Any]) -> list[str]:
    """What a controller leaves that interpolates between the rows, where that matters."""
    if "rate" not in FORMATS[name].takes:
        return []
    columns = OF_POINTS
    if "columns" in settings:
        columns = tuple(columns_of(settings["columns"], plan.task.plant))
    return [interpolation_note(plan, settings.get("rate", RATE), columns)]


def _write_film(plans: tuple[Path, ...], output: Path, settings: dict[str, Any]) -> str:
    """Write a film of plans; how long and how large it is."""
    from quietarm.views.film import animate

    lines = [Line(plan, label) for label, plan in load_plans(plans).items()]
    film = animate(lines if len(lines) > 1 else lines[0].plan, **settings)
    with counting(film.frames, "frames") as report:
        film.save(output, report)
    return f"{film.frames} frames, {film.seconds:.1f} s, {output.stat().st_size / 1e3:.0f} kB"


def _write_page(answers: tuple[Path, ...], output: Path, settings: dict[str, Any]) -> str:
    """Write a page of fronts and plans; how many motions it has, and how large it is."""
    from quietarm.studies.reproduce.paper import paper_points
    from quietarm.views.page.trade_off import trade_off

    loaded = load_fronts_and_plans(answers)
    with busy("sampling the motions"):
        page = trade_off(loaded, known_points=paper_points, **settings)
    page.save(output)
    motions = counted(sum(len(move["points"]) for move in page.moves), "motion")
    return f"{motions}, {output.stat().st_size / 1e3:.0f} kB"
