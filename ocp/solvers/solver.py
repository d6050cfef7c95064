"""Solvers as values that users pass: a name and options."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from numbers import Integral
from typing import Any, ClassVar, Literal, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import finite, positive, quoted, whole
from quietarm.ocp.record import Setting
from quietarm.ocp.solvers.problem import Program, Solution

NAME = "solver"
"""What a record calls it; an option that is not the default stands beside, as solver_tolerance."""
_OPTION = "option"
"""Metadata of a field that is an option."""
S = TypeVar("S", bound="Solver")


class Option(NamedTuple):
    """Facts about a field of a solver, from which commands, records and files make an option.

    Attributes
    ----------
    meaning : str
        What it is, in the words of a command's help.
    check : callable, optional
        Takes what a message calls the option, and a value; returns the value, or raises ValueError.
    word, unit : str
        What a number of it is, as "a share", and its unit on the command line.
    stated : bool
        Whether an answer depends on it: then records state it, and commands have it.
    name, kind, default
        Those of the field.
    """

    meaning: str
    check: Callable[[str, Any], Any] | None = None
    word: str = "number"
    unit: str = "-"
    stated: bool = True
    name: str = ""
    kind: Any = float
    default: Setting = None

    @property
    def setting(self) -> str:
        """Name of the option in a record, such as solver_tolerance."""
        return f"{NAME}_{self.name}"

    @property
    def words(self) -> tuple[str, ...]:
        """The words of which it is one; empty for a number or a flag."""
        return get_args(self.kind) if get_origin(self.kind) is Literal else ()

    def checked(self, value: Any) -> Any:
        """The value; ValueError where it is not of the kind of its field, or out of range.

        The default may be out of range: as None, or infinite, it stands for no bound.
        """
        name = f"{self.name.replace('_', ' ')} of the solver"
        if type(value) is type(self.default) and value == self.default:
            return value
        if self.words and value not in self.words:
            raise ValueError(f"{name} is {quoted(value)}; give {' or '.join(self.words)}")
        if self.kind is bool and not isinstance(value, bool):
            raise ValueError(f"{name} is {quoted(value)}; give True or False")
        if self.check is not None:
            return self.check(name, value)
        if self.kind is int and (isinstance(value, bool) or not isinstance(value, Integral)):
            raise ValueError(f"{name} is {quoted(value)}; give a whole number")
        return finite(name, value) if self.kind is float else value


def _without_none(kind: Any) -> Any:
    """The kind of an option that may also be None."""
    kinds = [other for other in get_args(kind) if other is not type(None)]
    return kinds[0] if type(None) in get_args(kind) and len(kinds) == 1 else kind


def option(default: Setting, meaning: str, check: Any = None, **others: Any) -> Any:
    """A field of a solver that is an option of it, with the entries of `Option`."""
    return field(default=default, metadata={_OPTION: Option(meaning, check, **others)})


@dataclass(frozen=True)
class Solver:
    """A solver and its options: `Sqp` or `Ipopt`.

    The same value is taken wherever a solver is chosen, and what is tried where it fails has its
    options as well, as far as it has such options. An option is a field, made by `option`, of the
    solver that has it; what all have stand here.

    Parameters
    ----------
    tolerance : float
        Share of the objective that a solution may be above its minimum, as the last step predicts
        it. Limits and rest on arrival are kept as exactly as ever.
    iterations : int
        Most iterations of one solve.
    log : bool
        Whether a line is printed for each iteration.

    Raises
    ------
    ValueError
        When an option is out of range.
    """

    example: ClassVar[str] = "a solver, such as Sqp() or Ipopt(tolerance=1e-7)"
    name: ClassVar[str]

    tolerance: float = option(
        1e-9,
        "Share of the least energy that the solver may leave, of every solve; limits and rest on "
        "arrival are kept as exactly as ever.",
        partial(positive, most=0.01, why="it is a share"),
        word="share",
    )
    iterations: int = option(
        500,
        "Most iterations of the solver, in one solve from one start.",
        partial(whole, least=1, most=1_000_000),
    )
    log: bool = option(False, "Print a line for each iteration.", stated=False)

    def __post_init__(self) -> None:
        for entry in self.options():
            value = entry.checked(getattr(self, entry.name))
            object.__setattr__(self, entry.name, value)

    @classmethod
    def options(cls) -> list[Option]:
        """List the options of the solver, in the order of its fields."""
        kinds = get_type_hints(cls)
        return [
            entry.metadata[_OPTION]._replace(
                name=entry.name, kind=_without_none(kinds[entry.name]), default=entry.default
            )
            for entry in fields(cls)
            if _OPTION in entry.metadata
        ]

    @classmethod
    def stated_options(cls) -> list[Option]:
        """List the options on which an answer depends."""
        return [entry for entry in cls.options() if entry.stated]

    def solve(
        self,
        problems: Sequence[Program],
        starts: Sequence[NDArray[np.float64]],
        *,
        warm: bool = False,
        groups: Sequence[int] | None = None,
    ) -> list[Solution]:
        """Solve each problem from its start.

        Parameters
        ----------
        problems : sequence of Program
            Of any tasks, steps, limits and objectives.
        starts : sequence of ndarray, each of shape (profile.size,)
            Coefficients to start from.
        warm : bool
            Whether the starts are beside minima.
        groups : sequence of int, optional
            Problems of one number are one problem from several starts: a solver may stop the others
            once half of them, and more than one, agree on the least objective.

        Returns
        -------
        list of Solution
            In the order of the problems.
        """
        raise NotImplementedError

    @property
    def stated(self) -> dict[str, Setting]:
        """Entries of a record about this solver: its name, and options that are not the default."""
        options = {
            entry.setting: getattr(self, entry.name)
            for entry in self.stated_options()
            if getattr(self, entry.name) != entry.default
        }
        return {NAME: self.name, **options}

    def as_kind(self, kind: type[S]) -> S:
        """A solver of another kind with the options of this one, as far as it has them."""
        known = {entry.name for entry in kind.options()}
        shared = [entry.name for entry in self.options() if entry.name in known]
        return kind(**{name: getattr(self, name) for name in shared})
