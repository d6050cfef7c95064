"""The contract of a plant, checked before anything is computed with it.

The equations are called as the program calls them, and computed over a turn and more of joint
angles, moving and at rest, and along a move.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Sequence
from dataclasses import Field, is_dataclass
from functools import cached_property, lru_cache
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models.joint_motion import Expression, JointMotion

if TYPE_CHECKING:
    from quietarm.models.plant import Plant

Array = NDArray[np.float64]

MOST = 100
"""Modes, and tips: with more the equations fill the memory; a link's shape takes a few modes."""
_WRITE = {
    "modal_accelerations": ("self, joint, W, dW", "a list of W'' [m/s^2], one for each mode"),
    "torque": ("self, joint, W, dW, ddW", "one expression, the joint torque [N m]"),
    "tip_displacements": ("self, W", "a list of tip displacements [m]"),
}
"""For every method its arguments, and what it should return."""
_CASADIS = (
    "write it with casadi.cos, casadi.fmax, casadi.if_else and so on: math's and numpy's "
    "functions, if, max and float() take no symbols"
)
_MIXED = (
    "mixes motions that stand side by side in a matrix",
    "use operations that work element by element: no sum, dot, mtimes or max over entries",
)
_ANGLES, _ON_THE_WAY = 241, 101
"""Joint angles at which the equations are computed, and those of a move."""
_KINDS = 5
"""Motions at every angle: forwards, backwards, at a turning point, at constant speed, at rest."""
_TINY = 1e-12
"""What counts as nothing, relative to the values of a moving joint."""
_GROWTH = 1e-6
"""Growth of a mode, relative to its frequency, that rounding does not explain."""


def check_contract(plant: Plant) -> None:
    """Check all that `Plant` asks of its subclasses; ValueError with what is wrong and a remedy."""
    kind = type(plant)
    bare = any(isinstance(entry, Field) for entry in vars(kind).values())
    if bare or not is_dataclass(plant) or kind.__hash__ is None:
        raise ValueError(
            f"plant {plant.name!r} is no frozen dataclass; write @dataclass(frozen=True) above "
            f"class {kind.__name__}"
        )
    modes: object = getattr(plant, "modes", None)
    if not isinstance(modes, int) or modes < 1:
        has = "no modes" if modes is None else f"{modes!r} modes"
        raise ValueError(
            f"plant {plant.name!r} has {has}; write how many it has, 1 or more, as "
            "modes: ClassVar[int] = 1"
        )
    if modes > MOST:
        raise ValueError(f"plant {plant.name!r} has {modes} modes; give at most {MOST}")
    small = plant.small_deflection
    if small is not None and not small > 0:
        raise ValueError(
            f"plant {plant.name!r}: small_deflection is {small!r}; give a length in m, or None"
        )
    _check_equations(plant)


@lru_cache(maxsize=256)
def _check_equations(plant: Plant) -> None:
    """The check of the equations; a plant that has passed is not checked again."""
    equations = _Equations(plant)
    equations.check_linear()
    equations.check_one_by_one()
    equations.check_finite()
    equations.check_rest()
    equations.check_tips()
    equations.check_stable()
    equations.check_torque()


@lru_cache(maxsize=1024)
def check_along(plant: Plant, start: float, target: float) -> None:
    """Check that the equations have values at every angle of a move from start to target [rad].

    A plant may be undefined at some angles, such as a crank at its dead centre, but not on the way.
    ValueError with the method, its value and the angle.
    """
    low, high = sorted((start, target))
    right = np.arange(math.ceil(low / (math.pi / 2)), math.floor(high / (math.pi / 2)) + 1)
    spread = np.linspace(low, high, _ON_THE_WAY)
    angles = np.concatenate([[start, target], right[:_ON_THE_WAY] * math.pi / 2, spread])
    columns = np.zeros((3 * (1 + plant.modes), 2 * len(angles)))
    columns[:, len(angles) :] = 1.0  # moving, after at rest
    columns[0] = np.tile(angles, 2)
    values = _equations(plant)(columns).full()
    wrong = np.argwhere(~np.isfinite(values.T))
    if wrong.size:
        place, output = wrong[0]
        raise ValueError(
            f"plant {plant.name!r}: {_methods(plant)[output]} is {values[output, place]} with the "
            f"joint at {columns[0, place]:.4g} rad, on the way from {start:.4g} to {target:.4g} "
            "rad; move where its equations hold, or check them and the parameters"
        )


@lru_cache(maxsize=256)
def _equations(plant: Plant) -> ca.Function:
    """(joint motion, W, W', W'') -> every output, a column for each motion."""
    arguments = [ca.SX.sym(f"x{i}") for i in range(3 * (1 + plant.modes))]
    outputs = outputs_of(plant, arguments).all
    return ca.Function("equations", [ca.vertcat(*arguments)], [ca.densify(ca.vertcat(*outputs))])


def _methods(plant: Plant) -> list[str]:
    """The method that each output is of."""
    tips = ["tip_displacements"] * plant.tips
    return ["modal_accelerations"] * plant.modes + ["torque", *tips]


class Outputs(NamedTuple):
    """What the three methods give."""

    accelerations: list[Expression]
    torque: Expression
    tips: list[Expression]

    @property
    def all(self) -> list[Expression]:
        """All of them, in this order."""
        return [*self.accelerations, self.torque, *self.tips]


def outputs_of(plant: Plant, arguments: Sequence[Expression], rows: int = 1) -> Outputs:
    """What a plant's methods give of joint motion, W, W' and W''.

    Parameters
    ----------
    plant : Plant
        The plant.
    arguments : sequence of Expression
        3 + 3 * modes entries.
    rows : int
        How many motions stand side by side in each.

    Returns
    -------
    Outputs
        Entries of the same shape, or scalars.

    Raises
    ------
    ValueError
        Where a method fails or gives something else than it should.
    """
    modes = plant.modes
    joint, rest = JointMotion(*arguments[:3]), list(arguments[3:])
    W, dW, ddW = rest[:modes], rest[modes : 2 * modes], rest[2 * modes :]

    def single(method: str, found: Any) -> Expression:
        if not isinstance(found, Real | ca.SX | ca.MX | ca.DM):
            raise _wrong(plant, method, f"returns {_kind(found)} where an expression is due")
        if not isinstance(found, Real) and found.shape not in ((1, 1), (rows, 1)):
            raise _wrong(plant, method, "returns a matrix of {} by {}".format(*found.shape))
        return found

    def listed(method: str, *given: object) -> list[Expression]:
        found = _called(plant, method, *given)
        if not isinstance(found, list | tuple):
            raise _wrong(plant, method, f"returns {_kind(found)}, which is no list")
        return [single(method, entry) for entry in found]

    accelerations = listed("modal_accelerations", joint, W, dW)
    if len(accelerations) != modes:
        raise ValueError(
            f"plant {plant.name!r} says modes = {modes} but gives {len(accelerations)} modal "
            "accelerations; return one for each mode"
        )
    torque = single("torque", _called(plant, "torque", joint, W, dW, ddW))
    tips = listed("tip_displacements", W)
    if not 1 <= len(tips) <= MOST:
        raise ValueError(
            f"plant {plant.name!r} has {len(tips)} tip displacements; return 1 to {MOST} from "
            "tip_displacements"
        )
    return Outputs(accelerations, torque, tips)


def _called(plant: Plant, method: str, *arguments: object) -> Any:
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", r"\s*casadi: a numpy function", FutureWarning)
            return getattr(plant, method)(*arguments)
    except IndexError:
        raise ValueError(
            f"plant {plant.name!r} says modes = {plant.modes} but its {method} uses more; set "
            "modes to their number"
        ) from None
    except Exception as error:
        inside = error.__traceback__.tb_next if error.__traceback__ else None
        line = ""
        if inside is not None:
            line = f" at line {inside.tb_lineno} of {Path(inside.tb_frame.f_code.co_filename).name}"
        remedy = ""
        if inside is not None and isinstance(error, RuntimeError | TypeError | FutureWarning):
            jerk = "NoneType" in str(error)
            remedy = "joint.jerk is None: use the other three" if jerk else _CASADIS
        raise _wrong(plant, method, f"fails{line} ({_words(error)})", remedy) from None


def _kind(value: object) -> str:
    return "an expression" if isinstance(value, ca.SX | ca.MX | ca.DM) else type(value).__name__


def _words(error: Exception) -> str:
    """An error's name and first line, without the place in casadi that it comes from."""
    if isinstance(error, FutureWarning):
        return "a function of numpy is given a symbol"
    first = str(error).strip().partition("\n")[0]
    if "to_double" in first or "to_int" in first:
        return "a symbol is no number"
    text = re.sub(r"^\S*\.[ch]pp:\d+: ", "", first).rstrip(".")
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _wrong(plant: Plant, method: str, what: str, remedy: str = "") -> ValueError:
    """What to say of a method: what it does, what to do about it, what it should return."""
    arguments, returns = _WRITE[method]
    remedy = remedy or f"write def {method}({arguments})"
    return ValueError(f"plant {plant.name!r}: {method} {what}; {remedy}, and return {returns}")


class _Equations:
    """The equations of a plant over many motions; every check raises ValueError."""

    def __init__(self, plant: Plant) -> None:
        self._plant, self._modes = plant, plant.modes
        self._points = _points(plant.modes)
        count, columns = self._points.shape
        self._many = [ca.MX.sym(f"x{i}", count) for i in range(columns)]
        # the matrices first: of an SX, math.cos makes a nan
        self._of_many = outputs_of(plant, self._many, count)
        self._one = [ca.SX.sym(f"x{i}") for i in range(columns)]
        self._of_one = outputs_of(plant, self._one)
        self._methods = _methods(plant)

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
        outputs: list[Expression] = [
            entry if isinstance(entry, ca.SX | ca.MX) else ca.repmat(ca.DM(entry), count)
            for entry in self._of_many.all
        ]
        for method, entry in zip(self._methods, outputs, strict=True):
            if entry.shape != (count, 1):
                raise _wrong(self._plant, method, *_MIXED)
        many = ca.Function("many", self._many, [ca.horzcat(*outputs)])
        beside = many(*[ca.DM(column) for column in self._points.T]).full()
        for i, method in enumerate(self._methods):
            alone, together = self._values[:, i], beside[:, i]
            finite = np.isfinite(alone) & np.isfinite(together)
            largest = np.abs(alone[finite]).max(initial=0.0)
            if not np.allclose(alone[finite], together[finite], rtol=1e-9, atol=1e-9 * largest):
                raise _wrong(self._plant, method, *_MIXED)

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
            bad[~np.repeat(self._defined, _KINDS)] = False
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
        wrong = (np.abs(still) > _TINY * moving) & self._defined[:, None]
        wrong[:, self._modes] = False  # the torque may hold the joint
        if wrong.any():
            row, column = np.argwhere(wrong)[0]
            raise ValueError(
                f"plant {self._plant.name!r} does not stay at rest: with the joint at rest at "
                f"{self._resting_angles[row]:.4g} rad and W = 0, {self._methods[column]} gives "
                f"{still[row, column]:.4g}, not 0; measure W from the static deflection"
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
        if not np.nan_to_num(self._values[:, self._modes]).any():
            raise _wrong(
                self._plant, "torque", "is 0 however the joint moves", "write the joint's equation"
            )

    def check_stable(self) -> None:
        """While the joint is at rest no mode grows, and every mode comes back."""
        modes, name = self._modes, self._plant.name
        state = ca.vertcat(*self._one[3 : 3 + 2 * modes])
        slopes = self._evaluated(ca.jacobian(ca.vertcat(*self._of_one.accelerations), state))
        resting = slopes[_KINDS - 1 :: _KINDS][self._defined]
        angles = self._resting_angles[self._defined]
        matrices = np.zeros((len(resting), 2 * modes, 2 * modes))
        matrices[:, :modes, modes:] = np.eye(modes)
        matrices[:, modes:] = resting.reshape(-1, 2 * modes, modes).transpose(0, 2, 1)
        values = np.linalg.eigvals(matrices)
        sizes = np.abs(values)
        loose = np.flatnonzero(sizes.min(axis=1) <= _TINY * sizes.max(axis=1))
        if loose.size:
            raise ValueError(
                f"plant {name!r} has a mode without stiffness: with the joint at rest at "
                f"{angles[loose[0]]:.4g} rad it does not come back, or its damping of "
                f"{sizes[loose[0]].max():.3g} 1/s hardly lets it; check the parameters of its "
                "stiffness, such as omega, and of its damping"
            )
        growth = values.real.max(axis=1)
        grows = np.flatnonzero(growth > _GROWTH * sizes.max(axis=1))
        if grows.size:
            raise ValueError(
                f"plant {name!r} has an unstable mode: with the joint at rest at "
                f"{angles[grows[0]]:.4g} rad it grows as exp({growth[grows[0]]:.3g} t); check the "
                "signs of its parameters, and of stiffness and damping in modal_accelerations, "
                "which returns W'' = -2 zeta omega W' - omega^2 W - ..."
            )

    @cached_property
    def _values(self) -> Array:
        """Every output at every point, a column each."""
        return self._evaluated(ca.vertcat(*self._of_one.all))

    @cached_property
    def _defined(self) -> NDArray[np.bool_]:
        """Which angles the equations hold for: where they are finite for some motion."""
        finite = np.isfinite(self._values).all(axis=1)
        return np.any(finite.reshape(_ANGLES, _KINDS), axis=1, keepdims=True)[:, 0]

    @property
    def _resting_angles(self) -> Array:
        return self._points[_KINDS - 1 :: _KINDS, 0]

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
