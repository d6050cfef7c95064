"""The files of a plan: their options, and what writes them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial, wraps
from typing import Any

import click
from quietarm.ocp import Plan
from quietarm.ocp.planning.plan import ticks_of_move
from quietarm.studies import figures
from quietarm.studies.cli.options import options, typed
from quietarm.studies.cli.types import CSV_FILE, JSON_FILE, PICTURE
from quietarm.studies.display.saving import File, drawing

_RATE = "sample_rate"
_PLAN_FILES = options(
    click.option("--output", type=JSON_FILE,
                 help="Write the plan to this JSON file; - is standard output."),
    click.option("--csv", "csv_file", type=CSV_FILE, help="Write the move to this CSV file."),
    click.option("--sample-rate", type=float, default=1000.0, show_default=True,
                 help="Rows per second of the CSV file [Hz]."),
    click.option("--figure", type=PICTURE,
                 help="Draw the move over the plain cycloid (.png, .pdf or .svg)."),
)  # fmt: skip


def plan_file_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options for the files of a plan; the command gets `files_of` a plan."""

    @wraps(command)
    def with_files(**named: Any) -> Any:
        output, csv_file, rate, figure = map(named.pop, ("output", "csv_file", _RATE, "figure"))
        duration = named["task"].duration if "task" in named else named["duration"]
        if csv_file is not None and duration is not None:  # refused now, not after the solve
            ticks_of_move(duration, rate)
        elif csv_file is None and typed(_RATE):
            raise ValueError("--sample-rate is for --csv: give that too, or leave it out")

        def files_of(plan: Plan) -> list[File]:
            return [
                (output, plan.save),
                (csv_file, partial(plan.save_csv, sample_rate=rate)),
                (figure, drawing(lambda: figures.motion_figure(plan))),
            ]

        return command(files_of=files_of, **named)

    return _PLAN_FILES(with_files)
