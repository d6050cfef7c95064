"""The command `quietarm`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from models import Plant, __version__
from ocp import (
    CycloidPolynomial,
    FileFormatError,
    Plan,
    PointToPoint,
    QuietarmError,
    evaluate_coefficients,
    plan_move,
)
from ocp.plan import ticks_of_move
from studies.options import (
    COEFFICIENTS,
    FOLDER,
    LENGTH,
    OUTPUT,
    PICTURE,
    output_options,
    task_options,
)

BAD_INPUT, NOT_SOLVED = 2, 1


@click.group(
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    no_args_is_help=True,
)
@click.version_option(__version__, prog_name="quietarm")
def quietarm() -> None:
    """Plan point-to-point moves of flexible robot arms that arrive still and spend little energy.

    PLANT is single-link or arm-on-flexible-link. Angles are radians, or 30deg, pi/6, -pi/2;
    lengths are metres, or 1mm; times are seconds, or 800ms.

    \b
    Examples:
      quietarm reproduce --output results
      quietarm plan single-link --target 30deg --duration 0.8 --figure move.png
      quietarm plan arm-on-flexible-link --start=-pi/2 --target pi/4 --duration 1.0 \\
          --torque-limit 0.4 --output plan.json --csv move.csv
      quietarm evaluate single-link --target pi/6 --duration 0.8 \\
          --coefficients=0.003347,-0.1697
    """  # noqa: D301  # \b is click's: do not rewrap


@quietarm.command(short_help="Find the still move of least energy.")
@task_options
@click.option("--terms", type=int, default=6, show_default=True, help="Terms of the polynomial.")
@click.option("--bound", type=float, help="Largest coefficient; no bound by default.")
@click.option(
    "--residual-limit", type=LENGTH, default=0.0, show_default=True,
    help="Largest tip displacement after arrival; 0 is at rest.",
)  # fmt: skip
@click.option("--starts", type=int, default=4, show_default=True, help="Starts of the solver.")
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the random starts.")
@click.option(
    "--method", type=click.Choice(["ipopt", "nsga2", "vepso"]), default="ipopt", show_default=True,
    help="The gradient, or the cheapest point of a metaheuristic's front within the residual "
    "limit (1mm where none is given).",
)  # fmt: skip
@click.option("--polish", is_flag=True, help="Improve a metaheuristic's point by the gradient.")
@output_options
def plan(
    terms: int,
    bound: float | None,
    residual_limit: float,
    starts: int,
    seed: int,
    method: str,
    polish: bool,
    **rest: Any,
) -> None:
    """Find the move of least energy whose residual vibration is within a limit.

    \b
    Examples:
      quietarm plan single-link --target 30deg --duration 0.8
      quietarm plan single-link --target pi/2 --duration 1.0 --bound 0.2 --residual-limit 1mm
      quietarm plan arm-on-flexible-link --target 90deg --duration 800ms --torque-limit 0.3 \\
          --output plan.json --csv move.csv --figure move.png
    """  # noqa: D301  # \b is click's: do not rewrap
    from studies.show import show_plan

    task, outputs = _split(rest)
    profile = CycloidPolynomial(terms)
    if method == "ipopt":
        found = plan_move(
            task, profile, residual_limit=residual_limit, bound=bound, starts=starts, seed=seed
        )
    else:
        from studies.searching import plan_by_search

        found = plan_by_search(task, method, profile, bound, residual_limit, seed, polish)
    show_plan(Console(), found)
    _write(found, **outputs)


@quietarm.command(short_help="The figures of given coefficients.")
@task_options
@click.option(
    "--coefficients", type=COEFFICIENTS, required=True,
    help="a_1 to a_N, separated by commas, as --coefficients=-0.0019,-0.14.",
)  # fmt: skip
@output_options
def evaluate(coefficients: list[float], **rest: Any) -> None:
    """Compute residual, energy and peaks of given coefficients.

    \b
    Example, the paper's two terms for the single link:
      quietarm evaluate single-link --target pi/6 --duration 0.8 --coefficients=0.003347,-0.1697
    """  # noqa: D301  # \b is click's: do not rewrap
    from studies.show import show_plan

    task, outputs = _split(rest)
    found = evaluate_coefficients(task, coefficients)
    show_plan(Console(), found)
    _write(found, **outputs)


@quietarm.command(short_help="Search the trade-off of residual and energy.")
@task_options
@click.option(
    "--method", type=click.Choice(["nsga2", "vepso"]), required=True, help="The metaheuristic."
)
@click.option("--terms", type=int, default=6, show_default=True, help="Terms of the polynomial.")
@click.option("--bound", type=float, help="Largest coefficient; required.")
@click.option(
    "--population", type=int, help="Individuals, or particles a swarm; the paper's by default."
)
@click.option("--generations", type=int, help="Generations; the paper's by default.")
@click.option("--seed", type=int, default=0, show_default=True, help="(First) seed.")
@click.option("--runs", type=int, default=1, show_default=True, help="Independent seeds.")
@click.option("--workers", type=int, default=1, show_default=True, help="Processes for the runs.")
@click.option("--checkpoint", type=OUTPUT, help="Write the state here every few seconds.")
@click.option("--resume", type=click.Path(path_type=Path), help="Go on from this checkpoint.")
@click.option("--output", type=OUTPUT, help="Write the front here; a file a seed with --runs.")
@click.option("--figure", type=PICTURE, help="Draw the front (.png, .pdf or .svg).")
@click.option("--quiet", is_flag=True, help="Show no progress.")
def front(output: Path | None, figure: Path | None, quiet: bool, **rest: Any) -> None:
    """Search the trade-off of residual and energy with NSGA-II or VEPSO.

    \b
    Examples, the paper's settings:
      quietarm front arm-on-flexible-link --target pi/2 --duration 0.8 --bound 0.5 --method nsga2 \\
          --output front.json --figure front.png
      quietarm front single-link --target pi/6 --duration 0.8 --bound 0.2 --method vepso \\
          --runs 5 --workers 2
    """  # noqa: D301  # \b is click's: do not rewrap
    from studies.searching import run_front

    names = [
        "method", "terms", "bound", "population", "generations", "seed", "runs", "workers",
        "checkpoint", "resume",
    ]  # fmt: skip
    options = {name: rest.pop(name) for name in names}
    for path in run_front(_task(rest), options, output, figure, quiet):
        click.echo(f"wrote {path}")


@quietarm.command(short_help="Recompute the paper.")
@click.option("--output", type=FOLDER, help="Write Markdown, CSV and pictures to this folder.")
@click.option(
    "--seeds",
    type=int,
    default=1,
    show_default=True,
    help="Seeds of VEPSO and NSGA-II; 5 give medians and quartiles.",
)
@click.option("--quiet", is_flag=True, help="Show no progress.")
def reproduce(output: Path | None, seeds: int, quiet: bool) -> None:
    """Recompute the paper's Tables 2, 3, 5 and 6 beside the printed figures, and its claims.

    \b
    Example:
      quietarm reproduce --output results
    """  # noqa: D301  # \b is click's: do not rewrap
    from studies.claims import claims
    from studies.progress import progress
    from studies.reproduce import amount_of_work
    from studies.reproduce import reproduce as recompute
    from studies.reproduce_report import show, write

    with progress(amount_of_work(seeds), Console(stderr=True), quiet=quiet) as begin:
        result = recompute(begin, seeds)
    verdicts = claims(result)
    console = Console()
    show(console, result, verdicts)
    if output is not None:
        output.mkdir(exist_ok=True)
        for path in write(output, result, verdicts):
            console.print(f"wrote {path}", highlight=False, soft_wrap=True)


def _split(rest: dict[str, Any]) -> tuple[PointToPoint, dict[str, Any]]:
    """The task and the output options, from a command's shared options."""
    outputs = {name: rest.pop(name) for name in ("output", "csv_file", "sample_rate", "figure")}
    task = _task(rest)
    ticks_of_move(task.duration, outputs["sample_rate"])  # refused now rather than after the solve
    return task, outputs


def _task(rest: dict[str, Any]) -> PointToPoint:
    plant: Plant = rest.pop("plant")
    return PointToPoint(plant, **rest)


def _write(
    found: Plan, output: Path | None, csv_file: Path | None, sample_rate: float, figure: Path | None
) -> None:
    console = Console()
    if output is not None:
        found.save(output)
    if csv_file is not None:
        found.save_csv(csv_file, sample_rate)
    if figure is not None:
        from studies.figures import four_panels, save_figure

        save_figure(four_panels(found), figure)
    for path in (output, csv_file, figure):
        if path is not None:
            console.print(f"wrote {path}", highlight=False, soft_wrap=True)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command and end the process with its status.

    Parameters
    ----------
    arguments : sequence of str, optional
        The words after ``quietarm``; those of the process by default.

    Raises
    ------
    SystemExit
        0 when done, 2 for bad input, 1 where a solve failed or was interrupted.
    """
    try:
        status = quietarm.main(arguments, prog_name="quietarm", standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        status = BAD_INPUT
    except click.ClickException as error:
        status = _complain(error.format_message(), BAD_INPUT)
    except (FileFormatError, ValueError) as error:
        status = _complain(str(error), BAD_INPUT)
    except QuietarmError as error:
        status = _complain(str(error), NOT_SOLVED)
    except (KeyboardInterrupt, click.Abort):
        status = _complain("interrupted; nothing was written", NOT_SOLVED)
    except OSError as error:
        status = _complain(f"{error.filename or ''} {error.strerror or error}".strip(), NOT_SOLVED)
    sys.exit(status or 0)


def _complain(message: str, status: int) -> int:
    line = " ".join(message.split())
    click.echo(f"quietarm: {line}", err=True)
    return status


if __name__ == "__main__":
    main()
