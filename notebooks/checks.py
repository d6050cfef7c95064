"""Checks of the exercises: whether an answer is right, or how far it is off.

In a notebook::

    from checks import checks_of

    check = checks_of("01")
    check()          # what each exercise asks for
    check(1, 0.9)    # exercise 1: too small by 25 %

The right answers are computed by `answers.py`, and never shown.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np

import quietarm as qa

SLIPS = {
    "m": {"mm": 1e3, "cm": 1e2},
    "mm": {"m": 1e-3, "cm": 0.1},
    "s": {"ms": 1e3},
    "rad": {"degrees": 180 / pi},
    "degrees": {"rad": pi / 180},
    "J": {"mJ": 1e3},
    "mJ": {"J": 1e-3},
    "mJ/(N m)": {"J/(N m)": 1e-3},
    "N m": {"mN m": 1e3},
    "%": {"parts of 1": 0.01},
    "-": {"%": 100.0},
}
"""Units in which answers are given by mistake: how many of them make one of the right unit."""
TIMES = 3.0
"""From this ratio on a factor is said in place of per cent."""


class NonsenseError(ValueError):
    """An answer that is not of the kind that is asked for; says what it is instead."""


@dataclass(frozen=True)
class Numbers:
    """An exercise that asks for one number, or for several in order.

    Parameters
    ----------
    asks : str
        What they are, without the unit.
    unit : str
        Their unit; "-" if they have none.
    compute : callable
        Computes the right answer in this unit.
    count : int
        How many are asked for.
    tolerance : float
        How far a right answer may be off, as a share of it; of the largest, where it is 0.
    """

    asks: str
    unit: str
    compute: Callable[[], float | Sequence[float]]
    count: int = 1
    tolerance: float = 0.02

    @property
    def asked(self):
        return self.asks if self.unit == "-" else f"{self.asks} [{self.unit}]"

    @cached_property
    def solution(self):
        return np.atleast_1d(np.asarray(self.compute(), dtype=float))

    def verdict(self, answer):
        values = _as_numbers(answer, self.count)
        sizes = np.abs(self.solution)
        room = self.tolerance * np.where(sizes > 0, sizes, sizes.max())
        wrong = np.abs(values - self.solution) > room
        if not wrong.any():
            return "right"
        for unit, factor in SLIPS.get(self.unit, {}).items():
            if np.allclose(values, factor * self.solution, rtol=self.tolerance):
                asked = "a plain number" if self.unit == "-" else self.unit
                return f"right in {unit}, but {asked} is asked for"
        if np.allclose(values, -self.solution, rtol=self.tolerance):
            return "right, but for the sign"
        if self.count == 1:
            return _how_far(values[0], self.solution[0])
        pairs = zip(values, self.solution, wrong, strict=True)
        verdicts = [_how_far(value, right) if off else "right" for value, right, off in pairs]
        if len(set(verdicts)) == 1:
            return f"each number is {verdicts[0]}"
        return "; ".join(f"number {place} is {words}" for place, words in enumerate(verdicts, 1))


@dataclass(frozen=True)
class Choice:
    """An exercise that asks for one of several words or whole numbers; `compute` says which."""

    asks: str
    among: tuple[str, ...] | tuple[int, ...]
    compute: Callable[[], str | int]

    @property
    def asked(self):
        return f"{self.asks}: {', '.join(map(repr, self.among[:-1]))} or {self.among[-1]!r}"

    @cached_property
    def solution(self):
        return self.compute()

    def verdict(self, answer):
        plain = answer.strip().lower() if isinstance(answer, str) else answer
        if isinstance(plain, float) and plain.is_integer():
            plain = int(plain)
        word_or_number = isinstance(plain, str | int | np.integer) and not isinstance(plain, bool)
        if not word_or_number or plain not in self.among:
            raise NonsenseError(_described(answer))
        return "right" if plain == self.solution else f"it is not {plain!r}"


@dataclass(frozen=True)
class AtRest:
    """An exercise that asks for the coefficients of a motion that arrives at rest.

    Parameters
    ----------
    asks : str
        What they are.
    task : PointToPoint
        The task.
    count : int
        How many coefficients.
    limit : float
        Residual up to which the answer is right [m].
    """

    asks: str
    task: qa.PointToPoint
    count: int
    limit: float

    @property
    def asked(self):
        return f"{self.asks}, at rest within {1e3 * self.limit:g} mm"

    @cached_property
    def solution(self):
        return qa.plan_move(self.task, qa.CycloidPolynomial(self.count)).coefficients

    def verdict(self, answer):
        values = _as_numbers(answer, self.count)
        residual = qa.evaluate_coefficients(self.task, values).residual
        if residual <= self.limit:
            return "right"
        return f"not at rest: {1e3 * residual:.2f} mm remain"


class Checks:
    """The checks of a notebook's exercises; see `checks_of`."""

    def __init__(self, exercises):
        self.exercises = tuple(exercises)

    def __call__(self, number=None, answer=None):
        """Print whether an answer is right, or how far it is off.

        Parameters
        ----------
        number : int, optional
            Which exercise. Without one, what each exercise asks for is printed.
        answer : float, sequence of floats or str
            As the exercise asks for.
        """
        if number is None:
            for place, exercise in enumerate(self.exercises, 1):
                print(f"exercise {place}: {exercise.asked}")
        elif number in range(1, len(self.exercises) + 1):
            print(f"exercise {number}: {_verdict(self.exercises[int(number) - 1], answer)}")
        else:
            print(f"no exercise {number!r}: there are 1 to {len(self.exercises)}")


def checks_of(notebook):
    """Return the checks of a notebook, named by its number as "01" or "05a"."""
    from answers import EXERCISES

    if notebook not in EXERCISES:
        raise ValueError(f"no notebook {notebook!r}; there are {', '.join(EXERCISES)}")
    return Checks(EXERCISES[notebook])


def _verdict(exercise, answer):
    try:
        return exercise.verdict(answer)
    except NonsenseError as error:
        return f"asks for {exercise.asked}; this is {error}"


def _as_numbers(answer, count):
    """Return an answer as an array of so many finite numbers."""
    try:
        values = np.squeeze(np.asarray(answer))
    except ValueError:  # of unequal lengths
        raise NonsenseError(_described(answer)) from None
    if values.dtype.kind not in "iuf":
        raise NonsenseError(_described(answer))
    if values.ndim > 1 or values.size != count:
        what = "one number" if values.size == 1 else f"{values.size} numbers"
        raise NonsenseError(f"{what} in place of {'one' if count == 1 else count}")
    if not np.isfinite(values).all():
        raise NonsenseError("not finite")
    return np.atleast_1d(values).astype(float)


def _described(answer):
    if answer is None or isinstance(answer, bool | int | float | str):
        return repr(answer)
    return f"a {type(answer).__name__}"


def _how_far(value, right):
    if right == 0:
        return "too large" if value > 0 else "too small"
    ratio = value / right
    if ratio == 0:
        return "too small: it is not 0"
    if ratio < 0:
        return "of the wrong sign"
    direction = "large" if ratio > 1 else "small"
    if 1 / TIMES < ratio < TIMES:
        share = 100 * abs(ratio - 1)
        return f"too {direction} by {share:.{0 if share >= 1 else 1}f} %"
    return f"too {direction} by a factor of {max(ratio, 1 / ratio):.2g}"
