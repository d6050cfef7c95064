"""The solvers by name, the one that a record states, and which one stands in for another."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from quietarm.ocp.checks import has_no
from quietarm.ocp.record import Setting
from quietarm.ocp.solvers.ipopt import Ipopt
from quietarm.ocp.solvers.solver import NAME, Solver
from quietarm.ocp.solvers.sqp import Sqp

SOLVERS: Mapping[str, type[Solver]] = {Sqp.name: Sqp, Ipopt.name: Ipopt}
"""By the names that the command line and records have; the first is the default."""


def stand_in(solver: Solver) -> Solver | None:
    """Return IPOPT with a solver's options, to try where it fails; None if it is IPOPT."""
    return None if isinstance(solver, Ipopt) else solver.as_kind(Ipopt)


def other_solver(solver: Solver) -> Solver:
    """Return the other of the two solvers with the same options, which checks the first one."""
    return stand_in(solver) or solver.as_kind(Sqp)


STAND_IN = "stand_in"
"""What a record calls the solver that found an answer in place of the one that was asked for; an
option of it that is not the default stands beside, as stand_in_iterations."""


def stand_in_settings(
    asked: Solver, solved_by: Iterable[Mapping[str, Setting]]
) -> dict[str, Setting]:
    """Return what a record says of a stand-in, where one found some of these solutions."""
    others = (stated for stated in solved_by if stated.get(NAME, asked.name) != asked.name)
    return as_part(STAND_IN, next(others, {}))


def as_part(part: str, stated: Mapping[str, Setting]) -> dict[str, Setting]:
    """Return what a record says of a solver, by the name of the part that the solver had."""
    return {name.replace(NAME, part, 1): value for name, value in stated.items()}


def only_part(part: str, settings: Mapping[str, Setting]) -> dict[str, Setting]:
    """Return what the settings of a record say of a part that a solver had."""
    return {
        name: value
        for name, value in settings.items()
        if name == part or name.startswith(f"{part}_")
    }


def without_part(part: str, settings: Mapping[str, Setting]) -> dict[str, Setting]:
    """Return the settings of a record without what they say of a part that a solver had."""
    of_part = only_part(part, settings)
    return {name: value for name, value in settings.items() if name not in of_part}


def stated_solver(settings: Mapping[str, Setting]) -> Solver | None:
    """The solver that the settings of a record state; None where they state none.

    ValueError where they state an option that it does not have, or one out of range.
    """
    kind = SOLVERS.get(str(settings.get(NAME)))
    if kind is None:
        return None
    names = {entry.setting: entry.name for entry in kind.stated_options()}
    options = dict[str, Any]()
    for setting, value in settings.items():
        if setting.startswith(f"{NAME}_"):
            if setting not in names:
                raise ValueError(has_no(kind.name, "setting", setting, names))
            options[names[setting]] = value
    return kind(**options)
