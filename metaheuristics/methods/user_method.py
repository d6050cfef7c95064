"""The user's own methods: functions, objects that are asked and told, algorithms of pymoo."""

from __future__ import annotations

import copy
import hashlib
import inspect
import pickle
import reprlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, runtime_checkable

from numpy.typing import ArrayLike, NDArray

from quietarm.metaheuristics.methods.presets import PRESETS
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.metaheuristics.problems.recorded import BudgetSpentError, RecordedFunction

if TYPE_CHECKING:
    from pymoo.core.algorithm import Algorithm


@runtime_checkable
class AskTell(Protocol):
    """A method that is asked for candidates and told what they are worth."""

    def setup(self, function: RecordedFunction, seed: int) -> None:
        """Begin: the function has `lower`, `upper` and the names of what it returns."""
        ...

    def ask(self) -> ArrayLike:
        """Candidates within the bounds, shape (candidates, variables); none to end."""
        ...

    def tell(self, candidates: ArrayLike, objectives: NDArray, violations: NDArray) -> None:
        """Take the candidates that `ask` returned last, and their values as of `MoveFunction`."""
        ...


Method: TypeAlias = "str | Algorithm | AskTell | Callable[..., Any]"


def is_of_pymoo(method: object) -> bool:
    """Return whether a method is one of pymoo's algorithms."""
    return hasattr(method, "infill")


def method_name(method: Method) -> str:
    """Return the name of a method."""
    if isinstance(method, str):
        return method
    return getattr(method, "__name__", type(method).__name__)


def check_method(method: object) -> None:
    """Refuse what is no method at all."""
    if inspect.isclass(method):
        raise ValueError(f"give an object, such as {method.__name__}(), not its class")
    if not (is_of_pymoo(method) or isinstance(method, AskTell) or callable(method)):
        raise ValueError(
            f"method is {reprlib.repr(method)}; give a name, such as 'nsga2', a function of "
            "(function, "
            "seed, budget), an object with setup, ask and tell, or an algorithm of pymoo"
        )


def why_not_sent(method: Method) -> str:
    """Say why a method cannot be sent to another process; empty where it can."""
    if isinstance(method, str):
        return ""
    import joblib  # not at the top: it takes long to load

    try:
        pickle.dumps(joblib.wrap_non_picklable_objects(method))
    except Exception as error:  # of any kind: of what the method holds
        return f"it cannot be sent to a worker ({error}); run it with one worker"
    return ""


def run_method(method: Any, function: RecordedFunction, seed: int, budget: int) -> None:
    """Let a function, or a copy of an object, use up the budget of a recorded function.

    Raises
    ------
    ValueError
        When it asks for no candidate at all.
    """
    outcome = None
    with suppress(BudgetSpentError):
        if isinstance(method, AskTell):
            _ask_and_tell(copy.deepcopy(method), function, seed)
        else:
            outcome = method(function, seed, budget)
    _refuse_unused(outcome, function)


def _ask_and_tell(method: AskTell, function: RecordedFunction, seed: int) -> None:
    method.setup(function, seed)
    while True:
        candidates: Any = method.ask()
        if candidates is None:
            raise ValueError("ask() returns None; return candidates, one a row")
        objectives, violations = function(candidates)
        method.tell(candidates, objectives, violations)


def _refuse_unused(outcome: object, function: RecordedFunction) -> None:
    """Refuse a method that has ended without any candidate, and say what it may have meant."""
    if function.archive.evaluations:
        return
    remedy = "call function(candidates)"
    if inspect.isgenerator(outcome) or inspect.iscoroutine(outcome):
        outcome.close()
        raise ValueError(f"it is a generator, of which nothing runs; {remedy} in place of yield")
    raise ValueError(f"it asked for no candidate; {remedy}, with one candidate a row")


def digest_of(method: Method) -> str:
    """Digest a user's own method, to recognise runs of an older one; empty for quietarm's.

    Of a function its code, defaults and what it encloses, not what it calls; of an object all that
    it holds, and where it is asked and told the code of its class. Of a name that of its class.
    """
    if isinstance(method, str):
        preset = PRESETS.get(NamedMethod.read(method).method)
        if preset is None or preset.own is None:
            return ""
        whole = hashlib.sha256()
        for part in _code_of_class(preset.own):
            whole.update(part)
        return whole.hexdigest()[:12]
    import joblib  # not at the top: it takes long to load

    digest = hashlib.sha256()
    contents: Any = method
    if isinstance(method, FunctionType):
        enclosed = [cell.cell_contents for cell in method.__closure__ or ()]
        contents = method.__defaults__, method.__kwdefaults__, enclosed
    for part in _code_of(method):
        digest.update(part)
    # it may hold what cannot be pickled
    with suppress(pickle.PicklingError, AttributeError, TypeError):
        digest.update(str(joblib.hash(contents)).encode())
    return digest.hexdigest()[:12]


def _code_of(method: Any) -> Iterator[bytes]:
    """The code of a function, or of the class of an object that is asked and told."""
    if isinstance(method, FunctionType):
        yield from _bytes_of(method.__code__)
    elif isinstance(method, AskTell) and not is_of_pymoo(method):
        yield from _code_of_class(type(method))


def _code_of_class(kind: type[Any]) -> Iterator[bytes]:
    """The code of all functions that a class defines."""
    for _, value in sorted(vars(kind).items()):
        if isinstance(value, FunctionType):
            yield from _bytes_of(value.__code__)


def _bytes_of(code: CodeType) -> Iterator[bytes]:
    yield code.co_code + repr(code.co_names).encode()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _bytes_of(constant)
        elif isinstance(constant, frozenset):  # in any order
            yield repr(sorted(map(repr, constant))).encode()
        else:
            yield repr(constant).encode()
