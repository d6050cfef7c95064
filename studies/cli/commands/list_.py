"""`quietarm list`: plants with their parameters, problems, methods with their settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, Field, fields
from typing import Any

import click
from quietarm.metaheuristics import PRESETS
from quietarm.metaheuristics.problems.card import card_of
from quietarm.metaheuristics.problems.catalogue import PROBLEMS, NamedProblem
from quietarm.models import Plant, known_plants
from quietarm.ocp.checks import unknown
from quietarm.studies.cli.files import FOLDER, finish, output_option
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import command
from quietarm.studies.registry.methods import METHODS
from quietarm.studies.report.words import counted, error_words

Row = tuple[str, str]
KINDS = ("plants", "problems", "methods")


@command(
    click.Argument(["names"], nargs=-1, metavar="[plants|problems|methods|NAME]..."),
    output_option({FOLDER: "the reference fronts of the problems"}),
)
def list_(given: Given) -> None:
    """List plants, problems and methods; or one of them by its name.

    A plant comes with the value, unit, meaning and source of its parameters, a problem with its
    move and box, a method with its settings.

    \b
    Examples:
      quietarm list
      quietarm list single-link
      quietarm list plants --plant-file crane.py
      quietarm list single-link-30deg-0.8s --output fronts
      quietarm list nsga2
    """  # noqa: D301  # \b is click's: do not rewrap
    names: Sequence[str] = given.names or KINDS
    plants = known_plants() if given.plant_file is None else given.plant_file
    known = [*KINDS, *plants, *PROBLEMS, *METHODS]
    for name in names:
        if name not in known:
            raise ValueError(unknown("name", name, known))
    shown = list[str | list[Row]]()
    for name in names:
        title, rows = _table(name, plants)
        shown += [f"{title}:", [(f"  {one}", words) for one, words in rows]]
    problems = PROBLEMS if "problems" in names else [name for name in names if name in PROBLEMS]
    if given.output and not problems:
        raise ValueError("--output is for the reference fronts of problems; name one")
    for folder in given.output:
        found = {
            name: front
            for problem in map(PROBLEMS.__getitem__, problems)
            for name, front in zip(problem.tasks(), problem.fronts(), strict=True)
        }
        folder.mkdir(exist_ok=True)
        for name, front in found.items():
            front.save(folder / f"{name}.json")
        shown.append(f"wrote {counted(len(found), 'front')} to {folder}")
    finish([], *shown)


def _table(name: str, plants: Mapping[str, type[Plant]]) -> tuple[str, list[Row]]:
    """A title, then names with what they are."""
    if name == "plants":
        rows = [(one, (kind.__doc__ or "").partition("\n")[0]) for one, kind in plants.items()]
        return "plants, with `quietarm list NAME` for the parameters", rows
    if name == "problems":
        rows = [(one, _problem(problem)) for one, problem in PROBLEMS.items()]
        return "problems, each with a reference front", rows
    if name == "methods":
        rows = [(one, method.label) for one, method in METHODS.items()]
        return "methods, with `quietarm list NAME` for the settings", rows
    if name in plants:
        rows = [(entry.name, _parameter(entry)) for entry in fields(plants[name])]
        return f"{name}: --set NAME=VALUE, in SI or as 2Hz, 600mm, 200g", rows
    if name in PROBLEMS:
        return name, [("problem", _problem(PROBLEMS[name])), *_card(PROBLEMS[name])]
    if name not in PRESETS:
        return name, [("by quietarm front", METHODS[name].label)]
    preset = PRESETS[name]
    settings = [
        (one.name, f"{'-' if one.default is None else one.default}: {one.meaning}")
        for one in preset.settings
    ]
    size = ("population, generations", f"{preset.population}, {preset.generations}")
    return f"{name}: {preset.label}, {preset.source}", [size, *settings]


def _parameter(entry: Field[Any]) -> str:
    """A parameter's value, meaning and source."""
    words = "no default" if entry.default is MISSING else f"{entry.default:.5g}"
    for key, form in {"unit": " {}", "meaning": ": {}", "source": "  ({})"}.items():
        if entry.metadata.get(key, "-") not in ("", "-"):
            words += form.format(entry.metadata[key])
    return words


def _card(problem: NamedProblem) -> list[Row]:
    """What the reference front says of a problem of two objectives."""
    if problem.peak:
        return []
    card = card_of(problem.fronts()[0])
    ranges = (f"{1e3 * begin:.3g} to {1e3 * end:.3g} mm" for begin, end in card.nonconvex)
    where = f": {', '.join(ranges)}" if card.nonconvex else ""
    active = ", ".join(f"a_{i}" for i in card.active) or "none"
    return [
        ("not convex over", f"{card.nonconvex_share:.0%} of the residuals{where}"),
        ("at the bound", active),
        ("slope at its end", f"{card.still_falls:.2g} of the mean slope"),
    ]


def _problem(problem: NamedProblem) -> str:
    """The box of a problem, and what it has beyond two objectives."""
    errors = error_words(problem.task)
    limits = ", ".join(map(str, problem.task.limits))
    return ", ".join([
        f"{problem.profile.size} coefficients from {-problem.bound:g} to {problem.bound:g}",
        *([f"limits {limits}"] if limits else []),
        *([f"third objective peak {problem.peak}"] if problem.peak else []),
        *([f"the largest residual with {errors}"] if errors else []),
    ])  # fmt: skip
