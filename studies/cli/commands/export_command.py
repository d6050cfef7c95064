"""`quietarm export`: moves for a controller, as films, as a page, or in a format of one's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import click

from quietarm.models import load_plant_file
from quietarm.models.units import UNITS, parse_quantity
from quietarm.ocp import Front, Plan, evaluate_coefficients
from quietarm.ocp.checks import joined
from quietarm.ocp.files import check_writable, write_whole
from quietarm.studies.answers.read_answers import load_fronts_and_plans
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import Command, busy, counting, option
from quietarm.studies.cli.outputs import finish, settings_of_studies
from quietarm.studies.cli.quantities import RESIDUAL_LIMIT
from quietarm.studies.cli.types import INPUT, Named, Parsed
from quietarm.views.formats.export_format import (
    DATASET,
    FRONT,
    ExportFormat,
    ExportSetting,
    Progress,
    endings_of,
    format_of,
    known_formats,
    takers_of,
)
from quietarm.views.formats.formats import write_in
from quietarm.views.report.saving import STDOUT, File

_USUAL = "csv"
"""The format of standard output unless another is given."""


def _to_stdout() -> list[str]:
    """The formats that can go to standard output."""
    return [form.name for form in known_formats().values() if form.to_stdout]


def _output(text: str) -> Path:
    """A file that can be written, or standard output."""
    path = Path(text)
    return path if path == STDOUT else check_writable(path)


class ExportCommand(Command):
    """Command with an option for each setting of a format, those of the user's own file too."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Load the user's file first: what it brings has options."""
        path = _value_after("--plant-file", args)
        if path is not None:
            try:
                load_plant_file(path)
            except ValueError as error:
                hint = "'--plant-file'"
                raise click.BadParameter(str(error), ctx=ctx, param_hint=hint) from None
        return super().parse_args(ctx, args)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the formats above the options."""
        with formatter.section("Formats, by the ending of the file"):
            formatter.write_dl(
                [(joined(form.endings), f"{form.meaning}, of {form.taken}") for form in
                 known_formats().values()]
            )  # fmt: skip
        super().format_options(ctx, formatter)

    @property
    def own_params(self) -> list[click.Parameter]:
        """The command's own options, and those of the formats."""
        return [*super().own_params, _format_option(), *_setting_options()]


def _format_option() -> click.Option:
    """--format, of standard output."""
    words = f"The format of standard output. [default: {_USUAL}]"
    none = {form.name: _not_to_stdout(form) for form in known_formats().values()}
    return option("--format", "form", type=Named("format", _to_stdout, none), help=words)


def _not_to_stdout(form: ExportFormat) -> str:
    """Say that a format cannot go to standard output, and what to do."""
    instead = f"give a name, such as move{form.endings[0]}"
    return f"{form.name} cannot go to standard output, only {joined(_to_stdout())}; {instead}"


def _value_after(name: str, words: Sequence[str]) -> str | None:
    """Return the text that was typed for an option; None if there is none."""
    for word, following in zip(words, [*words[1:], None]):
        if word == "--":
            return None
        if word == name:
            return following
        if word.startswith(f"{name}="):
            return word.removeprefix(f"{name}=")
    return None


def _setting_options() -> list[click.Option]:
    """An option for each name of a setting, with what it means to which format."""
    by_option = dict[str, list[tuple[str, ExportSetting]]]()
    for form in known_formats().values():
        for setting in form.settings:
            if setting.type_of_value is not object:
                by_option.setdefault(setting.option, []).append((form.name, setting))
    return [
        option(name, settings[0][1].name, help=_help_of(settings), metavar=_metavar(settings))
        for name, settings in by_option.items()
    ]


def _help_of(settings: Sequence[tuple[str, ExportSetting]]) -> str:
    """Every meaning once, after the formats that it is of, with its default."""
    of = dict[ExportSetting, list[str]]()
    for name, setting in settings:
        of.setdefault(setting, []).append(name)
    return " ".join(_help_line(setting, names) for setting, names in of.items())


def _help_line(setting: ExportSetting, names: Sequence[str]) -> str:
    """Return the meaning of a setting for some formats, with its default."""
    default = setting.default
    words = "" if default is None else f"{default:g}" if isinstance(default, float) else default
    ending = f" [default: {words}]" if default not in (None, "") else ""
    return f"{', '.join(names)}: {setting.meaning}{ending}"


def _metavar(settings: Sequence[tuple[str, ExportSetting]]) -> str:
    kinds = {setting.type_of_value for _, setting in settings}
    return "TEXT" if str in kinds else "NUMBER"


@click.command(cls=ExportCommand, params=[
    click.Argument(["plans"], nargs=-1, type=INPUT, metavar="PLAN|FRONT ..."),
    option("--output", "-o", type=Parsed("file", _output), required=True,
           help="The file, whose ending is the format; move.c has move.h beside it. - is standard "
           "output."),
    option("--residual-limit", metavar="LENGTH",
           help="Of a FRONT for a controller or a film: the motion of least energy within this "
           "residual, such as 1mm."),
])  # fmt: skip
def export(given: Given) -> None:
    """Write a saved PLAN for a controller, as a film or as a page.

    C source and Structured Text give angle, speed and acceleration at any time from the
    coefficients, the C with nothing but math.h. The PLAN may be the dataset of quietarm sweep,
    whose moves are written as C with the interpolation between them. Of tables, trajectories, cams
    and records a line says how far an interpolation between their points is from the plan at most.

    A trajectory of ROS 2 takes several PLANs as moves in a row, with a pause between two.

    A film shows several PLANs side by side on one clock, one alone beside the plain cycloid of its
    move. Links bend as their modes do; the picture says how far that is exaggerated. An mp4 needs
    the program ffmpeg.

    The page (html) is one file that needs no network. Of a saved FRONT one drags along the
    trade-off and sees each point's motion; further fronts and plans of the move lie beside it. Any
    other format takes the motion of a FRONT that --residual-limit chooses.

    A format of your own stands beside a plant in its --plant-file.

    \b
    Examples:
      quietarm export plan.json --output move.c
      quietarm export plan.json --output move.csv --columns time:ms,angle:deg,torque --rate 500
      quietarm export plan.json --output move.yaml --joint shoulder_pan_joint --rate 100
      quietarm export first.json second.json --pause 0.5 --output moves.moveit
      quietarm export plan.json --output move.st
      quietarm export plan.json --output move.cam --layout codesys --unit deg
      quietarm export plan.json --output move.cia402 --increments-per-revolution 1e6 --period 2ms
      quietarm export plan.json --output - --columns time,angle:deg
      quietarm export moves.zarr --output moves.c
      quietarm export plan.json zvd.json --output move.gif --speed 25%
      quietarm export front.json nsga2.json --output front.html
      quietarm export front.json --residual-limit 1mm --output move.csv
    """  # noqa: D301  # \b is click's: do not rewrap
    form = _format(given)
    settings = _settings(given, form)
    if given.output != STDOUT:
        form.check_path(given.output)
    answers = _answers(form, given)
    if given.output == STDOUT:
        made = form.make(answers, STDOUT, settings, lambda done, total: None)
        content = made.files[STDOUT]
        files: list[File] = [(STDOUT, lambda path: write_whole(path, content))]
        return finish(files, *filter(None, made.notes))
    with _progress(form) as report:
        written, notes = write_in(form, answers, given.output, settings, report)
    return finish([], *(f"wrote {path}" for path in written), *notes)


def _progress(form: ExportFormat) -> AbstractContextManager[Progress | None]:
    """Show that the work goes on, with what it counts where it counts."""
    return counting(0, form.pieces) if form.pieces else busy("making the file")


def _answers(form: ExportFormat, given: Given) -> Mapping[str, Any]:
    """Load the answers to export, by their names, and evaluate their motions again."""
    paths: Sequence[Path] = given.plans
    if len(paths) == 1 and paths[0].is_dir():
        if DATASET not in form.takes:
            raise ValueError(
                f"{paths[0]} has many moves, which are exported as {endings_of(DATASET)}; give "
                "such a file"
            )
        from quietarm.studies.sweep.exported_moves import moves_to_export

        return {paths[0].stem: moves_to_export(paths[0])}
    form.refuse_number(len(paths))
    answers = load_fronts_and_plans(paths)
    if FRONT in form.takes:
        given.refuse([RESIDUAL_LIMIT], f"chooses a motion, and {form.name} shows whole fronts")
        return answers
    if not any(isinstance(answer, Front) for answer in answers.values()):
        given.refuse([RESIDUAL_LIMIT], "is for a front, and a plan is one motion")
    return {
        name: _plan_of(path, answer, given)
        for path, (name, answer) in zip(paths, answers.items(), strict=True)
    }


def _plan_of(path: Path, answer: Front | Plan, given: Given) -> Plan:
    """A plan as it is; of a front the motion that was chosen."""
    if isinstance(answer, Plan):
        return answer
    limit = given.read_residual_limit(answer.task.plant)
    if limit is None:
        raise ValueError(
            f"{path} is a front; choose one of its motions by its residual, such as "
            "--residual-limit 1mm"
        )
    point = answer.cheapest(residual_limit=limit)
    return evaluate_coefficients(answer.task, point.coefficients, profile=answer.profile)


def _format(given: Given) -> ExportFormat:
    """The format by the file's ending; of standard output by --format."""
    if given.output != STDOUT:
        given.refuse(["form"], "is for --output - alone: a file's ending says its format")
        return format_of(given.output)
    return known_formats()[given.form or _USUAL]


def _settings(given: Given, form: ExportFormat) -> dict[str, Any]:
    """Read the typed settings of a format; refuse those of other formats."""
    for other in known_formats().values():
        for setting in other.settings:
            takers = [taker.name for taker in takers_of(setting.name)]
            if form.name not in takers:
                why = f"is for {joined(takers)}, not for {form.name}"
                given.refuse([setting.name], why)
    typed = [setting for setting in form.settings if given.typed(setting.name)]
    settings = {setting.name: _read(setting, getattr(given, setting.name)) for setting in typed}
    return form.complete(settings) | settings_of_studies(form)


def _read(setting: ExportSetting, text: str) -> Any:
    """Read the typed value of a setting."""
    if setting.type_of_value is str:
        return text
    if setting.type_of_value is float:
        if setting.unit not in UNITS:
            text = text.strip().removesuffix(setting.unit)
        return parse_quantity(text, setting.unit or "-", f"a value of {setting.option}")
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"{setting.option} is {text!r}; give a whole number") from None
