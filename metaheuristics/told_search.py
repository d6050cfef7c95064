"""A search that is asked for candidates and told what they are worth: hardware in the loop.

A method calls its problem's function whenever it likes, so it runs in a thread of its own, which
waits while a candidate is measured. The state is a file of what was told: after a kill the method
runs again from its seed, is told the same, and goes on where it was.
"""

from __future__ import annotations

import queue
import threading
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.methods.search_method import SearchMethod
from quietarm.metaheuristics.search_run import SearchRun
from quietarm.metaheuristics.search_state import StateFile, Told, or_none
from quietarm.ocp import Front
from quietarm.ocp.checks import numbers, quoted, table_of, whole
from quietarm.ocp.files import check_writable
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.record import Setting

Array = NDArray[np.float64]


class Search:
    """A search of what a machine or a simulator elsewhere measures, by `ask` and `tell`.

    Parameters
    ----------
    lower, upper : array_like
        The box of the coefficients, as of a `GivenFunction`.
    evaluations : int
        Candidates in all.
    algorithm : str or SearchMethod, optional
        The method, by its name or as an object of one's own; as of `search`.
    population, settings, seed, objectives, units, constraints, reference, reevaluate
        As of `search`.
    state : path, optional
        A file that has what was told, written anew after each evaluation and never half-written.
        Where it exists the search goes on from it, and gives the same answer as one that was never
        interrupted; also with more evaluations, unless the method then asks for other candidates.

    Raises
    ------
    ValueError
        When an argument is out of range or missing, or the file is of another search.

    Examples
    --------
    ::

        search = qa.Search([-0.2] * 4, [0.2] * 4, evaluations=200, state="run.json")
        while (candidate := search.ask()) is not None:
            search.tell(candidate, measure(candidate))
        search.front().save("front.json")
    """

    @interruptible
    def __init__(
        self,
        lower: ArrayLike,
        upper: ArrayLike,
        *,
        evaluations: int,
        algorithm: str | SearchMethod | None = None,
        population: int | None = None,
        settings: Mapping[str, Setting] | None = None,
        seed: int = 0,
        objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
        units: Sequence[str] | None = None,
        constraints: Sequence[str] = (),
        reference: Sequence[float] | None = None,
        reevaluate: int = 1,
        name: str = "measured",
        state: str | Path | None = None,
    ) -> None:
        if not (algorithm is None or isinstance(algorithm, str | SearchMethod)):
            raise TypeError(
                f"algorithm is {quoted(algorithm)}; give a name, such as 'nsga2', or an object of "
                "a SearchMethod: the search is begun again from it after a kill"
            )
        path = None if state is None else check_writable(state)
        self._exchange = _Exchange()
        # not at the top: it loads pymoo, which takes longer than all of quietarm
        from quietarm.metaheuristics.problems.given_function import ALL_FAILED, GivenFunction

        self._most_failures = ALL_FAILED
        problem = GivenFunction(
            self._exchange,
            lower=lower,
            upper=upper,
            objectives=objectives,
            units=units,
            constraints=constraints,
            reference=reference,
            vectorized=True,
            name=name,
            may_fail=True,  # whoever tells failures knows of them, and may mend the machine
        )
        self._run = SearchRun.begin(
            problem,
            algorithm,
            population=population,
            evaluations=whole("evaluations", evaluations, 1),
            settings=settings,
            seed=seed,
            reevaluate=reevaluate,
        )
        self._state = self._run.state(population, settings)
        self._file = StateFile(path, self._state)
        self._told = list[Told]()
        self._pending: Array = np.empty((0, len(problem.lower)))
        self._values: list[Told | None] = []
        self._failure: BaseException | None = None
        self._over = False
        self._closed = False
        threading.Thread(target=self._exchange.work, args=(self._run,), daemon=True).start()
        self._go_on()

    @property
    def done(self) -> bool:
        """Return whether every candidate was told: there is nothing more to ask."""
        return self._over

    @property
    def evaluations(self) -> int:
        """Number of candidates that were told."""
        return len(self._told) + sum(told is not None for told in self._values)

    @interruptible
    def ask(self, most: int | None = None) -> Any:
        """The next candidate that is to be measured; the same one until it is told.

        Parameters
        ----------
        most : int, optional
            Give at most so many at once, which may be measured side by side.

        Returns
        -------
        ndarray or None
            One candidate, shape (coefficients,), None at the end. With `most` a table with a row
            for each, shape (candidates, coefficients), empty at the end.
        """
        self._refuse_if_closed()
        rows = self._pending[[told is None for told in self._values]]
        if most is not None:
            return rows[: whole("most", most, 1)].copy()
        return rows[0].copy() if len(rows) else None

    @interruptible
    def tell(
        self, candidates: ArrayLike, objectives: ArrayLike, violations: ArrayLike | None = None
    ) -> None:
        """Tell what a candidate, or several, came to; what is not finite counts as failed.

        Where the first 20 have failed, a warning says so; the search goes on.

        Parameters
        ----------
        candidates : array_like, shape (coefficients,) or (candidates, coefficients)
            Candidates that `ask` returned.
        objectives, violations : array_like
            Their values, in the same form. Violations are needed where there are constraints, and
            positive where one is broken.

        Raises
        ------
        ValueError
            When a candidate was not asked for, or is told already, or a shape is another.
        """
        self._refuse_if_closed()
        function = self._state.function
        rows = table_of(np.atleast_2d(numbers("candidates", candidates, "numbers")), function.size)
        count = len(rows)
        if violations is None:
            self._refuse_pair(objectives, count)
        values = self._table("objectives", objectives, count, function.objectives)
        if violations is None and np.isnan(values).all():
            violations = np.nan  # what failed has none
        broken = self._table("violations", violations, count, function.constraints)
        places = list[int]()
        for row in rows:
            places.append(self._place_of(row, places))
        for place, of_candidate, passed in zip(places, values, broken):
            self._values[place] = Told(
                len(self._told) + place + 1,
                tuple(self._pending[place].tolist()),
                or_none(of_candidate),
                or_none(passed),
            )
        before = self.evaluations - count
        self._save()
        if all(told is not None for told in self._values):
            self._hand_over()
            self._go_on()
        self._warn_of_failures(before)

    def front(self) -> Front:
        """The front of what was told until now, a `FunctionFront`; ValueError before that.

        Of methods with a population these are the generations that are told whole.
        """
        self._raise_failure()
        if not self._told:
            raise ValueError(
                f"{self.evaluations} of the first {len(self._pending)} candidates are told; tell "
                "the others before a front is asked for"
            )
        return self._run.front()

    def close(self) -> None:
        """End the method's thread; what was told is in the file, if there is one.

        Nothing can be asked or told afterwards; `front` has what was found until then.
        """
        self._closed = True
        self._exchange.close()

    def __del__(self) -> None:
        if exchange := vars(self).get("_exchange"):
            exchange.close()

    def _refuse_pair(self, objectives: Any, candidates: int) -> None:
        """Refuse what a function with constraints returns, in the place of its objectives."""
        from quietarm.metaheuristics.problems.given_function import is_pair

        if not is_pair(objectives, candidates):
            return
        remedy = "tell them apart, such as tell(candidate, *measure(candidate))"
        if not self._state.function.constraints:
            remedy += ", and name the violations when the search begins, by constraints=[...]"
        raise ValueError(f"objectives are two, objectives and violations; {remedy}")

    def _warn_of_failures(self, before: int) -> None:
        """Say once that nothing but failures was told, after so many as a function may have."""
        if not before < self._most_failures <= self.evaluations:
            return
        known = [*self._told, *(told for told in self._values if told is not None)]
        if all(told.failed for told in known):
            path = self._file.path
            kept = "" if path is None else f"; {path} keeps them"
            warnings.warn(
                f"all {len(known)} candidates that were told have failed{kept}; mend what measures "
                "and go on, failures count as candidates, or begin again with other bounds",
                stacklevel=7,  # tell() is an operation, which has four frames of its own
            )

    def _place_of(self, row: Array, taken: Sequence[int]) -> int:
        """Return which of the candidates that wait is meant."""
        size = self._run.function.upper - self._run.function.lower
        for place, pending in enumerate(self._pending):
            waits = self._values[place] is None and place not in taken
            if waits and (np.abs(pending - row) <= 1e-9 * size).all():
                return place
        raise ValueError(
            f"the candidate {quoted(row.tolist())} was not asked for, or is told already; tell "
            "what ask() returns"
        )

    def _table(self, what: str, values: Any, count: int, names: Sequence[str]) -> Array:
        """Values as a table with a row for each candidate."""
        if not names:  # objectives have some
            given = numbers(what, () if values is None else values, "none", infinite=True)
            if not np.isnan(given).all():
                raise ValueError(f"the search has no {what}; leave them out, or name constraints")
            return np.empty((count, 0))
        wanted = f"{', '.join(names) or 'none'} of each candidate"
        if values is None:
            raise ValueError(f"{what} are missing; give {wanted}")
        table = numbers(what, values, wanted, infinite=True)
        if table.ndim == 0 and np.isnan(table):
            return np.full((count, len(names)), np.nan)
        if table.ndim < 2 and table.size == count * len(names) and 1 in (count, len(names)):
            table = table.reshape(count, len(names))
        if table.shape != (count, len(names)):
            raise ValueError(
                f"{what} have shape {table.shape}, not {(count, len(names))}; give {wanted}"
            )
        return table

    def _save(self) -> None:
        partly = [told for told in self._values if told is not None]
        self._file.save([*self._told, *partly])

    def _hand_over(self) -> None:
        """Give the method the values that it waits for."""
        entries = [told for told in self._values if told is not None]
        self._told += entries
        rows = [[*told.objectives, *told.violations] for told in entries]
        table = np.array(rows, dtype=float)  # None is nan
        count = len(self._state.function.objectives)
        self._exchange.answer((table[:, :count], table[:, count:]))

    def _go_on(self) -> None:
        """Wait for what the method asks, ends or fails with; what the file knows is told."""
        while self._receive() and all(told is not None for told in self._values):
            self._hand_over()

    def _receive(self) -> bool:
        """Wait until the method asks for more; False at its end."""
        # some methods of pymoo leave all warnings of the process switched off
        with warnings.catch_warnings():
            asked = self._exchange.asked()
        self._values = []
        self._pending = self._pending[:0]
        if isinstance(asked, BaseException):
            self._failure = asked
            raise asked
        if asked is None:
            self._over = True
            return False
        self._pending = asked
        before = len(self._told)
        self._values = [self._file.known(before + i + 1, row) for i, row in enumerate(asked)]
        return True

    def _refuse_if_closed(self) -> None:
        """Refuse to ask or tell a search that is closed: its method would never answer."""
        self._raise_failure()
        if self._closed:
            raise ValueError("the search is closed; make a new one, of the same state to go on")

    def _raise_failure(self) -> None:
        if self._failure is not None:
            raise self._failure


class _Exchange:
    """Meeting place of a method's thread and whoever measures: one of them waits at any time."""

    def __init__(self) -> None:
        self._questions = queue.SimpleQueue[Any]()
        self._answers = queue.SimpleQueue[Any]()

    def __call__(self, candidates: Array) -> Any:
        """Ask for the values of candidates, in the method's thread."""
        self._questions.put(candidates)
        answer = self._answers.get()
        if answer is None:
            raise _ClosedError
        return answer

    def work(self, run: SearchRun) -> None:
        """Run the method to its end, in its thread."""
        end: BaseException | None = None
        try:
            run.finish()
        except _ClosedError:
            return
        except BaseException as error:  # of any kind: it is raised where one waits
            end = error
        self._questions.put(end)

    def asked(self) -> Any:
        """Wait for what the method asks: candidates, an error, or None at its end."""
        return self._questions.get()

    def answer(self, values: tuple[Array, Array]) -> None:
        """Tell the method what its candidates are worth."""
        self._answers.put(values)

    def close(self) -> None:
        """End the method where it waits."""
        self._answers.put(None)


class _ClosedError(BaseException):
    """Error in a method's thread when nobody measures any more."""
