"""`quietarm search`: the trade-off of residual, energy and peaks by a metaheuristic."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from quietarm.metaheuristics.methods.presets import PAPER_BOX, PRESETS
from quietarm.metaheuristics.named_method import POLISH
from quietarm.metaheuristics.search_run import (
    SECONDS_OF_CANDIDATE,
    SearchRun,
    default_of_function,
)
from quietarm.metaheuristics.search_state import KeptValues, StateError
from quietarm.ocp import Front, PointToPoint, QuietarmError, SolverFailedError
from quietarm.ocp.checks import whole
from quietarm.ocp.objectives import checked_objectives
from quietarm.studies.answers.read_answers import load_front
from quietarm.studies.cli.effort import refuse_endless
from quietarm.studies.cli.function_file import FunctionOfFile
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.interrupted import InterruptedCommandError
from quietarm.studies.cli.options import (
    BOUND,
    METHOD_SETTING,
    NOISE,
    ROBOT_PATH,
    SEED,
    TASK,
    WORKERS,
    YES,
    command,
    method_option,
    objectives_option,
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
from quietarm.studies.cli.quantities import parse_sides, read_settings
from quietarm.studies.cli.types import INPUT, NAMES, Parsed
from quietarm.views import pictures
from quietarm.views.report.front_rows import search_lines
from quietarm.views.report.function_rows import function_lines
from quietarm.views.report.progress import search_display
from quietarm.views.report.saving import STDOUT, File
from quietarm.views.report.words import counted

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
    option("--function", type=Parsed("FILE.py:NAME", FunctionOfFile.read), metavar="FILE.py:NAME",
           help="In place of PLANT: your own function of candidates, such as a simulator. The "
           "file is run: give one that you trust. Its attributes `units`, `reference` and "
           "`vectorized` count as well."),
    *profile_options(), BOUND,
    option("--lower", type=Parsed("numbers", parse_sides), metavar="A,B,...",
           help="Of --function: the least of each coefficient, such as --lower=-1,-1,0. [default: "
           "its attribute `lower`]"),
    option("--upper", type=Parsed("numbers", parse_sides), metavar="A,B,...",
           help="The same for the largest, or one number for all."),
    option("--population", type=int, help="Individuals, or particles in a swarm."),
    option("--generations", type=int, help="Generations."),
    option("--evaluations", type=int, help="Candidates in all, in place of generations."),
    objectives_option(NAMES.parse, " Of --function: the names of what it returns, such as "
                      "sway,cost; else its attribute `objectives` counts."),
    option("--constraints", type=NAMES, metavar="NAME,NAME,...",
           help="Of --function: names of the violations that it returns beside the objectives, "
           "such as touch. [default: its attribute `constraints`]"),
    option("--state", type=INPUT, metavar="FILE",
           help="Of --function: write each of its results to this file. After a kill, Ctrl-C or an "
           "error, type the same command again: it takes finished results from the file. Give "
           "another file if you change the function."),
    *NOISE, METHOD_SETTING, SEED,
    option("--runs", default=1,
           help="Seeds, from --seed on; each has a file, such as front-seed0.json, once it is "
                "done."),
    option("--from", "start_front", type=INPUT,
           help="A front to begin with, in the first population."),
    WORKERS,
    option("--threads", default=1, help="Candidates that are evaluated at the same time in a "
           "process, such as calls of --function that wait; of a move, blocks of them."),
    YES,
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
      quietarm search --function simulator.py:measure --lower=-1,-1 --upper 1 --evaluations 200
    """  # noqa: D301  # \b is click's: do not rewrap
    several = given.runs > 1
    if several and STDOUT in given.output:
        raise ValueError("--output - is for one run; with --runs give the name of a file")
    # not at the top: --help needs it not
    from quietarm.metaheuristics.parallel import side_by_side

    asked = _function(given) if given.function else _move(given)
    options = given.pick(
        "population", "generations", "evaluations", "noise", "reevaluate", "threads"
    ) | {
        "settings": read_settings(given.settings),
        "start": None if given.start_front is None else load_front(given.start_front),
    }
    asked.options.update(options)
    method = asked.method
    workers = given.workers
    first = whole("seed", given.seed, 0)
    seeds = range(first, first + whole("runs", given.runs, 1, 10_000))
    preset = PRESETS[method]
    population = given.population or preset.population
    generations = given.generations or preset.generations
    count = len(given.objectives)
    of_run = given.evaluations or preset.evaluations(population, generations, count)
    candidates = len(seeds) * of_run * given.reevaluate
    if not given.function:  # how long a user's own takes nobody knows
        refuse_endless(candidates, "candidates", SECONDS_OF_CANDIDATE, yes=given.yes)
    fronts = list[Front]()
    stopped = list[Front]()
    trouble: BaseException | None = None
    with search_display(progress_console(), of_function=bool(given.function)) as display:
        if not several and workers == 1:
            asked.options["report"] = display
        try:
            run = partial(_search, asked)
            for front in side_by_side(run, seeds, workers):
                fronts.append(front)
                asked.run = None
                if several:
                    _save_at_once(given.output, front)
                display.finish(front)
        except StateError:
            raise  # what was written before stays: nothing new was found
        except (Exception, SystemExit, KeyboardInterrupt) as error:
            stopped = asked.until_the_stop()
            kept = _kept_words(fronts, stopped, given.runs, is_written=bool(given.output))
            words = "; ".join(filter(None, [kept, asked.state_words()]))
            if not words:
                raise
            trouble = _trouble(error, words)
            if not kept:
                raise trouble from None
    fronts.sort(key=lambda front: front.record.seed or 0)
    shown = fronts or stopped  # no statistics of seeds with one that was cut short
    if not any(front.points for front in shown):
        raise trouble or SolverFailedError(f"{method}: {shown[0].why_empty()}")
    finish(
        _files(given.output, [*fronts, *stopped], several),
        *(function_lines(shown) if given.function else search_lines(shown)),
        *asked.remarks,
        *given.remarks,
        trouble=trouble,
    )


@dataclass
class _Asked:
    """A search that is asked for: of a task or a file's function, its method, options of both.

    `run` is the search that goes on in this process, if one does.
    """

    what: PointToPoint | FunctionOfFile
    method: str
    options: dict[str, Any]
    run: SearchRun | None = None
    remarks: list[str] = field(default_factory=list[str])

    def begin(self, run: SearchRun) -> None:
        """Take note of the search that begins, and of results that a file has from before."""
        self.run = run
        if kept := self._kept():
            resumed = counted(kept.resumed, "result")
            self.remarks += [f"{resumed} from {kept.path}"] * (kept.resumed > 0)

    def state_words(self) -> str:
        """Say what the file of a search that was stopped has; nothing without a file."""
        kept = self._kept()
        if not kept or not kept.count:
            return ""
        return f"{kept.path} has {counted(kept.count, 'result')}, type the same command to go on"

    def _kept(self) -> KeptValues | None:
        """The values in a file, of a function with one."""
        return None if self.run is None else getattr(self.run.function.asked, "kept", None)

    def until_the_stop(self) -> list[Front]:
        """Return the front of the candidates of the search that was stopped, if it has one."""
        if self.run is None or not self.run.function.archive.evaluations:
            return []
        front = self.run.front()
        return [front] if front.points else []


def _trouble(error: BaseException, words: str) -> BaseException:
    """Return what stopped a search, with words on what is kept; its exit status stays."""
    if isinstance(error, KeyboardInterrupt):
        return InterruptedCommandError(f"interrupted: {words}", error)
    if isinstance(error, ValueError):  # of the user's function, as a rule
        return ValueError(f"{error}; {words}")
    if isinstance(error, QuietarmError):
        return QuietarmError(f"{error}: {words}")
    return error


def _kept_words(
    fronts: Sequence[Front], stopped: Sequence[Front], runs: int, *, is_written: bool
) -> str:
    """Say what is left of a search that was stopped: 3 of 5 seeds, the front of 80 candidates."""
    if not (fronts or stopped):
        return ""
    several = runs > 1
    kept = [counted(len(fronts), "front")] if fronts else []
    kept += [
        f"the front of the first {counted(front.record.evaluations, 'candidate')}"
        f"{f' of seed {front.record.seed}' if several else ''}"
        for front in stopped
    ]
    done = f"{len(fronts)} of {runs} seeds are done; " if several else ""
    verb = "is" if len(fronts) + len(stopped) == 1 else "are"
    written = "written" if is_written else "shown and not written"
    return f"{done}{' and '.join(kept)} {verb} {written}"


def _move(given: Given) -> _Asked:
    """The move that was typed, with its profile and its bounds."""
    given.refuse(["lower", "upper"], "is for --function, and this is a move with a --bound")
    given.refuse(["constraints"], "is for --function, and a move has limits")
    given.refuse(["state"], "is for --function, and a search of a move is soon done again")
    try:
        objectives = checked_objectives(given.objectives)
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="'--objectives'") from None
    check_page(given.output, objectives)
    task = given.read_task()
    profile = given.read_profile(task)
    if given.bound is None and profile.default_bound is None:
        papers = ", ".join(f"{bound:g} for {plant}" for plant, bound in PAPER_BOX.items())
        raise click.UsageError(
            f"Missing option '--bound', the largest size of a coefficient (the paper's: {papers})"
        )
    options = {"profile": profile, "objectives": objectives, **given.pick("bound")}
    return _Asked(task, given.method, options)


_OF_FUNCTIONS = (
    "function", "lower", "upper", "objectives", "constraints", "state", "method", "population",
    "generations", "evaluations", "noise", "reevaluate", "settings", "seed", "runs", "start_front",
    "workers", "threads", "yes", "output", "quiet", "plant_file",
)  # fmt: skip
"""Options that a function has."""


def _function(given: Given) -> _Asked:
    """The function that was typed; its file is run."""
    given.refuse_others(
        _OF_FUNCTIONS, "is for a move, and --function is a function alone, with its own attributes"
    )
    for path in given.output:
        if ending_of(path) not in (".json", ".csv", PICTURE):
            raise ValueError(
                f"{path} is for a front of a move; of a function give a .json, .csv or a picture"
            )
    function = given.function.load()  # what is wrong with the file is said before anything else
    for side in ("lower", "upper"):
        if given.pick(side)[side] is None and getattr(function, side, None) is None:
            raise click.UsageError(
                f"Missing option '--{side}', a number for each coefficient, such as "
                f"--{side}={'-1,-1' if side == 'lower' else '1,1'}; or set {side} as an attribute "
                f"of {given.function.name}"
            )
    if given.evaluations is None and given.generations is None:
        raise click.UsageError(
            "Missing option '--evaluations', the number of candidates, such as 1000: a function "
            "may take long"
        )
    method = (
        given.method
        if given.typed("method")
        else default_of_function(
            given.evaluations, given.population or given.generations or given.start_front
        )
    )
    if given.state is not None:
        given.refuse(
            ["generations", "noise", "start_front", "runs", "workers"],
            "is not for a search with a --state",
        )
    options = given.pick("lower", "upper", "constraints", "state")
    if given.typed("objectives"):  # else the function's own
        options |= given.pick("objectives")
    return _Asked(given.function, method, options)


def _search(asked: _Asked, seed: int) -> Front:
    from quietarm.metaheuristics import search

    what: Any = asked.what.load() if isinstance(asked.what, FunctionOfFile) else asked.what
    return search(what, algorithm=asked.method, seed=seed, begun=asked.begin, **asked.options)


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
