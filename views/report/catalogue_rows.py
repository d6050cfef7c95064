"""Rows of what there is to choose from: plants, problems and methods, and each by itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, Field
from typing import Any

from quietarm.metaheuristics import PRESETS
from quietarm.metaheuristics.methods.gradient_methods import gradient_settings, solver_settings
from quietarm.metaheuristics.methods.settings import MethodSetting
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.metaheuristics.problems.card import card_of
from quietarm.metaheuristics.problems.catalogue import (
    PROBLEMS,
    NamedProblem,
    drawn_problems,
    problem_of,
)
from quietarm.metaheuristics.problems.drawn_moves import drawn_groups, drawn_moves
from quietarm.models import Plant, RobotOnPath
from quietarm.ocp import AbsolutePower
from quietarm.ocp.checks import spelling, unknown
from quietarm.ocp.figures import ENERGY
from quietarm.ocp.limits import QUANTITIES, RESIDUAL
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, known_objectives
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.views.report.method_rows import GRADIENT_LABELS, label_of
from quietarm.views.report.words import counted, error_words, objective_words, window_words

Row = tuple[str, str]
ROBOT_FILE = "A robot of a URDF that follows a path; PLANT is its file, such as ur5.yaml."
KINDS = ("plants", "problems", "drawn", "methods", "objectives")
"""Kinds that are listed; `drawn` are the problems of docs/results."""
BY_GRADIENT = "the gradient finds a reference front when one is asked for, in seconds"


def catalogue_rows(name: str, plants: Mapping[str, type[Plant]]) -> tuple[str, list[Row]]:
    """A title, and rows of one of `KINDS` or of an entry by its name; ValueError of no other."""
    known = [*KINDS, *plants, *PROBLEMS, *drawn_problems()]
    spelt = {spelling(name): name for name in known}
    if spelling(name) not in spelt:
        return _method_rows(name, known)
    name = spelt[spelling(name)]
    if name == "plants":
        rows = [
            (plant, ROBOT_FILE if kind is RobotOnPath else (kind.__doc__ or "").partition("\n")[0])
            for plant, kind in plants.items()
        ]
        said = f"{counted(len(rows), 'plant')}; `quietarm list NAME` has the parameters of one"
        return said, rows
    if name == "problems":
        rows = [(label, _problem(problem)) for label, problem in PROBLEMS.items()]
        windows = {window_words(problem.task.residual_window) for problem in PROBLEMS.values()}
        said = f"{counted(len(rows), 'problem')}, each with a tested reference front"
        if len(windows) == 1:
            said += f"; residuals {windows.pop()}"
        else:
            rows = [(label, f"{words}, {_window(PROBLEMS[label])}") for label, words in rows]
        return said, rows
    if name == "drawn":
        return drawn_rows(names=True)
    if name == "methods":
        rows = [(method, f"{label_of(method)}, by the gradient") for method in GRADIENT_LABELS]
        rows += [(method, f"{label_of(method)}: {PRESETS[method].source}") for method in PRESETS]
        said = f"{counted(len(rows), 'method')}; `quietarm list NAME` has the settings of one"
        return said, rows
    if name == "objectives":
        names = known_objectives()
        rows = [(objective_words([name]), _objective(name)) for name in names]
        said = f"{counted(len(rows), 'objective')} for --objectives of search, front and bench"
        return said, rows
    if name in plants:
        rows = [(entry.name, _parameter(entry)) for entry in plants[name].parameter_fields()]
        many = counted(len(rows), "parameter")
        return f"{name} has {many}: --set NAME=VALUE, in SI or such as 2Hz, 600mm, 200g", rows
    problem = problem_of(name)
    words = f"{_problem(problem)}, {_window(problem)}"
    task = problem.task
    move = f"{task.plant.name}, {task.ends} in {task.duration:g} s"
    if name not in PROBLEMS:
        rows = [("problem", words), ("energy", task.energy.name), ("reference front", BY_GRADIENT)]
        return f"{name}: {move}, a random move of docs/results", rows
    return f"{name}: {move}, with a tested reference front", [("problem", words), *_card(problem)]


def drawn_rows(*, names: bool) -> tuple[str, list[Row]]:
    """A title, and rows of the drawn problems by what their names end in, with all names or not."""
    rows = list[Row]()
    for ending, group in drawn_groups().items():
        move = drawn_moves()[group[0]]
        limits = [quantity.removesuffix("_limit") for quantity in move.limits or ()]
        objectives = (*RESIDUAL_AND_ENERGY, *move.peaks)
        words = ", ".join([
            counted(len(group), "move"),
            counted(move.terms, "coefficient"),
            *([f"energy {move.energy.name}"] if move.energy != AbsolutePower() else []),
            *([f"limits {' and '.join(limits)}"] if limits else []),
            *([f"objectives {objective_words(objectives)}"] if move.peaks else []),
        ])  # fmt: skip
        rows.append((f"MOVE{ending}", f"{words}: {', '.join(group)}" if names else words))
    total = sum(map(len, drawn_groups().values()))
    every = "" if names else "; `quietarm list drawn` has all names"
    return f"{counted(total, 'problem')} of docs/results; {BY_GRADIENT}{every}", rows


def _method_rows(typed: str, others: Sequence[str]) -> tuple[str, list[Row]]:
    """A title, and the settings of a method by its name; ValueError where there is none."""
    name = NamedMethod.of_typed(typed, PRESETS)
    named = NamedMethod.read(name)
    if not (named.by_gradient or named.method in PRESETS):
        raise ValueError(unknown("name", typed, [*others, *GRADIENT_LABELS, *PRESETS]))
    named = NamedMethod.admitted(name, PRESETS)
    if named.by_gradient:
        title = f"{name}: {label_of(name, solver=Sqp.name)}, by the gradient"
        return title, list(map(_setting, gradient_settings(named)))
    preset = PRESETS[named.method]
    size = ("population, generations", f"{preset.population}, {preset.generations}")
    settings = {setting.name: setting for setting in preset.settings}
    if named.polish:
        settings = {setting.name: setting for setting in solver_settings()} | settings
    return f"{name}: {label_of(name)}, {preset.source}", [size, *map(_setting, settings.values())]


def _setting(setting: MethodSetting) -> Row:
    """A setting's default and meaning."""
    default = "-" if setting.default is None else setting.default
    meaning = setting.meaning.removesuffix(".")
    return setting.name, f"{default}: {meaning[:1].lower()}{meaning[1:]}"


def _objective(name: str) -> str:
    """Say what an objective is."""
    figure = known_objectives()[name]
    if figure.quantity:
        label = QUANTITIES[figure.quantity].label
        return f"the largest {label} during the move [{figure.unit}]"
    words = {
        RESIDUAL: "the largest tip displacement after arrival",
        ENERGY: "the energy of the drive",
    }
    return f"{words[name]} [{figure.unit}], of every front"


def _parameter(entry: Field[Any]) -> str:
    """A parameter's value, meaning and source."""
    words = "no default" if entry.default is MISSING else f"{entry.default:.5g}"
    for key, form in {"unit": " {}", "meaning": ": {}", "source": "  ({})"}.items():
        if entry.metadata.get(key, "-") not in ("", "-", "count"):
            words += form.format(entry.metadata[key])
    return words


def _card(problem: NamedProblem) -> list[Row]:
    """Return rows of what the reference front says of a problem of two objectives."""
    if len(problem.objectives) > 2:  # a card is of a curve
        return []
    card = card_of(problem.fronts()[0])
    ranges = (f"{_millimetres(begin)} to {_millimetres(end)} mm" for begin, end in card.nonconvex)
    where = f": {', '.join(ranges)}" if card.nonconvex else ""
    active = ", ".join(f"a_{i}" for i in card.active) or "none"
    return [
        ("not convex over", f"{card.nonconvex_share:.0%} of the residuals{where}"),
        ("at the bound", active),
        ("slope at its end", f"{card.still_falls:.2g} of the mean slope"),
    ]


def _millimetres(length: float) -> str:
    """Return a length [m] in mm; less than a thousandth of one is 0."""
    return "0" if length < 1e-6 else f"{1e3 * length:.3g}"


def _problem(problem: NamedProblem) -> str:
    """Return the bounds of a problem, and what it has beyond two objectives."""
    errors = error_words(problem.task)
    limits = ", ".join(map(str, problem.task.limits))
    return ", ".join([
        f"{problem.profile.size} coefficients from {-problem.bound:g} to {problem.bound:g}",
        *([f"limits {limits}"] if limits else []),
        *([f"objectives {objective_words(problem.objectives)}"] * (len(problem.objectives) > 2)),
        *([f"the largest residual with {errors}"] if errors else []),
    ])  # fmt: skip


def _window(problem: NamedProblem) -> str:
    return f"residuals {window_words(problem.task.residual_window)}"
