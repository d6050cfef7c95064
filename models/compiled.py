"""The one door to CasADi's functions: built once, by one thread at a time; no Ctrl-C is lost."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext, redirect_stderr
from functools import partial
from threading import RLock, get_ident
from typing import Any, TextIO, TypeVar

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import calls_casadi, interruptible
from quietarm.models.kept_functions import kept_function

Array = NDArray[np.float64]
T = TypeVar("T")
RECENT = 16
"""So many functions of a kind, the latest, a process keeps compiled: each is of one plant, profile
and number of steps, and takes 1 to 50 MB, with derivatives by 24 coefficients more. A plan takes up
to five, so tasks that come in turn by three are not compiled again."""
_TURN = RLock()
"""Two threads that build with CasADi, or run a solver of it, at once may end the process."""


class Compiled:
    """A function of CasADi, built when it is first needed.

    What CasADi does here waits for other threads that do the same, and no Ctrl-C is lost in it, as
    in CasADi alone, where a solve then seems to have failed, or a value is missing and any error
    follows. Arrays are read and written without passing every number through a list of Python,
    which is a third of a simulation by CVODES.

    Parameters
    ----------
    build : callable
        Builds the function.
    silent : bool
        Whether what a call writes to standard error is dropped.
    side_by_side : bool
        Whether several threads may call it at once: each call then has memory of its own.
    kept_as : sequence, optional
        All that the function follows from, if it is to be left to the next process.
    """

    def __init__(
        self,
        build: Callable[[], ca.Function],
        silent: bool = False,
        side_by_side: bool = False,
        kept_as: Sequence[Any] | None = None,
    ) -> None:
        self._build = build if kept_as is None else partial(kept_function, kept_as, build)
        self._function: ca.Function | None = None
        self._silent = silent
        self._turn = nullcontext() if side_by_side else _TURN
        self._idle: list[_Buffer] = []
        self._mapped: dict[int, Compiled] = {}

    @property
    @interruptible
    def function(self) -> ca.Function:
        """The CasADi function, to build others of."""
        if self._function is None:
            with _TURN, self._muted():
                self._function = self._function or self._build()
        return self._function

    def __call__(self, *inputs: ArrayLike) -> list[Array]:
        """The outputs as matrices, of inputs that are matrices, columns or numbers."""
        columns = [np.asarray(values, dtype=float).T for values in inputs]
        return self.run(columns, _transposed)

    def at_places(self, *columns: Array) -> list[Array]:
        """The outputs at many places side by side, of inputs that have a column for each."""
        count = columns[0].shape[1]
        if count == 1:
            return self(*columns)
        if count not in self._mapped:
            self._mapped[count] = Compiled(lambda: self.function.map(count))
        return self._mapped[count](*columns)

    @interruptible
    def run(self, inputs: Sequence[ArrayLike], read: Callable[[list[Array]], T]) -> T:
        """Call the function and return what `read` takes from the outputs; arrays are transposed.

        The next call overwrites the outputs: read copies of them.
        """
        function = self.function
        with self._turn, self._muted():
            try:
                buffer = self._idle.pop()
            except IndexError:  # all are in use by other threads, or there is none yet
                buffer = _Buffer(function)
            result = read(buffer.run(inputs))
            self._idle.append(buffer)
        return result

    @interruptible
    def solve(self, **inputs: Any) -> tuple[dict[str, Array], dict[str, Any]]:
        """Columns of the outputs by name, and statistics, of a function that is a solver."""
        function = self.function
        with _TURN, self._muted():
            outputs: dict[str, ca.DM] = function(**inputs)
            columns = {name: values.full().ravel() for name, values in outputs.items()}
            return columns, function.stats()

    def _muted(self) -> AbstractContextManager[Any]:
        return silent_errors() if self._silent else nullcontext()

    @staticmethod
    @interruptible
    def guard(work: Callable[[], T]) -> T:
        """Do other work with CasADi, guarded as a single function is, and return its result."""
        with _TURN:
            return work()


class _Buffer:
    """Memory for one call of a function at a time."""

    def __init__(self, function: ca.Function) -> None:
        self._buffer: Any  # casadi's type says nothing of memoryviews
        self._buffer, self._run = function.buffer()
        self._inputs = [np.zeros(function.size_in(i)[::-1]) for i in range(function.n_in())]
        self._outputs = [np.zeros(function.size_out(i)[::-1]) for i in range(function.n_out())]
        for i, values in enumerate(self._inputs):
            self._buffer.set_arg(i, values.data)
        for i, values in enumerate(self._outputs):
            self._buffer.set_res(i, values.data)

    @calls_casadi
    def run(self, inputs: Sequence[ArrayLike]) -> list[Array]:
        for memory, values in zip(self._inputs, inputs):
            memory[...] = values
        self._run()
        return self._outputs


def _transposed(outputs: list[Array]) -> list[Array]:
    return [values.T.copy() for values in outputs]


def silent_errors() -> AbstractContextManager[Any]:
    """Drop what this thread writes to standard error in the block; progress in others goes on."""
    muted: Any = _Muted(sys.stderr)
    return redirect_stderr(muted)


class _Muted:
    """A stream that is deaf to the thread that made it."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._thread = get_ident()

    def write(self, text: str) -> int:
        """Write, unless this comes from the thread."""
        return len(text) if get_ident() == self._thread else self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
