"""`quietarm search`: the trade-off of residual, energy and peaks by a metaheuristic."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from quietarm.metaheuristics.methods.presets import PAPER_BOX, PRESETS
from quietarm.metaheuristics.named_method import POLISH
from quietarm.metaheuristics.run_search import SECONDS_OF_CANDIDATE
from quietarm.ocp import Front, PointToPoint, QuietarmError, SolverFailedError
from quietarm.ocp.checks import whole
from quietarm.studies.answers.read_answers import load_front
from quietarm.studies.cli.effort import refuse_endless
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.interrupted import InterruptedCommandError
from quietarm.studies.cli.options import (
    BOUND,
    METHOD_SETTING,
    NOISE,
    OBJECTIVES,
    ROBOT_PATH,
    SEED,
    TASK,
    WORKERS,
    YES,
    command,
    method_option,
    option,
    profile_options,
    progress_console,
)
from quietarm.studies.cli.outputs import (
    PICTURE,
    answer_files,
    check_page,
    ending_of,
    finish,
    output_option,
)
from quietarm.studies.cli.quantities import read_settings
from quietarm.studies.cli.types import INPUT
from quietarm.views import pictures
from quietarm.views.report.front_rows import search_lines
from quietarm.views.report.progress import search_display
from quietarm.views.report.saving import STDOUT, File

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WHERE = {
    "epsilon": "front --method",
    "weighted": "front --method",
    "multistart": "bench --methods",
}
_BY_GRADIENT = {
    name: f"{name} is by the gradient; give quietarm {line} {name}" for name, line in _WHERE.items()
} | {
    f"{name}{POLISH}": f"{name}{POLISH} is for quietarm bench; polish a front that was found by "
    "quietarm front --polish FILE"
    for name in PRESETS
}


@command(
    *TASK, *ROBOT_PATH,
    method_option(lambda: [*PRESETS], _BY_GRADIENT, "nsga2",
                  "The metaheuristic; quietarm list methods has them."),
    *profile_options(), BOUND,
    option("--population", type=int, help="Individuals, or particles in a swarm."),
    option("--generations", type=int, help="Generations."),
    OBJECTIVES, *NOISE, METHOD_SETTING, SEED,
    option("--runs", default=1,
           help="Seeds, from --seed on; each has a file, as front-seed0.json, once it is done."),
    option("--from", "start_front", type=INPUT,
           help="A front to begin with, in the first population."),
    WORKERS, YES,
    output_option({".json": "the front", ".csv": "its points", PICTURE: "a picture of all fronts"},
                  formats=["front"]),
)  # fmt: skip
def search(given: Given) -> None:
    """Find the trade-off of residual, energy and peaks with a metaheuristic, without derivatives.

    \b
    Examples; nsga2-paper and vepso have the paper's settings:
      quietarm search arm-on-flexible-link --target pi/2 --duration 0.8 --bound 0.5 \\
          --output front.json --output front.png
      quietarm search single-link --target pi/6 --duration 0.8 --bound 0.2 --method vepso \\
          --runs 5 --workers 2 --output front.json --output fronts.png
      quietarm search single-link --target pi/6 --duration 0.8 --bound 0.2 --method smsemoa \\
          --population 100 --generations 200 --setting crossover=0.7
      quietarm search single-link --target pi/6 --duration 0.8 --bound 0.2 --method nsga3 \\
          --objectives residual,energy,peak-torque --output front.json --output front.png
      quietarm search single-link --target pi/6 --duration 0.8 --bound 0.2 --noise 1% \\
          --reevaluate 5
    """  # noqa: D301  # \b is click's: do not rewrap
    several = given.runs > 1
    if several and STDOUT in given.output:
        raise ValueError("--output - is for one run; with --runs give the name of a file")
    check_page(given.output, given.objectives)
    # not at the top: --help needs it not
    from quietarm.metaheuristics.parallel import LostWorkersError, side_by_side

    task = given.read_task()
    profile = given.read_profile(task)
    chosen = ("bound", "population", "generations", "objectives", "noise", "reevaluate")
    options = given.pick(*chosen) | {
        "profile": profile,
        "settings": read_settings(given.settings),
        "start": None if given.start_front is None else load_front(given.start_front),
    }
    if given.bound is None and profile.default_bound is None:
        papers = ", ".join(f"{box:g} for {plant}" for plant, box in PAPER_BOX.items())
        raise click.UsageError(
            f"Missing option '--bound', the largest size of a coefficient (the paper's: {papers})"
        )
    workers = given.workers
    first = whole("seed", given.seed, 0)
    seeds = range(first, first + whole("runs", given.runs, 1, 10_000))
    preset = PRESETS[given.method]
    population = given.population or preset.population
    generations = given.generations or preset.generations
    of_run = preset.evaluations(population, generations, len(given.objectives))
    candidates = len(seeds) * of_run * given.reevaluate
    refuse_endless(candidates, "candidates", SECONDS_OF_CANDIDATE, yes=given.yes)
    fronts = list[Front]()
    trouble: QuietarmError | None = None
    with search_display(progress_console()) as display:
        if not several and workers == 1:
            options["report"] = display
        try:
            run = partial(_search, task, given.method, options)
            for front in side_by_side(run, seeds, workers):
                fronts.append(front)
                if several:
                    _save_at_once(given.output, front)
                display.finish(front)
        except (KeyboardInterrupt, LostWorkersError) as error:
            if not fronts:
                raise
            done = f"{len(fronts)} of {given.runs} seeds are done and kept"
            if isinstance(error, KeyboardInterrupt):
                trouble = InterruptedCommandError(f"interrupted: {done}", error)
            else:
                trouble = QuietarmError(f"{error}: {done}")
    fronts.sort(key=lambda front: front.record.seed or 0)
    if not any(front.points for front in fronts):
        raise trouble or SolverFailedError(f"{given.method}: {fronts[0].why_empty()}")
    finish(
        _files(given.output, fronts, several),
        *search_lines(fronts),
        *given.remarks,
        trouble=trouble,
    )


def _search(task: PointToPoint, method: str, options: dict[str, Any], seed: int) -> Front:
    from quietarm.metaheuristics import search

    return search(task, algorithm=method, seed=seed, **options)


def _save_at_once(output: Sequence[Path], front: Front) -> None:
    """Write the files of a seed as soon as it is done: what is killed later does not lose it.

    What cannot be written is tried again at the end, and said there.
    """
    if not front.points:
        return
    without_pictures = [path for path in output if ending_of(path) != PICTURE]
    for path, write in _files(without_pictures, [front], several=True):
        with suppress(ValueError, OSError):
            write(path)


def _files(output: Sequence[Path], fronts: Sequence[Front], several: bool) -> list[File]:
    """Every front as JSON and CSV, of several seeds with the seed in the name; one picture."""
    drawn = [path for path in output if ending_of(path) == PICTURE]
    tables = [path for path in output if path not in drawn]

    def draw() -> Figure:
        return pictures.front_figure(fronts)  # what draws is loaded only here

    files = list[File]()
    for front in fronts:
        seed = f"-seed{front.record.seed}" if several else ""
        files += answer_files([path.with_stem(path.stem + seed) for path in tables], draw, front)
    return [*files, *answer_files(drawn, draw)]
