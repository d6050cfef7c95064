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
from functools import lru_cache
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models.joint_motion import Expression, JointMotion

if TYPE_CHECKING:
    from quietarm.models.plant import Plant

Array = NDArray[np.float64]

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
    modes = getattr(plant, "modes", None)
    if not isinstance(modes, int) or modes < 1:
        raise ValueError(
            f"plant {plant.name!r} has {'no' if modes is None else repr(modes)} modes; write how "
            "many it has, 1 or more, as modes: ClassVar[int] = 1"
        )
    _check_equations(plant)


@lru_cache(maxsize=256)
def _check_equations(plant: Plant) -> None:
    """The check of the equations; a plant that has passed is not checked again."""
    points, modes = _points(plant.modes), plant.modes
    # the matrices first: of an SX, math.cos makes a nan
    beside = _side_by_side(plant, points)
    x, outputs = _symbolic(plant)
    _check_linear(plant, outputs, x[3 : 3 + 2 * modes])
    tables = (table.full().T for table in _equations(plant)(points.T))
    points, beside, values, slopes = (
        table.reshape(_ANGLES, _KINDS, -1) for table in (points, beside, *tables)
    )
    # an angle at which no motion has a value is none to move to
    defined = np.any(np.isfinite(values).all(axis=2), axis=1)
    kept = defined if defined.any() else np.full(_ANGLES, True)
    points, values, slopes = points[kept], values[kept], slopes[kept]
    _check_finite(plant, points, values, slopes)
    _check_side_by_side(plant, values, beside[kept])
    _check_rest(plant, points[:, -1, 0], values)
    angles = points[:, -1, 0]
    _check_stable(plant, angles, slopes_at_rest(plant, angles)[:, 3 : 3 + 2 * modes, :modes])


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
    values = _equations(plant)(columns)[0].full()
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
    """(joint motion, W, W' and W'' in a column) -> every output, the slopes of all by each."""
    x, outputs = _symbolic(plant)
    slopes = ca.vec(ca.jacobian(outputs, x))
    return ca.Function("equations", [x], [ca.densify(outputs), ca.densify(slopes)])


def slopes_at_rest(plant: Plant, angles: Array) -> Array:
    """Slopes with the joint at rest at angles [rad]: (angles, arguments, outputs)."""
    columns = np.zeros((3 * (1 + plant.modes), len(angles)))
    columns[0] = angles
    slopes = _equations(plant)(columns)[1].full().T
    return slopes.reshape(len(angles), len(columns), -1)


def _symbolic(plant: Plant) -> tuple[ca.SX, ca.SX]:
    """Joint motion, W, W' and W'' as a column of symbols, and the outputs."""
    x = ca.SX.sym("x", 3 * (1 + plant.modes))
    return x, ca.vertcat(*outputs_of(plant, ca.vertsplit(x)))


def _methods(plant: Plant) -> list[str]:
    """The method that each output is of."""
    tips = ["tip_displacements"] * plant.tips
    return ["modal_accelerations"] * plant.modes + ["torque", *tips]


def outputs_of(plant: Plant, arguments: Sequence[Expression]) -> list[Expression]:
    """W'', torque and tip displacements, from joint motion, W, W' and W''.

    ValueError where a method fails or gives something else than it should.
    """
    modes = plant.modes
    joint, rest = JointMotion(*arguments[:3]), list(arguments[3:])
    W, dW, ddW = rest[:modes], rest[modes : 2 * modes], rest[2 * modes :]
    accelerations = _called(plant, "modal_accelerations", joint, W, dW)
    if len(accelerations) != modes:
        raise ValueError(
            f"plant {plant.name!r} says modes = {modes} but gives {len(accelerations)} modal "
            "accelerations; return one for each mode"
        )
    torque = _called(plant, "torque", joint, W, dW, ddW)
    tips = _called(plant, "tip_displacements", W)
    if not tips:
        raise ValueError(
            f"plant {plant.name!r} has no tip displacement; return 1 or more from tip_displacements"
        )
    return [*accelerations, *torque, *tips]


def _called(plant: Plant, method: str, *arguments: object) -> list[Expression]:
    """What a method returns, as a list."""
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", r"\s*casadi: a numpy function", FutureWarning)
            found: Any = getattr(plant, method)(*arguments)
    except Exception as error:
        inside = error.__traceback__.tb_next if error.__traceback__ else None
        line = remedy = ""
        if inside is not None:
            line = f" at line {inside.tb_lineno} of {Path(inside.tb_frame.f_code.co_filename).name}"
            if isinstance(error, RuntimeError | TypeError | FutureWarning):
                remedy = _CASADIS
        if isinstance(error, IndexError):
            remedy = f"it says modes = {plant.modes}: set them to as many as its equations use"
        text = re.sub(r"^\S*\.[ch]pp:\d+: ", "", str(error).strip().partition("\n")[0])
        of_symbol = "to_double" in text or "truth value" in text  # casadi's own words say little
        why = "a symbol is no number" if of_symbol else f"{type(error).__name__}: {text}"
        said = f"fails{line} ({why})"
        raise _wrong(plant, method, said, remedy) from None
    entries = [found] if method == "torque" else found
    if not isinstance(entries, list | tuple):
        raise _wrong(plant, method, "returns no list")
    for entry in entries:
        if not isinstance(entry, Real | ca.SX | ca.MX | ca.DM):
            raise _wrong(plant, method, f"returns {type(entry).__name__}, no expression")
    return list(entries)


def _wrong(plant: Plant, method: str, what: str, remedy: str = "") -> ValueError:
    """What to say of a method: what it does, what to do about it, what it should return."""
    arguments, returns = _WRITE[method]
    remedy = remedy or f"write def {method}({arguments})"
    return ValueError(f"plant {plant.name!r}: {method} {what}; {remedy}, and return {returns}")


def _check_linear(plant: Plant, outputs: ca.SX, state: ca.SX) -> None:
    """The modes and tips are linear in W and W'."""
    if not ca.is_linear(outputs[: plant.modes], state):
        raise ValueError(
            f"plant {plant.name!r}: the modal accelerations are not affine in W and W'; linearise "
            "them: quietarm integrates modes that are linear for a given joint motion"
        )
    if not ca.is_linear(outputs[plant.modes + 1 :], state):
        raise ValueError(
            f"plant {plant.name!r}: the tip displacement is not linear in W; linearise it"
        )


def _side_by_side(plant: Plant, points: Array) -> Array:
    """Every output of many motions that stand side by side in matrices, a column each."""
    columns = [ca.MX.sym("x", len(points)) for _ in points.T]
    found = [ca.MX(entry) for entry in outputs_of(plant, columns)]
    for method, entry in zip(_methods(plant), found, strict=True):
        if entry.shape not in ((1, 1), (len(points), 1)):
            raise _mixed(plant, method)
    together = ca.horzcat(*(ca.MX.zeros(len(points)) + entry for entry in found))
    return ca.Function("many", columns, [together])(*map(ca.DM, points.T.tolist())).full()


def _check_side_by_side(plant: Plant, values: Array, beside: Array) -> None:
    """Many motions side by side give what each gives alone."""
    largest = np.abs(values).max(axis=(0, 1))
    wrong = ~(np.abs(beside - values) <= 1e-9 * (np.abs(values) + largest)).all(axis=(0, 1))
    for column in np.flatnonzero(wrong):
        raise _mixed(plant, _methods(plant)[column])


def _mixed(plant: Plant, method: str) -> ValueError:
    return _wrong(
        plant, method, "mixes motions that stand side by side in a matrix",
        "use operations that work element by element: no sum, dot, mtimes or max over entries",
    )  # fmt: skip


def _check_finite(plant: Plant, points: Array, values: Array, slopes: Array) -> None:
    """Values and slopes are finite at every speed, wherever they are at some speed."""
    methods = _methods(plant)
    for what, table in (("", values), ("the slope of ", slopes)):
        bad = np.argwhere(~np.isfinite(table))
        if bad.size:
            angle, kind, column = bad[-1]  # the simplest motion: at rest, if it fails there
            at = points[angle, kind]
            raise ValueError(
                f"plant {plant.name!r}: {what}{methods[column % len(methods)]} is "
                f"{table[angle, kind, column]} with the joint at {at[0]:.4g} rad, {at[1]:.4g} rad/s"
                f" and {at[2]:.4g} rad/s^2; divide by nothing that can be 0, such as the speed, "
                "take no root of it, and check the parameters"
            )


def _check_rest(plant: Plant, angles: Array, values: Array) -> None:
    """At rest the structure stays at rest; W moves every tip, and moving the joint takes torque."""
    of_torque = plant.modes
    moving, still = np.abs(values[:, :-1]).max(axis=1), values[:, -1]
    wrong = np.abs(still) > _TINY * moving
    wrong[:, of_torque] = False  # the torque may hold the joint
    for row, column in np.argwhere(wrong):
        raise ValueError(
            f"plant {plant.name!r} does not stay at rest: with the joint at rest at "
            f"{angles[row]:.4g} rad and W = 0, {_methods(plant)[column]} gives "
            f"{still[row, column]:.4g}, not 0; measure W from the static deflection"
        )
    unmoved = ~np.any(values != 0, axis=(0, 1))
    if unmoved[of_torque]:
        raise _wrong(plant, "torque", "is 0 however the joint moves", "write the joint's equation")
    for column in np.flatnonzero(unmoved[of_torque + 1 :]):
        raise ValueError(
            f"plant {plant.name!r}: tip displacement {column + 1} is 0 whatever W is; "
            "return one that W moves from tip_displacements, and check the parameters"
        )


def _check_stable(plant: Plant, angles: Array, slopes: Array) -> None:
    """While the joint is at rest no mode grows, and every mode comes back."""
    modes = plant.modes
    matrices = np.zeros((len(angles), 2 * modes, 2 * modes))
    matrices[:, :modes, modes:] = np.eye(modes)
    matrices[:, modes:] = slopes.transpose(0, 2, 1)
    values = np.linalg.eigvals(matrices)
    sizes = np.abs(values)
    for row in np.flatnonzero(sizes.min(axis=1) <= _TINY * sizes.max(axis=1)):
        raise ValueError(
            f"plant {plant.name!r} has a mode without stiffness: with the joint at rest at "
            f"{angles[row]:.4g} rad it does not come back, or its damping of "
            f"{sizes[row].max():.3g} 1/s hardly lets it; check the parameters of its "
            "stiffness, such as omega, and of its damping"
        )
    growth = values.real.max(axis=1)
    for row in np.flatnonzero(growth > _GROWTH * sizes.max(axis=1)):
        raise ValueError(
            f"plant {plant.name!r} has an unstable mode: with the joint at rest at "
            f"{angles[row]:.4g} rad it grows as exp({growth[row]:.3g} t); check the "
            "signs of its parameters, and of stiffness and damping in modal_accelerations, "
            "which returns W'' = -2 zeta omega W' - omega^2 W - ..."
        )


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
