"""A user's own function as a problem: any simulator, or a machine that is measured."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.evaluation.population import UNUSABLE, replace_failures
from quietarm.metaheuristics.problems.problem_function import ProblemFunction, Rows
from quietarm.metaheuristics.search_state import KeptValues
from quietarm.ocp import Front
from quietarm.ocp.checks import clipped, numbers, quoted, table_of, whole, words_of_error
from quietarm.ocp.front.function_front import (
    FunctionEntries,
    FunctionFront,
    FunctionPoint,
    ordered_points,
)
from quietarm.ocp.front.points import Entries, FrontPoint
from quietarm.ocp.front.searched_function import SearchedFunction
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.record import Record

Array = NDArray[np.float64]
Function = Callable[..., Any]
Keep = Callable[[int, Array, Array], None]
"""Called with candidates that were evaluated: the place of the first, them and their values."""
ALL_FAILED = 20
"""A function that gives no finite number for so many first candidates is refused."""


class FunctionFailedError(ValueError):
    """A user's own function raises an error, which is the cause of this one."""


class GivenFunction(ProblemFunction):
    """A user's own function of candidates, with its bounds and the names of what it returns.

    The function runs in this process, with all that its author wrote into it.

    Parameters
    ----------
    function : callable
        Of many candidates, an array of shape (candidates, coefficients), to their objectives, an
        array of shape (candidates, objectives); or of one candidate, a row, to its objectives. With
        constraints it returns a pair: the objectives, and the violations in the same form, positive
        where a constraint is broken. What is not finite counts as failed.
    lower, upper : array_like, optional
        The box, a number for each coefficient; one of them may be a single number.
    objectives : sequence of str
        Names of what is minimised, two at least.
    units : sequence of str, optional
        Unit of each; m and J of residual and energy by default, and none of others.
    constraints : sequence of str
        Names of the violations.
    reference : sequence of float, optional
        The corner that hypervolumes are measured from; by default the largest values of candidates
        that no earlier one dominated.
    vectorized : bool, optional
        Whether it takes many candidates at once. Where this is not said, the function is called
        with one candidate first; an array of candidates follows where it returns rows, or where it
        fails as functions of arrays do, with an IndexError, a TypeError or a ValueError. So no
        candidate that was evaluated is evaluated again; a first call that fails is no evaluation.
    threads : int
        Calls at the same time: of blocks of candidates, or of candidates.
    name : str, optional
        What a front calls it; the function's own name by default.

    Raises
    ------
    ValueError
        When the box or a name is missing, or a name or number does not fit.

    Notes
    -----
    Where ``lower``, ``upper``, ``objectives``, ``units``, ``constraints``, ``reference`` or
    ``vectorized`` is not given, the function's attribute of that name counts.
    """

    def __init__(
        self,
        function: Function,
        *,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
        objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
        units: Sequence[str] | None = None,
        constraints: Sequence[str] | None = None,
        reference: Sequence[float] | None = None,
        vectorized: bool | None = None,
        threads: int = 1,
        name: str = "",
        may_fail: bool = False,
    ) -> None:
        def stated(name: str, given: Any, otherwise: Any = None) -> Any:
            own = getattr(function, name, None) if given is None else given
            return otherwise if own is None else own

        if not callable(function):
            raise TypeError(f"function is {function!r}; give a function of candidates")
        names = None if objectives is RESIDUAL_AND_ENERGY else objectives
        self.task = self.profile = self.searched = SearchedFunction(
            name or name_of(function),
            stated("lower", lower),
            stated("upper", upper),
            stated("objectives", names, RESIDUAL_AND_ENERGY),
            stated("units", units, ()),
            stated("constraints", constraints, ()),
        )
        self.bound = None
        self.lower = np.array(self.searched.lower)
        self.upper = np.array(self.searched.upper)
        self.variables = self.searched.variables
        self.objectives = self.searched.objectives
        self.units = self.searched.units
        self.constraints = self.searched.constraints
        self.reference = _corner(stated("reference", reference), self.objectives)
        self.threads = whole("threads", threads, 1, 1_000)
        self._function = function
        self._vectorized = _said(stated("vectorized", vectorized))
        self._first_failures = None if may_fail else FirstFailures()
        self.kept: KeptValues | None = None

    @property
    def of_model(self) -> bool:
        """Return False: it may give another value the next time."""
        return False

    @interruptible
    def __call__(self, candidates: ArrayLike) -> tuple[Array, Array]:
        """Evaluate candidates, one a row, by calls of the function.

        A candidate whose values are not finite has 1e30 everywhere, so that it comes last.
        """
        table = table_of(candidates, len(self.variables))
        values = np.empty((len(table), len(self.objectives) + len(self.constraints)))
        self.fill(table, values)
        count = len(self.objectives)
        return values[:, :count].copy(), values[:, count:].copy()

    def fill(self, candidates: Array, values: Array) -> None:
        """Write the values of candidates into a table, each row or block as it is evaluated."""
        if self.kept is None:
            self._fill(candidates, values)
        else:
            self._fill_unknown(candidates, values, self.kept)
        if self._first_failures is not None:
            self._first_failures.note(self._name, values[:, 0] >= UNUSABLE)

    def points_of(
        self, coefficients: Array, values: Array, bound: float | None
    ) -> tuple[FrontPoint, ...]:
        """The points of a front, with the values that the function gave."""
        del bound
        others = self.objectives[2:]
        points = [
            FunctionPoint(tuple(row), first, second, peaks=dict(zip(others, more)))
            for row, (first, second, *more) in zip(coefficients.tolist(), values.tolist())
        ]
        return ordered_points(points, self.objectives)

    def entries_of(
        self, candidates: tuple[int, ...], coefficients: Rows, objectives: Rows, believed: Rows
    ) -> Entries:
        """Return the entries of a front of the function."""
        first, second, *others = objectives
        named = dict(zip(self.objectives[2:], others))
        return FunctionEntries(candidates, coefficients, first, second, named, believed)

    def front_with(self, points: tuple[FrontPoint, ...], record: Record, **entries: Any) -> Front:
        """The front of the function."""
        of_function: Any = points
        return FunctionFront(points=of_function, record=record, function=self.searched, **entries)

    def _fill_unknown(self, candidates: Array, values: Array, kept: KeptValues) -> None:
        """Evaluate the candidates whose values are not known, and keep those as they come."""
        count = len(self.objectives)
        first, new = kept.take(candidates, values)

        def keep(place: int, part: Array, rows: Array) -> None:
            kept.add(first + place, part, rows, count)

        places = np.flatnonzero(new)
        for run in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1):
            if len(run):
                between = slice(run[0], run[-1] + 1)
                self._fill(candidates[between], values[between], int(run[0]), keep)

    def _fill(self, table: Array, values: Array, place: int = 0, keep: Keep | None = None) -> None:
        """Evaluate candidates; each row or block is told, with its place, when it is there."""

        def write(place: int, part: Array, rows: Array, result: Array) -> None:
            _write(result, rows)
            if keep is not None:
                keep(place, part, rows)

        if len(table) and self._vectorized is None:
            write(place, table[:1], values[:1], self._first(table[:1]))
            place, table, values = place + 1, table[1:], values[1:]
        count = len(table) if not self._vectorized else min(self.threads, len(table))
        if not count:
            return

        def evaluate(numbers: NDArray[np.int64], part: Array, rows: Array) -> None:
            result = self._many(part) if self._vectorized else self._one(part[0])
            write(int(numbers[0]), part, rows, result)

        numbers = np.arange(place, place + len(table))
        parts = [np.array_split(each, count) for each in (numbers, table, values)]
        if self.threads == 1 or count == 1:
            for block in zip(*parts):
                evaluate(*block)
            return
        with ThreadPoolExecutor(self.threads) as pool:
            for _ in pool.map(evaluate, *parts):
                pass

    def _first(self, row: Array) -> Array:
        """Values of the first candidate; from now on it is known how the function is called."""
        try:
            result = self._called(row[0].copy())
        except FunctionFailedError as alone:
            if not isinstance(alone.__cause__, IndexError | TypeError | ValueError):
                raise
            return self._as_array(row, alone)
        of_many = _dimensions(result[0]) == 2  # it makes rows, of numbers or of the candidate
        if of_many and len(result[0]) != 1:
            try:
                return self._as_array(row)
            except ValueError as error:
                if is_pair(result[0], 0) and not self.constraints:
                    raise self._no_names(result[0]) from error
                raise
        self._vectorized = of_many
        return self._rows_of(*result, 1) if of_many else self._row_of(*result)

    def _as_array(self, row: Array, alone: FunctionFailedError | None = None) -> Array:
        """Values of the first candidate by a call with an array of one row."""
        try:
            values = self._many(row)
        except ValueError as as_array:
            if alone is None:
                raise
            if str(alone) == str(as_array):
                raise alone from None
            raise ValueError(
                f"{alone} (called with one candidate; with an array of them: {as_array}); "
                "vectorized=True or False says which of them it takes"
            ) from None
        self._vectorized = True
        return values

    def _many(self, table: Array) -> Array:
        """Values of many candidates by one call."""
        return self._rows_of(*self._called(table.copy()), len(table))

    def _one(self, row: Array) -> Array:
        """Values of one candidate, as a table of one row."""
        return self._row_of(*self._called(row.copy()))

    def _rows_of(self, objectives: Any, violations: Any, count: int) -> Array:
        """Make a table of what was returned of many candidates."""
        if len(self.constraints) == 1 and _dimensions(violations) == 1:
            violations = [[value] for value in violations]  # one number for each candidate
        return np.column_stack(
            [
                self._shaped(objectives, (count, len(self.objectives)), "objectives"),
                self._shaped(violations, (count, len(self.constraints)), "violations"),
            ]
        )

    def _row_of(self, objectives: Any, violations: Any) -> Array:
        """Make a table of one row of what was returned of one candidate."""
        if violations is not None and np.ndim(violations) == 0:
            violations = [violations]
        values = [
            self._shaped(objectives, (len(self.objectives),), "objectives"),
            self._shaped(violations, (len(self.constraints),), "violations"),
        ]
        return np.concatenate(values)[None]

    def _called(self, argument: Array) -> tuple[Any, Any]:
        """Objectives, and violations where there are constraints, as the function returns them."""
        try:
            result = self._function(argument)
        except Exception as error:
            raise failure_of(self._name, self._function, error) from error
        if isinstance(result, tuple) and len(result) == 2 and self._is_pair(result):
            return result
        if self.constraints and _is_nan(result):
            return np.nan, np.full(len(self.constraints), np.nan)
        if self.constraints:
            raise ValueError(
                f"{self._name} returns {_kind(result)}; with constraints give two: (objectives, "
                "violations), such as (1.0, 2.0), [-0.1]"
            )
        of_rows = 2 if self._vectorized is None else 0  # it may make rows of a candidate's numbers
        if is_pair(result, len(argument) if argument.ndim == 2 else of_rows):
            raise self._no_names(result)
        return result, None

    def _no_names(self, result: Any) -> ValueError:
        """Error to raise where a function returns violations whose names are not given."""
        shape = _shape(result[1]) or (1,)
        of_many = _dimensions(result[0]) == 2
        count = shape[-1] if len(shape) == 1 + of_many else 1
        names = ["touch"] if count == 1 else [f"limit_{i + 1}" for i in range(min(count, 9))]
        return ValueError(
            f"{self._name} returns two, objectives and violations, and no constraints are named; "
            f"name the violations, such as constraints={names} (--constraints), or set its "
            "attribute `constraints`"
        )

    def _is_pair(self, result: tuple[Any, Any]) -> bool:
        """Return whether a tuple of two is objectives with violations, not two objectives."""
        first, second = result
        if self.constraints and np.ndim(first) == 0 and not _is_nan(first):
            return False  # two numbers: objectives alone
        empty = getattr(second, "size", None) == 0 or (
            isinstance(second, list | tuple) and not second
        )
        return bool(self.constraints) or empty

    def _shaped(self, values: Any, shape: tuple[int, ...], what: str) -> Array:
        names = self.objectives if what == "objectives" else self.constraints
        if 0 in shape and (values is None or np.size(values) == 0):
            return np.empty(shape)
        if values is None:
            raise ValueError(f"{self._name} returns no {what}; return {', '.join(names)}")
        if _is_nan(values) and len(shape) == 1:
            return np.full(shape, np.nan)
        wanted = f"numbers of shape {shape}"
        try:
            table = numbers(what, values, wanted, infinite=True)
        except ValueError as error:
            raise ValueError(f"{self._name}: {error}") from None
        if table.shape != shape:
            raise ValueError(
                f"{self._name} returns {what} of shape {table.shape}, not {shape}; give "
                f"{', '.join(names) or 'none'} in this order for each candidate, or set others as "
                f"its attribute `{'constraints' if what == 'violations' else what}`"
            )
        return table

    @property
    def _name(self) -> str:
        return f"function {clipped(self.searched.name)}"


class FirstFailures:
    """Failures of the first candidates: if all fail, a search is refused, not run for hours."""

    def __init__(self) -> None:
        self._count: int | None = 0

    def note(self, name: str, failed: NDArray[np.bool_]) -> None:
        """Count failures until a candidate is fine; ValueError where there are too many."""
        if self._count is None or not len(failed):
            return
        if not failed.all():
            self._count = None
            return
        self._count += len(failed)
        if self._count >= ALL_FAILED:
            raise ValueError(
                f"{name} gives no finite numbers (nan or infinite) for the first {self._count} "
                "candidates; mend it, or give other bounds"
            )


def failure_of(name: str, function: Function, error: Exception) -> FunctionFailedError:
    """A user's function's own error, in one line with its place."""
    code = getattr(function, "__code__", None)
    file = code.co_filename if code else getattr(
        sys.modules.get(type(function).__module__), "__file__", None
    )  # fmt: skip
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    place = f" ({file}, line {lines[-1]})" if lines else ""
    return FunctionFailedError(
        f"{name}{place} fails: {words_of_error(error)}; mend it, or return nan for a candidate "
        "that cannot be evaluated"
    )


def is_pair(result: Any, candidates: int) -> bool:
    """Return whether what is returned can only be objectives with violations, as a tuple.

    Of two candidates it may be a row of objectives for each; with 0 candidates nothing speaks
    against a pair.
    """
    if not (isinstance(result, tuple) and len(result) == 2):
        return False
    shapes = [_shape(part) for part in result]
    if shapes[0] == ():
        return False
    return candidates != 2 or shapes[0] != shapes[1] or len(shapes[0] or ()) == 2


def _shape(value: Any) -> tuple[int, ...] | None:
    """Return the shape of an array; None of rows of different lengths."""
    try:
        return np.shape(value)
    except ValueError:
        return None


def _write(evaluated: Array, rows: Array) -> None:
    """Write what was evaluated into its rows of a table; what failed is unusable there."""
    replace_failures(evaluated)
    rows[:] = evaluated


def _dimensions(value: Any) -> int:
    """Return how many dimensions an array has, or would have; 0 of what makes none."""
    try:
        return int(np.ndim(value))
    except ValueError:  # rows of different lengths
        return 0


def _is_nan(value: Any) -> bool:
    """Return whether a candidate's value is one nan, in the place of all of them."""
    is_number = isinstance(value, float | np.floating)
    return is_number and bool(np.isnan(value))


def name_of(function: Function) -> str:
    """The name of a function, or of the class of an object that is called."""
    inner = getattr(function, "func", function)  # of functools.partial
    name = getattr(inner, "__name__", type(inner).__name__)
    return "function" if name == "<lambda>" else name


def _said(vectorized: Any) -> bool | None:
    if vectorized is None:
        return None
    if isinstance(vectorized, bool | np.bool_):
        return bool(vectorized)
    raise ValueError(
        f"vectorized is {quoted(vectorized)}; give True for a function of many candidates, or "
        "False for one of a single candidate"
    )


def _corner(reference: Any, objectives: Sequence[str]) -> tuple[float, ...] | None:
    if reference is None:
        return None
    corner = numbers("reference", reference, "a number for each objective").ravel()
    if len(corner) != len(objectives):
        raise ValueError(
            f"reference has {len(corner)} numbers; give one for each of {', '.join(objectives)}"
        )
    return tuple(corner.tolist())


def _kind(result: Any) -> str:
    """Say in a word or two what was returned."""
    if result is None:
        return "nothing"
    shape = _shape(result)
    size = f" of {shape[0]}" if shape else ""
    return f"one {type(result).__name__}{size}"
