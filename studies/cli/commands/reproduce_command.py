"""`quietarm reproduce`: the paper recomputed."""

from __future__ import annotations

from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import command, option, progress_console
from quietarm.studies.cli.outputs import FOLDER, REPORT_OPTION, ending_of, finish
from quietarm.studies.cli.quantities import parse_workers
from quietarm.studies.cli.types import Parsed


@command(
    option("--full", is_flag=True, help="Judge every claim as well, with several seeds."),
    option("--seeds", type=int, help="Seeds of VEPSO and NSGA-II. [default: 1; --full: 9]"),
    option("--workers", type=Parsed("number", parse_workers),
           help="Processes that share the work. [default: one a core]"),
    REPORT_OPTION,
)  # fmt: skip
def reproduce(given: Given) -> None:
    """Recompute the paper's Tables 2, 3, 5 and 6 and its figures; --full also judges its claims.

    Fronts are kept in the folder's `fronts` as they are found: the same line goes on after an
    interruption.

    \b
    Examples:
      quietarm reproduce --output results
      quietarm reproduce --full --output results
    """  # noqa: D301  # \b is click's: do not rewrap
    import joblib

    from quietarm.ocp.checks import whole
    from quietarm.studies.reproduce.paper_report import reproduction_report
    from quietarm.studies.reproduce.recompute import Effort, number_of_pieces, recompute_paper
    from quietarm.views.report.progress import progress

    of_readme = 9
    seeds = of_readme if given.full else 1
    if given.seeds is not None:
        seeds = whole("seeds", given.seeds, 1, 1000)
    workers = given.workers or joblib.cpu_count()
    effort = Effort(full=given.full, seeds=seeds)
    folder = next((path / "fronts" for path in given.output if ending_of(path) == FOLDER), None)
    with progress(number_of_pieces(effort), progress_console()) as begin:
        report = reproduction_report(recompute_paper(effort, workers, begin, folder))
    finish(report.files(*given.output), report)
