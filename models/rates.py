"""Time derivatives along a motion, by CasADi: of what a plant gives of its tips."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from quietarm.models.joint_motion import Expression, JointMotion, Modes

ValuesAlong = Callable[[JointMotion, Modes, Modes], Sequence[Expression]]
"""Values by the motion along the path, amplitudes and their rates."""


def rates_along(
    values: ValuesAlong, path: JointMotion, W: Modes, dW: Modes, ddW: Modes
) -> list[Expression]:
    """Return the time derivatives of values along a motion, in symbols, matrices or arrays.

    The derivative is by one variable, the time from now on, in which place, amplitudes and rates
    are linear. Where the path has no jerk (None) its acceleration stays as it is: values may read
    it, as that of the joints, but not depend on it. Tips and their speeds do not.
    """
    arguments = [*path, *W, *dW, *ddW]
    if any(isinstance(argument, ca.SX | ca.MX) for argument in arguments):
        return _in_symbols(values, path, W, dW, ddW)
    return _in_numbers(values, path, W, dW, ddW)


def _in_symbols(
    values: ValuesAlong, path: JointMotion, W: Modes, dW: Modes, ddW: Modes
) -> list[Expression]:
    in_matrices = any(isinstance(argument, ca.MX) for argument in (*path, *W, *dW, *ddW))
    kind: Any = ca.MX if in_matrices else ca.SX
    later = kind.sym("later")

    def moved(value: Expression, rate: Expression) -> Expression:
        return value + rate * later

    jerk = path.jerk
    acceleration = path.acceleration if jerk is None else moved(path.acceleration, jerk)
    ahead = JointMotion(
        moved(path.angle, path.speed), moved(path.speed, path.acceleration), acceleration
    )
    amplitudes = [moved(*pair) for pair in zip(W, dW)]
    rates = [moved(*pair) for pair in zip(dW, ddW)]
    slopes = [ca.jtimes(kind(value), later, 1.0) for value in values(ahead, amplitudes, rates)]
    now: Any = ca.substitute(slopes, [later], [kind(0.0)])
    return now


def _in_numbers(
    values: ValuesAlong, path: JointMotion, W: Modes, dW: Modes, ddW: Modes
) -> list[Expression]:
    """Return the rates for numbers, or for arrays with an entry for each time."""
    numbers = [*path[:3], *([] if path.jerk is None else [path.jerk]), *W, *dW, *ddW]
    symbols = [ca.SX.sym("x") for _ in numbers]
    following = iter(symbols)
    motion = JointMotion(*(None if value is None else next(following) for value in path))
    modes = [[next(following) for _ in part] for part in (W, dW, ddW)]
    rates = _in_symbols(values, motion, *modes)
    function = ca.Function("rates", symbols, [ca.densify(rate) for rate in rates])
    shape = np.broadcast_shapes(*(np.shape(number) for number in numbers))
    rows = [ca.DM(np.broadcast_to(number, shape).reshape(1, -1)) for number in numbers]
    return [result.full().reshape(shape) for result in function.call(rows)]
