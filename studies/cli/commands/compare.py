"""`quietarm compare`: compare fronts of one task."""

from __future__ import annotations

from pathlib import Path

import click
from quietarm.studies.cli.options import command, latex_option, quiet_option
from quietarm.studies.cli.task import plant_file_option
from quietarm.studies.cli.types import FOLDER, INPUT
from quietarm.studies.display.progress import working
from rich.console import Console


@command()
@click.argument("fronts", nargs=-1, type=INPUT, metavar="FRONT FRONT ...")
@click.option("--reference", type=INPUT, help="Measure IGD+ and epsilon against this front.")
@click.option(
    "--floor/--no-floor", default=True, show_default=True,
    help="Find the least energy over all joint motions as well: some seconds.",
)  # fmt: skip
@click.option(
    "--as-found", is_flag=True, help="Do not count motions between the points of a front."
)
@click.option("--output", type=FOLDER, help="Write Markdown, CSV and a picture to this folder.")
@latex_option
@plant_file_option(expose_value=False)
@quiet_option
def compare(
    fronts: tuple[Path, ...],
    reference: Path | None,
    floor: bool,
    as_found: bool,
    output: Path | None,
    latex: Path | None,
    quiet: bool,
) -> None:
    """Compare fronts of one task, found by any methods.

    By hypervolume, IGD+, additive epsilon, coverage, the energies at residuals of 0.1, 1 and 5 mm,
    candidates evaluated and time. The motions between the points of a front count as well, so that
    it is not judged by its number of points. Fronts of one method from several seeds are grouped:
    medians, quartiles and attainment surfaces.

    \b
    Examples:
      quietarm compare nsga2.json vepso.json
      quietarm compare front-seed0.json front-seed1.json epsilon.json --output compared
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.ocp import QuietarmError
    from quietarm.studies.cli.ending import finish
    from quietarm.studies.comparison.measures import FILL, compare_fronts
    from quietarm.studies.document.files import document_files
    from quietarm.studies.document.latex import latex_file
    from quietarm.studies.reading.saved import load_front
    from quietarm.studies.reports.comparison import comparison_document, with_floor

    errors, trouble = Console(stderr=True), None
    with working("comparing", errors, quiet=quiet):
        loaded = [load_front(path) for path in fronts]
        named = None if reference is None else load_front(reference)
        comparison = compare_fronts(
            loaded, [str(front) for front in fronts], reference=named,
            reference_name=str(reference),
            fill=0 if as_found else FILL,
        )  # fmt: skip
    if floor:
        try:
            with working("finding the floor", errors, quiet=quiet):
                comparison = with_floor(comparison, errors)
        except KeyboardInterrupt:
            trouble = QuietarmError("interrupted; the comparison is kept, without the floor")
    document = comparison_document(comparison)
    files = [*document_files(output, document), latex_file(latex, document)]
    finish(files, document, trouble=trouble, quiet=quiet)
