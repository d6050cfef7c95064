"""`quietarm versus`: a plan against what is used today."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import click
from quietarm.ocp import PointToPoint
from quietarm.ocp.planning.plan_move import limit_of
from quietarm.studies.cli.ending import finish, interruption
from quietarm.studies.cli.options import command, quiet_option, terms_option
from quietarm.studies.cli.task import old_task_options, robust_option
from quietarm.studies.cli.types import FOLDER, RESIDUAL
from quietarm.studies.display.progress import working
from quietarm.studies.document.files import document_files
from quietarm.studies.registry.profiles import POLYNOMIAL, profile_of
from quietarm.studies.versus.report import versus_document
from quietarm.studies.versus.rivals import Rival, rivals
from rich.console import Console


@command()
@old_task_options
@terms_option
@click.option("--residual-limit", type=RESIDUAL, help="Of the robust plan; as for quietarm plan.")
@robust_option
@click.option("--output", type=FOLDER, help="Write Markdown, CSV and a picture to this folder.")
@quiet_option
def versus(
    task: PointToPoint,
    terms: int | None,
    residual_limit: float | None,
    output: Path | None,
    quiet: bool,
) -> None:
    """Hold a plan against what is used today: the cycloid, input shapers, ruckig, shaped ruckig.

    A row for each on the same move: what it leaves as planned and at worst within the errors of
    --robust, energy, peaks, and the limits that it breaks. Ruckig needs quietarm[ruckig] and an
    acceleration limit.

    \b
    Examples:
      quietarm versus flexible-beam --set omega=3.2Hz --target 60deg --duration 0.7 \\
          --torque-limit 1.5 --acceleration-limit 80 --error frequency=8% --output versus
    """  # noqa: D301  # \b is click's: do not rewrap
    profile = profile_of(POLYNOMIAL, task, terms)
    with working("planning and shaping", Console(stderr=True), quiet=quiet):
        found, complete = list[Rival](), False
        with suppress(KeyboardInterrupt):
            for rival in rivals(task, profile, residual_limit):
                found.append(rival)
            complete = True
    if not found:
        raise KeyboardInterrupt
    robust = any(rival.name == "robust plan" and rival.motion for rival in found)
    allowed = limit_of(task, residual_limit) if robust else None
    document = versus_document(task, found, allowed)
    finish(
        document_files(output, document),
        document,
        trouble=None if complete else interruption(f"{len(found)} motions"),
    )
