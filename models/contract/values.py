"""Compute a plant's equations over many motions, and check the values."""

from __future__ import annotations

import math
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models.contract.calls import Calls, is_number
from models.plant import Expression, Plant

Array = NDArray[np.float64]

_ANGLES = 241
_TINY = 1e-12
"""What counts as nothing, relative to the values of a moving joint."""
_GROWTH = 1e-6
"""Growth of a mode, relative to its frequency, that rounding does not explain."""
_MIXED = (
    "mixes motions that stand side by side in a matrix",
    "use operations that work element by element: no sum, dot, mtimes or max over entries",
)
_OTHER = (
    "gives other values when it is called again",
    "compute it from its arguments and the plant's parameters alone: no random number, no clock",
)
_KINDS = 5
"""Motions at every angle: forwards, backwards, at a turning point, at constant speed, at rest."""


class Equations:
    """The equations of a plant as functions of joint motion, W, W' and W''.

    Every check raises ValueError with the method, the value and the remedy.

    Parameters
    ----------
    plant : Plant
        The plant.
    """

    def __init__(self, plant: Plant) -> None:
        self._plant, self._modes = plant, plant.modes
        self._points = _points(plant.modes)
        count, columns = self._points.shape
        self._calls = Calls(plant, count)
        self._many = [ca.MX.sym(f"x{i}", count) for i in range(columns)]
        self._of_many = self._calls.outputs(self._many)  # first: of an SX, math.cos makes a nan
        self._one = [ca.SX.sym(f"x{i}") for i in range(columns)]
        self._of_one = self._calls.outputs(self._one)

    def check_linear(self) -> None:
        """The modes and tips are linear in W and W'."""
        name, modes = self._plant.name, self._modes
        state = ca.vertcat(*self._one[3 : 3 + 2 * modes])
        if not ca.is_linear(ca.vertcat(*self._of_one.accelerations), state):
            raise ValueError(
                f"plant {name!r}: the modal accelerations are not affine in W and W'; "
                "linearise them: quietarm integrates modes that are linear for a given joint motion"
            )
        if not ca.is_linear(ca.vertcat(*self._of_one.tips), state):
            raise ValueError(
                f"plant {name!r}: the tip displacement is not linear in W; linearise it"
            )

    def check_one_by_one(self) -> None:
        """Many motions side by side give what each gives alone."""
        count = len(self._points)
        outputs = [
            ca.repmat(ca.DM(entry), count)
            if is_number(entry) or isinstance(entry, ca.DM)
            else entry
            for entry in self._of_many.all
        ]
        for method, entry in zip(self._methods, outputs, strict=True):
            if entry.shape != (count, 1):
                raise self._calls.wrong(method, *_MIXED)
        many = ca.Function("many", self._many, [ca.horzcat(*outputs)])
        beside = many(*[ca.DM(column) for column in self._points.T]).full()
        for i, method in enumerate(self._methods):
            alone, together = self._values[:, i], beside[:, i]
            finite = np.isfinite(alone) & np.isfinite(together)
            largest = np.abs(alone[finite]).max(initial=0.0)
            if not np.allclose(alone[finite], together[finite], rtol=1e-9, atol=1e-9 * largest):
                again = self._evaluated(ca.vertcat(*self._calls.outputs(self._one).all))[:, i]
                steady = np.array_equal(again, alone, equal_nan=True)
                raise self._calls.wrong(method, *(_MIXED if steady else _OTHER))

    def check_finite(self) -> None:
        """Values and slopes are finite at every speed, wherever they are at some speed."""
        self._check_finite(self._values, "", self._methods)
        columns = len(self._one)
        slopes = self._evaluated(ca.jacobian(ca.vertcat(*self._of_one.all), ca.vertcat(*self._one)))
        by_output = [m for _ in range(columns) for m in self._methods]  # casadi's order: columns
        self._check_finite(slopes, "the slope of ", by_output)

    def _check_finite(self, values: Array, what: str, methods: list[str]) -> None:
        bad = ~np.isfinite(values)
        if self._defined.any():
            bad[~self._rows_defined] = False
        if not bad.any():
            return
        row, column = np.argwhere(bad)[-1]  # the simplest motion: at rest, if it fails there
        angle, speed, acceleration = self._points[row, :3]
        raise ValueError(
            f"plant {self._plant.name!r}: {what}{methods[column]} is {values[row, column]} with "
            f"the joint at {angle:.4g} rad, {speed:.4g} rad/s and {acceleration:.4g} rad/s^2; "
            "divide by nothing that can be 0, such as the speed, take no root of it, and check the "
            "parameters"
        )

    def check_rest(self) -> None:
        """At rest the structure stays at rest, at every angle."""
        by_angle = self._values.reshape(_ANGLES, _KINDS, -1)
        moving, still = np.abs(by_angle[:, :-1]).max(axis=1), by_angle[:, -1]
        wrong = np.abs(still) > _TINY * moving
        wrong[~self._defined] = False
        for column, method in enumerate(self._methods):
            rows = np.flatnonzero(wrong[:, column])
            if method == "torque" or not rows.size:
                continue
            angle = self._points[rows[0] * _KINDS, 0]
            raise ValueError(
                f"plant {self._plant.name!r} does not stay at rest: with the joint at rest at "
                f"{angle:.4g} rad and W = 0, {method} gives {still[rows[0], column]:.4g}, not 0; "
                "measure W from the static deflection"
            )

    def check_tips(self) -> None:
        """Every tip moves with some mode: else nothing would be kept still."""
        tips = self._values[:, 1 + self._modes :]
        still = np.flatnonzero(~np.any(tips != 0, axis=0))
        if still.size:
            raise ValueError(
                f"plant {self._plant.name!r}: tip displacement {still[0] + 1} is 0 whatever W is; "
                "return one that W moves from tip_displacements, and check the parameters"
            )

    def check_torque(self) -> None:
        """Moving the joint takes torque: else every motion costs nothing."""
        if not np.any(self._values[self._rows_defined, self._modes]):
            raise self._calls.wrong(
                "torque", "is 0 however the joint moves", "write the joint's equation"
            )

    def check_stable(self) -> None:
        """No mode grows while the joint is at rest."""
        modes = self._modes
        state = ca.vertcat(*self._one[3 : 3 + 2 * modes])
        slopes = self._evaluated(ca.jacobian(ca.vertcat(*self._of_one.accelerations), state))
        resting = slopes[_KINDS - 1 :: _KINDS][self._defined]
        matrices = np.zeros((len(resting), 2 * modes, 2 * modes))
        matrices[:, :modes, modes:] = np.eye(modes)
        matrices[:, modes:] = resting.reshape(-1, 2 * modes, modes).transpose(0, 2, 1)
        values = np.linalg.eigvals(matrices)
        self._check_stiff(np.abs(values), np.abs(np.linalg.det(matrices[:, modes:, :modes])))
        growth = values.real.max(axis=1)
        grows = np.flatnonzero(growth > _GROWTH * np.abs(values).max(axis=1))
        if grows.size:
            angle = self._points[_KINDS - 1 :: _KINDS, 0][self._defined][grows[0]]
            raise ValueError(
                f"plant {self._plant.name!r} has an unstable mode: with the joint at rest at "
                f"{angle:.4g} rad it grows as exp({growth[grows[0]]:.3g} t); check the signs of "
                "its parameters, and of stiffness and damping in modal_accelerations, which "
                "returns W'' = -2 zeta omega W' - omega^2 W - ..."
            )

    def _check_stiff(self, sizes: Array, stiffness: Array) -> None:
        """Every mode comes back: no eigenvalue of the resting structure is 0."""
        loose = np.flatnonzero(sizes.min(axis=1) <= _TINY * sizes.max(axis=1))
        if loose.size:
            angle = self._points[_KINDS - 1 :: _KINDS, 0][self._defined][loose[0]]
            if stiffness[loose[0]] > 0:
                raise ValueError(
                    f"plant {self._plant.name!r} has a mode that creeps: with the joint at rest at "
                    f"{angle:.4g} rad damping stops it at {sizes[loose[0]].max():.3g} 1/s, and its "
                    "stiffness hardly brings it back; give less damping or more stiffness"
                )
            raise ValueError(
                f"plant {self._plant.name!r} has a mode without stiffness: with the joint at rest "
                f"at {angle:.4g} rad it has the frequency 0 and does not come back; give the "
                "parameters of its stiffness, such as omega, other values than 0"
            )

    def check_numbers(self) -> None:
        """Every method takes numbers as well, moving and at rest."""
        first = np.flatnonzero(self._defined)[0] * _KINDS
        for row in (first, first + _KINDS - 1):
            self._calls.outputs(self._points[row].tolist())

    @cached_property
    def _methods(self) -> list[str]:
        """The method that each output is of."""
        tips = len(self._of_one.tips)
        return [
            *["modal_accelerations"] * self._modes, "torque", *["tip_displacements"] * tips
        ]  # fmt: skip

    @cached_property
    def _values(self) -> Array:
        """Every output at every point, a column each."""
        return self._evaluated(ca.vertcat(*self._of_one.all))

    @cached_property
    def _defined(self) -> NDArray[np.bool_]:
        """Which angles the equations hold for: where they are finite for some motion."""
        finite = np.isfinite(self._values).all(axis=1).reshape(_ANGLES, _KINDS)
        return np.any(finite, axis=1, keepdims=True)[:, 0]

    @property
    def _rows_defined(self) -> NDArray[np.bool_]:
        """Which points are at such angles."""
        return np.repeat(self._defined, _KINDS)

    def _evaluated(self, expression: Expression) -> Array:
        """The entries of an expression of `_one`, column by column, at every point."""
        flat = ca.densify(ca.vec(expression))
        function = ca.Function("one", [ca.vertcat(*self._one)], [flat])
        return function.map(len(self._points))(self._points.T).full().T


def _points(modes: int) -> Array:
    """Joint motion, W, W' and W'' at which the equations are computed, a row each."""
    special = [0.0, -math.pi / 2, math.pi / 2, -math.pi, math.pi]
    random = np.random.default_rng(0)
    spread = np.linspace(-2 * math.pi, 2 * math.pi, _ANGLES - len(special))
    spread += random.uniform(-0.02, 0.02, len(spread))  # else sin(60 angle) would be 0 at all
    points = np.zeros((_ANGLES, _KINDS, 3 + 3 * modes))
    points[:, :, 0] = np.concatenate([special, spread])[:, None]
    moving = points[:, :-1]
    moving[:, :, 1] = random.uniform(0.1, 10, (_ANGLES, 1))
    moving[:, 1, 1] *= -1
    moving[:, 2, 1] = 0.0
    moving[:, :, 2] = random.uniform(-100, 100, (_ANGLES, 1))
    moving[:, 3, 2] = 0.0
    moving[:, :, 3:] = random.uniform(-1, 1, (_ANGLES, 1, 3 * modes))
    return points.reshape(_ANGLES * _KINDS, -1)
