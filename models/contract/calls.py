"""Call a plant's methods, and check what they return."""

from __future__ import annotations

import inspect
import linecache
import operator
import re
import reprlib
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real
from pathlib import Path
from types import TracebackType
from typing import Any, TypeGuard

import casadi as ca
import numpy as np

from models.drawing import Body
from models.plant import Expression, JointMotion, Plant

_WRITE = {
    "modal_accelerations": ("self, joint, W, dW", "a list of W'' [m/s^2], one for each mode"),
    "torque": ("self, joint, W, dW, ddW", "one expression, the joint torque [N m]"),
    "tip_displacements": ("self, W", "a list of tip displacements [m]"),
    "structure": ("self, angle, tips", "a list of models.Body"),
}
"""For every method its arguments, and what it should return."""

MOST = 100
"""Modes, and tips: with more the equations fill the memory; a link's shape takes a few modes."""
_NUMPYS = r"\s*casadi: a numpy function"
"""How casadi's warning begins where a function of NumPy is given a symbol."""


@dataclass(frozen=True)
class Outputs:
    """What the three methods give."""

    accelerations: list[Expression]
    torque: Expression
    tips: list[Expression]

    @property
    def all(self) -> list[Expression]:
        """All of them, in the order of the attributes."""
        return [*self.accelerations, self.torque, *self.tips]


class Calls:
    """The methods of a plant, called with the entries of joint motion, W, W' and W''.

    Parameters
    ----------
    plant : Plant
        The plant.
    rows : int
        How many motions stand side by side where there are several.
    """

    def __init__(self, plant: Plant, rows: int) -> None:
        self._plant, self._modes, self._rows = plant, plant.modes, rows

    def outputs(self, arguments: Sequence[Expression]) -> Outputs:
        """What the methods give; ValueError where one gives something else than it should."""
        modes = self._modes
        joint, rest = JointMotion(*arguments[:3]), list(arguments[3:])
        W, dW, ddW = rest[:modes], rest[modes : 2 * modes], rest[2 * modes :]
        accelerations = self._listed("modal_accelerations", joint, W, dW)
        if len(accelerations) != modes:
            raise ValueError(
                f"plant {self._plant.name!r} says modes = {modes} but gives {len(accelerations)} "
                "modal accelerations; return one for each mode"
            )
        torque = self._single("torque", self._called("torque", joint, W, dW, ddW))
        tips = self._listed("tip_displacements", W)
        if not tips:
            raise ValueError(
                f"plant {self._plant.name!r} has no tip displacement; return 1 or more from "
                "tip_displacements"
            )
        if len(tips) > MOST:
            raise ValueError(
                f"plant {self._plant.name!r} has {len(tips)} tip displacements; give at most {MOST}"
            )
        return Outputs(accelerations, torque, tips)

    def structure(self, angle: float, tips: Sequence[float]) -> list[Body]:
        """The bodies of a plant's drawing; ValueError where it gives something else."""
        found = self._called("structure", angle, tips)
        if not isinstance(found, list | tuple) or not found:
            raise self.wrong("structure", f"returns {_brief(found)}")
        for entry in found:
            if not isinstance(entry, Body):
                raise self.wrong("structure", f"returns a list with {_brief(entry)}")
        return list(found)

    def _listed(self, method: str, *arguments: object) -> list[Expression]:
        found = self._called(method, *arguments)
        if not isinstance(found, list | tuple):
            raise self.wrong(method, f"returns {_brief(found)}, which is no list")
        return [self._single(method, entry) for entry in found]

    def _single(self, method: str, found: Any) -> Expression:
        if not (is_number(found) or isinstance(found, ca.SX | ca.MX | ca.DM)):
            inside = "" if method == "torque" else "a list with "
            raise self.wrong(method, f"returns {inside}{_brief(found)}")
        if isinstance(found, ca.SX | ca.MX | ca.DM) and found.shape not in (
            (1, 1),
            (self._rows, 1),
        ):
            raise self.wrong(method, f"returns a matrix of {found.shape[0]} by {found.shape[1]}")
        return found

    def _called(self, method: str, *arguments: object) -> object:
        written = inspect.getattr_static(self._plant, method)
        if not callable(written) and not isinstance(written, classmethod):
            raise self.wrong(method, f"is a {type(written).__name__}, which cannot be called")
        call = getattr(self._plant, method)
        try:
            inspect.signature(call).bind(*arguments)
        except TypeError:
            raise self.wrong(method, "takes other arguments than it is given") from None
        own: list[Any] = [list(given) if isinstance(given, list) else given for given in arguments]
        try:
            with warnings.catch_warnings():
                warnings.filterwarnings("error", _NUMPYS, FutureWarning)
                found = call(*own)
        except IndexError:
            raise ValueError(
                f"plant {self._plant.name!r} says modes = {self._modes} but its {method} uses "
                "more; set modes to their number"
            ) from None
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # SystemExit and a user's own, too
            remedy = "" if method == "structure" else _remedy(error)
            raise self.wrong(method, f"fails{_line_of(error)} ({_words(error)})", remedy) from None
        if inspect.iscoroutine(found):
            found.close()  # else Python warns of it later
        names = _WRITE[method][0].split(", ")[1:]
        for name, given, left in zip(names, arguments, own, strict=True):
            if isinstance(given, list) and not _same(given, left):
                raise self.wrong(method, f"writes into {name}", f"leave {name} as it is")
        return found

    def wrong(self, method: str, what: str, remedy: str = "") -> ValueError:
        """What to say of a method: what it does, what to do about it, what it should return."""
        arguments, returns = _WRITE[method]
        remedy = remedy or f"write def {method}({arguments})"
        return ValueError(
            f"plant {self._plant.name!r}: {method} {what}; {remedy}, and return {returns}"
        )


def is_number(value: object) -> TypeGuard[float]:
    """Whether it is a number, of Python or NumPy; a truth value is none."""
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def _same(before: Sequence[object], after: Sequence[object]) -> bool:
    return len(before) == len(after) and all(map(operator.is_, before, after))


def _remedy(error: BaseException) -> str:
    """What to do about an equation that fails; empty where it is not known."""
    if isinstance(error, RecursionError):
        return "it calls itself without end: compute it"
    if "NoneType" in text_of(error) and "jerk" in _source_of(error):
        return "write it with joint.angle, joint.speed and joint.acceleration: joint.jerk is None"
    if "complex" in text_of(error):
        return "write it with real numbers"
    if isinstance(error, RuntimeError | TypeError | FutureWarning):  # of casadi, over its symbols
        return (
            "write it with casadi.cos, casadi.fmax, casadi.if_else and so on: math's and "
            "numpy's functions, if, max and float() take no symbols"
        )
    return ""


def _brief(value: object) -> str:
    if isinstance(value, ca.SX | ca.MX | ca.DM):
        return "an expression"
    return f"{type(value).__name__} {reprlib.repr(value)}" if value is not None else "None"


def _frame_of(error: BaseException) -> TracebackType | None:
    """Where in the user's method an error came from."""
    return error.__traceback__.tb_next if error.__traceback__ else None


def _line_of(error: BaseException) -> str:
    """The same in words."""
    inside = _frame_of(error)
    if inside is None:
        return ""
    return f" at line {inside.tb_lineno} of {Path(inside.tb_frame.f_code.co_filename).name}"


def _source_of(error: BaseException) -> str:
    """That line itself."""
    inside = _frame_of(error)
    return linecache.getline(inside.tb_frame.f_code.co_filename, inside.tb_lineno) if inside else ""


def text_of(error: BaseException) -> str:
    """What an error says."""
    try:
        return str(error)
    except Exception:  # an error of the user's own may have no words
        return ""


def _words(error: BaseException) -> str:
    """An error's name and first line, without the place in casadi that it comes from."""
    if isinstance(error, FutureWarning):
        return "a function of numpy is given a symbol"
    lines = text_of(error).strip().splitlines() or [""]
    if "to_double" in lines[0] or "to_int" in lines[0]:
        return "a symbol is no number"
    text = re.sub(r"^\S*\.[ch]pp:\d+: ", "", lines[0]).rstrip(".")
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
