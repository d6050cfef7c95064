"""Jobs of a bench, made of what it is asked for."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from quietarm.metaheuristics import PRESETS, PROBLEMS, Job, NamedProblem, problem_of
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.ocp import Front
from quietarm.ocp.checks import whole
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.record import Setting

ALL = "all"


def spell_method(typed: str) -> str:
    """A method's name, however it was spelt, and what follows: NSGA-II+polish is nsga2+polish."""
    return NamedMethod.of_typed(typed, PRESETS)


def problems_of(
    names_or_files: Sequence[str], objectives: tuple[str, ...] | None = None
) -> list[NamedProblem]:
    """Problems by name, or by the file of a front; `all` are those with two objectives.

    With other objectives than its own a problem has another name, and no reference front yet:
    `with_references` finds it.
    """
    problems = list[NamedProblem]()
    for name in names_or_files:
        if name == ALL:
            problems += [problem for problem in PROBLEMS.values() if len(problem.objectives) == 2]
        elif name in PROBLEMS or not Path(name).exists():
            problems.append(problem_of(name))
        else:
            problems.append(NamedProblem.of_front(Path(name).stem, Front.load(name)))
    if objectives is not None:
        problems = [_with_objectives(problem, objectives) for problem in problems]
    names = [problem.name for problem in problems]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"the problem {name} is given twice; give it once")
    return problems


def with_references(
    problems: Sequence[NamedProblem], folder: Path | None = None
) -> list[NamedProblem]:
    """Give every problem a reference front: its own, that of the folder, or a new one.

    A new front takes seconds, by the gradient: it is found once, not in every worker. ValueError
    where the reference is a single motion.
    """
    referenced = list[NamedProblem]()
    for problem in problems:
        if problem.reference_front is None and not problem.named:
            front = _front_in(folder, problem) or problem.front()
            problem = replace(problem, reference_front=front)
        problem.reference()  # refuses a single motion
        referenced.append(problem)
    return referenced


def _front_in(folder: Path | None, problem: NamedProblem) -> Front | None:
    """The reference front of a problem that a folder holds, if it is of this problem."""
    if folder is None or not _reference_path(folder, problem).exists():
        return None
    front = Front.load(_reference_path(folder, problem))
    fits = (front.task, front.objectives) == (problem.task, problem.objectives)
    return front if fits else None


def _with_objectives(problem: NamedProblem, objectives: tuple[str, ...]) -> NamedProblem:
    """A problem with these objectives, without a reference front if they are not its own."""
    if problem.objectives == objectives:
        return problem
    peaks = [name.replace("_", "-") for name in objectives[len(RESIDUAL_AND_ENERGY) :]]
    return replace(
        problem,
        name="-".join([problem.name, *(peaks or ["two-objectives"])]),
        objectives=objectives,
        peak_limits=(),
        reference_front=None,
    )


def _reference_path(folder: Path, problem: NamedProblem) -> Path:
    return folder / "references" / f"{problem.name}.json"


def jobs_of(
    problems: Sequence[NamedProblem],
    methods: Sequence[str],
    runs: int,
    evaluations: int | None,
    seed: int = 0,
    settings: Mapping[str, Setting] | None = None,
    noise: float = 0.0,
    reevaluate: int = 1,
) -> tuple[list[Job], list[str]]:
    """The jobs, each method on each problem from one seed before the next; and what is left out.

    Searches have so many evaluations, or with None those of their presets. Settings are named with
    their method, as ``nsga2.crossover``. Methods that know no limits are left out where a problem
    has some. Noise is of the searches; words say which method has none.
    """
    stated = settings or {}
    for name in stated:
        if name.rpartition(".")[0] not in methods:
            raise ValueError(
                f"setting {name} names no method that runs; begin it with one of these and a dot: "
                f"{', '.join(methods)}"
            )
    for name in methods:
        if methods.count(name) > 1:
            raise ValueError(f"the method {name} is given twice; give it once")
    runs = whole("runs", runs, 1, 10_000)
    of_method = {
        method: {
            name.rpartition(".")[2]: stated[name]
            for name in stated
            if name.rpartition(".")[0] == method
        }
        for method in methods
    }
    jobs = list[Job]()
    left_out = dict[str, None]()
    for run_seed in range(seed, seed + runs):
        for problem in problems:
            for name in methods:
                method = NamedMethod.admitted(name, PRESETS)
                preset = PRESETS.get(method.method)
                if problem.limited and preset is not None and not preset.keeps_limits:
                    left_out[f"{name} knows no limits: left out on {problem.name}"] = None
                    continue
                unfit = preset.unfit_for(len(problem.objectives), noise) if preset else ""
                if unfit:
                    left_out[f"{unfit}: left out on {problem.name}"] = None
                    continue
                if method.by_gradient:
                    jobs.append(Job(problem, name, run_seed, None, of_method[name]))
                    if noise:
                        left_out[f"{name} has no noise: its gradient is that of the model"] = None
                    continue
                if noise and method.polish:
                    left_out[f"{name} is polished by the model's gradient, without noise"] = None
                of_search: Any = {"noise": noise, "reevaluate": reevaluate}
                settings_of_it = of_method[name]
                jobs.append(Job(problem, name, run_seed, evaluations, settings_of_it, **of_search))
    return jobs, list(left_out)


def imports_on(
    problems: Sequence[NamedProblem], runs: Mapping[Path, Front], named_files: Collection[Path]
) -> tuple[list[Front], list[str]]:
    """Imported runs, and words on those of another problem that a folder has besides.

    One that was `given` by its own name is never left out.
    """
    names = [problem.name for problem in problems]
    imported = list[Front]()
    left_out = list[str]()
    for path, front in runs.items():
        name = front.record.settings.get("problem")
        if name in names or path in named_files:
            imported.append(front)
        else:
            left_out.append(f"{path} is on {name or 'no named problem'}: left out")
    if runs and not imported:
        raise ValueError(
            f"no run to import is on {', '.join(names)} ({left_out[0]}); give their problems, too"
        )
    return imported, left_out


def write_references(problems: Sequence[NamedProblem], folder: Path) -> None:
    """Put the reference fronts into the folder, so that its files alone say everything.

    ValueError where the folder has runs that were measured against another.
    """
    for problem in problems:
        path = _reference_path(folder, problem)
        front = problem.reference().front
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            front.save(path)
        elif Front.load(path) != front:
            raise ValueError(
                f"the runs in {folder} are measured against another reference front of "
                f"{problem.name}; give another folder"
            )
