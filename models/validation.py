"""The contract of a plant, checked once, when a task is made.

The equations are called as the solvers call them, and evaluated over a turn and more of joint
angles, moving and at rest, and along a move.
"""

from __future__ import annotations

import math
import reprlib
import traceback
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import Field, is_dataclass
from functools import lru_cache
from itertools import pairwise
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from quietarm.models import at_rest
from quietarm.models.compiled import Compiled
from quietarm.models.dimensions import INERTIA
from quietarm.models.drive import Drive
from quietarm.models.joint_motion import Array, Expression, JointMotion
from quietarm.models.kept_functions import kept_function
from quietarm.models.number_checks import quoted, words_of_error

if TYPE_CHECKING:
    from quietarm.models.plant import Plant

_WRITE = {
    "modal_accelerations": "(self, joint, W, dW) that returns a list of W'' [m/s^2], one a mode",
    "torque": "(self, joint, W, dW, ddW) that returns one expression, the joint torque [N m]",
    "tip_displacements": "(self, W) that returns a list of tip displacements [m]",
    "joints": "(self, path) that returns a list of JointMotion, one a joint",
    "torques": "(self, path, W, dW, ddW) that returns a list of torques [N m], one a joint",
    "tips_at": "(self, path, W) that returns a list of tip displacements [m]",
    "tip_speeds": "(self, path, W, dW) that returns a list of tip speeds [m/s]",
    "tip_accelerations": "(self, path, W, dW, ddW) that returns tip accelerations [m/s^2]",
}
"""What every method takes, and what it should return."""
_RIGHT = math.pi / 2
_ANGLES = np.linspace(-2 * math.pi, 2 * math.pi, 241)
_ANGLES += np.random.default_rng(0).uniform(-0.02, 0.02, 241)  # else sin(60 angle) is 0 at all
_ANGLES[:5] = _RIGHT * np.array([0, -1, 1, -2, 2])
_KINDS = np.array([[1, 1, 1, 1], [1, -1, 1, 1], [1, 0, 1, 1], [1, 1, 0, 1], [1, 0, 0, 0]])
"""Factors of angle, speed, acceleration and modes in the motions at an angle: forwards, backwards,
at a turning point, at constant speed and, last, at rest."""
_EITHER = {"torque": "torques", "tip_displacements": "tips_at"}
"""Methods of which a plant gives one: for one joint or the same tips at any place, or for all."""


def check_contract(plant: Plant) -> None:
    """Refuse a plant that breaks the contract of `Plant`; ValueError with what is wrong."""
    plant = plant.as_checked
    kind = type(plant)
    modes = getattr(plant, "modes", None)
    bare = any(isinstance(entry, Field) for entry in vars(kind).values())
    is_frozen = is_dataclass(plant) and not bare and kind.__hash__ is not None
    if not (is_frozen and isinstance(modes, int) and modes > 0):
        raise ValueError(
            f"plant {plant.name!r} is no frozen dataclass, or has {modes} modes; write "
            f"@dataclass(frozen=True) above {kind.__name__} and modes: ClassVar[int] = 1 in it"
        )
    for method, general in _EITHER.items():
        if not (_gives(plant, method) or _gives(plant, general)):
            raise _wrong(plant, method, f"is missing, as is {general}")
    _slopes_at_rest(plant)
    _check_rates(plant)


@lru_cache(maxsize=256)
def check_passive(plant: Plant) -> None:
    """Refuse a plant whose joint has no positive inertia, or yields work from rest."""
    at_rest.refuse_active_rest(plant.name, *_slopes_at_rest(plant.as_checked))


def check_drive(plant: Plant) -> None:
    """Refuse what is no drive, a drive of several joints, and a rotor that is not of the plant."""
    drive = plant.drive
    if drive is None:
        return
    if not isinstance(drive, Drive):
        raise TypeError(f"drive is {quoted(drive)}; give {Drive.example}")
    if plant.has_path:
        raise ValueError(
            f"{plant.name} has a path and a drive was given, which is for a plant of one joint; "
            "leave it out, and give a robot its coulomb and rotor_inertia"
        )
    if not drive.rotor:
        return
    still = [0.0] * plant.modes
    path = JointMotion(0.0, 0.0, 1.0)
    pushed = [float(rate) for rate in plant.modal_accelerations(path, still, still)]
    held = float(plant.torque(JointMotion(0.0, 0.0, 0.0), still, still, still))
    inertia = float(plant.torque(path, still, still, pushed)) - held
    if drive.rotor >= inertia:
        unit = INERTIA.of(plant.joint)
        raise ValueError(
            f"rotor is {drive.rotor:g} {unit} of {inertia:.4g} {unit} that move without what "
            "swings; give the rotor's part of these, as felt at the joint"
        )


@lru_cache(maxsize=1024)
def check_along(plant: Plant, start: float, target: float) -> None:
    """Refuse a move [rad] on which the equations have no value, as a crank's at its dead centre."""
    low, high = sorted((start, target))
    count = 101
    quarters = np.arange(math.ceil(low / _RIGHT), math.floor(high / _RIGHT) + 1)
    right = _RIGHT * quarters[:count]
    angles = np.concatenate([[start, target], right, np.linspace(low, high, count)])
    motions = _motions(angles, plant.modes)[:, :: len(_KINDS) - 1]  # forwards and at rest
    _check_finite(plant, motions, next(_evaluate(plant, motions)))


@lru_cache(maxsize=4096)
def eigenvalues_at_rest(plant: Plant, angle: float) -> tuple[complex, ...]:
    """Eigenvalues of the modes [1/s] with the joint at rest at an angle [rad].

    ValueError where the equations have no value there.
    """
    motion = np.zeros((1, 1, 3 + 2 * plant.modes))
    motion[..., 0] = angle
    values, slopes = _evaluate(plant, motion)
    _check_finite(plant, motion, np.concatenate([values, slopes], axis=2))
    of_inputs = slopes.reshape(1, motion.shape[2], -1)
    return tuple(map(complex, at_rest.eigenvalues(of_inputs)[0]))


@lru_cache(maxsize=256)
def _slopes_at_rest(plant: Plant) -> tuple[Array, Array]:
    """Angles that have values, and the slopes there; ValueError where the equations are wrong."""
    motions = _motions(_angles_of(plant), plant.modes)
    values, slopes = _evaluate(plant, motions)
    # an angle at which no motion has a value is none to move to
    defined = np.any(np.isfinite(values).all(axis=2), axis=1)
    if defined.any():
        motions = motions[defined]
        values = values[defined]
        slopes = slopes[defined]
    _check_finite(plant, motions, np.concatenate([values, slopes], axis=2))
    _check_side_by_side(plant, motions, values)
    _check_rest(plant, motions, values)
    # where the angle does not matter, the first is enough
    still, first = np.unique(slopes[:, -1], axis=0, return_index=True)
    at_angles = motions[first, -1, 0], still.reshape(len(still), motions.shape[2], -1)
    at_rest.check_stable(plant.name, *at_angles)
    return at_angles


def _angles_of(plant: Plant) -> Array:
    """The joint angles, or places on its path, at which a plant is looked at."""
    if plant.path_range is None:
        return _ANGLES
    ends = plant.path_range
    if len(ends) != 2 or not -math.inf < ends[0] < ends[1] < math.inf:
        raise ValueError(
            f"plant {plant.name!r}: path_range is {ends!r}; give the least and the largest place, "
            "as (0.0, 1.0)"
        )
    return np.linspace(*ends, len(_ANGLES))


def _gives(plant: Plant, method: str) -> bool:
    """Return whether the plant has a method of its own in place of the contract's."""
    contract = next(kind for kind in reversed(type(plant).__mro__) if "joints" in vars(kind))
    return getattr(type(plant), method) is not getattr(contract, method)


def _motions(angles: Array, modes: int) -> Array:
    """Joint motion, W and W' in the last axis, of every kind at every angle."""
    columns = [1, 1, 1, 2 * modes]
    random = np.random.default_rng(0).uniform(-1, 1, (len(angles), 1, sum(columns)))
    motions = random * np.repeat(_KINDS * [1, 10, 100, 1], columns, axis=1) + 0.0  # no -0
    motions[..., 0] = angles[:, None]
    return motions


def _evaluate(plant: Plant, motions: Array) -> Iterator[Array]:
    """Outputs of motions in the last axis; then their slopes, in the order of `_equations`."""
    columns = motions.reshape(-1, motions.shape[-1]).T
    tables = Compiled.guard(lambda: [table.full() for table in _equations(plant)(columns)])
    for table in tables:
        yield table.T.reshape(*motions.shape[:2], -1)


@lru_cache(maxsize=256)
def _equations(plant: Plant) -> ca.Function:
    """(joint motion, W and W' in a column) -> every output, the slopes of all by each."""
    if not plant.is_kept:
        return _build_equations(plant)
    return kept_function(("equations", plant), lambda: _build_equations(plant))


def _build_equations(plant: Plant) -> ca.Function:
    size = 3 + 2 * plant.modes
    outputs_of(plant, [ca.MX.sym("x") for _ in range(size)])  # math.cos makes a nan of an SX
    x = ca.SX.sym("x", size)
    outputs = outputs_of(plant, ca.vertsplit(x))
    for method, output in zip(_methods(plant), outputs):
        if method not in ("torque", "torques") and not ca.is_linear(output, x[3:]):
            raise _wrong(plant, method, "is not affine in W and W'", "linearise it")
    column = ca.densify(ca.vertcat(*outputs))
    slopes = ca.densify(ca.vec(ca.jacobian(column, x)))
    return ca.Function("equations", [x], [column, slopes])


def _methods(plant: Plant) -> list[str]:
    """The method that each output is of."""
    torque, tips = (_method_of(plant, method) for method in _EITHER)
    return ["modal_accelerations"] * plant.modes + [torque] + [tips] * plant.tips


def _method_of(plant: Plant, method: str) -> str:
    """The method by which a plant gives the torque, or the tips."""
    return method if _gives(plant, method) else _EITHER[method]


def outputs_of(plant: Plant, arguments: Sequence[Expression]) -> list[Expression]:
    """W'', torque along the path and tip displacements, from joint motion, W and W'.

    ValueError where a method fails or gives something else than it should.
    """
    joint = JointMotion(*arguments[:3])
    modes = plant.modes
    W = list(arguments[3 : 3 + modes])
    dW = list(arguments[3 + modes :])
    ddW = _call(plant, "modal_accelerations", joint, W, dW)
    return [*ddW, _torque(plant, joint, W, dW, ddW), *_tips(plant, joint, W)]


def _torque(plant: Plant, path: JointMotion, *modes: list[Expression]) -> Expression:
    """The torque along the path; ValueError where joints and torques are not as they should be."""
    if not _gives(plant, "joints"):
        return _call(plant, _method_of(plant, "torque"), path, *modes)[0]
    joints = _call(plant, "joints", path)
    torques = _call(plant, "torques", path, *modes)
    counts = len(joints), len(torques), len(plant.joint_names)
    if len(set(counts)) > 1:
        what = "has {} joints, {} torques and {} joint_names".format(*counts)
        raise _wrong(plant, "torques", what, "give one of each for every joint")
    return plant.torque(path, *modes)


def _tips(plant: Plant, path: JointMotion, W: list[Expression]) -> list[Expression]:
    """The tips' displacements."""
    if _gives(plant, "tips_at"):
        return _call(plant, "tips_at", path, W)
    return _call(plant, "tip_displacements", W)


def _call(plant: Plant, method: str, *arguments: object) -> list[Expression]:
    """Call a method of the plant and return its result as a list."""
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings(
                "error",
                r"\s*casadi: a numpy function",
                FutureWarning,
            )
            result: Any = getattr(plant, method)(*arguments)
    except (Exception, SystemExit) as error:
        inside = traceback.extract_tb(error.__traceback__)[1:2]
        at = "".join(f" at line {frame.lineno} of {Path(frame.filename).name}" for frame in inside)
        text = str(error)
        of_symbol = "to_double" in text or "truth value" in text  # casadi's own words say little
        why = "a symbol is no number" if of_symbol else _first_line(error)
        raise _wrong(plant, method, f"fails{at} ({why})") from None
    entries = [result] if method == "torque" else result
    entries = list(entries) if isinstance(entries, list | tuple) else []
    count = plant.modes if method == "modal_accelerations" else max(1, len(entries))
    kinds = JointMotion if method == "joints" else Real | ca.SX | ca.MX | ca.DM
    if len(entries) != count or not all(isinstance(entry, kinds) for entry in entries):
        raise _wrong(plant, method, f"returns {reprlib.repr(result)}")
    return entries


def _first_line(error: BaseException) -> str:
    """Say what went wrong in a method, by the first of casadi's many lines."""
    if isinstance(error, SystemExit):
        return words_of_error(error)
    text = str(error).strip().partition("\n")[0]
    return f"{type(error).__name__}: {text}"


def _wrong(plant: Plant, method: str, what: str, remedy: str = "") -> ValueError:
    """Make the error about what a method does, with a remedy."""
    write = f"write def {method}{_WRITE[method]} for modes = {plant.modes}"
    symbols = (
        "with casadi.cos, casadi.if_else and so on, as math, numpy, if and max take no symbols"
    )
    return ValueError(f"plant {plant.name!r}: {method} {what}; {remedy or f'{write}, {symbols}'}")


def _check_side_by_side(plant: Plant, motions: Array, values: Array) -> None:
    """Many motions that stand side by side in matrices give what each gives alone."""
    outputs = outputs_of(plant, [ca.DM(column.ravel()) for column in np.moveaxis(motions, 2, 0)])
    by_output = np.moveaxis(values, 2, 0).reshape(len(outputs), -1)
    for method, output, alone in zip(_methods(plant), outputs, by_output):
        together = ca.DM(output).full().T
        least = 1e-9 * np.abs(alone).max()
        if len(together) > 1 or not np.allclose(together, alone, rtol=1e-9, atol=least):
            remedy = "compute entry by entry: no sum, dot, mtimes or max over entries"
            raise _wrong(
                plant,
                method,
                "mixes motions that are side by side in a matrix",
                remedy,
            )


Rate = tuple[str, Expression, Expression]
"""A method of a plant, a value, and the rate of it that the method gives."""


@lru_cache(maxsize=256)
def _check_rates(plant: Plant) -> None:
    """Rates of the joints, and of the tips, are the time derivatives of angles and displacements.

    By the chain rule along the path: a time derivative is that by the place, times its speed, and
    so on; the path's jerk stands for the time derivative of its acceleration.
    """
    size = 4 + 3 * plant.modes
    x = ca.SX.sym("x", size)
    path = JointMotion(*ca.vertsplit(x[:4]))
    W, dW, ddW = (x[4 + i * plant.modes : 4 + (i + 1) * plant.modes] for i in range(3))
    moving = ca.vertcat(path.angle, path.speed, path.acceleration, W, dW)
    rates = ca.vertcat(path.speed, path.acceleration, path.jerk, dW, ddW)
    pairs = [
        *_rates_of_joints(plant, path),
        *_rates_of_tips(plant, path, [ca.vertsplit(part) for part in (W, dW, ddW)]),
    ]
    if not pairs:
        return
    angles = _angles_of(plant)
    random = np.random.default_rng(0).uniform(-1, 1, (len(angles), size))
    random[:, 0] = angles
    methods, values, stated = zip(*pairs)
    due = ca.densify(ca.jtimes(ca.vertcat(*values), moving, rates))
    outputs = [due, ca.densify(ca.vertcat(*stated))]
    both = Compiled(lambda: ca.Function("rates", [x], outputs).map(len(angles)))
    should, are = both(random.T)
    largest = np.abs(should).max(axis=1, keepdims=True)
    rounding = 1e-9 * np.maximum(largest, 1e-3)
    for row, column in np.argwhere(~(np.abs(are - should) <= rounding)):
        at = f"at {angles[column]:.4g} of the path"
        what = f"gives a rate of {are[row, column]:.6g} {at} where it is {should[row, column]:.6g}"
        raise _wrong(
            plant,
            methods[row],
            what,
            "give the time derivatives along the path",
        )


def _rates_of_joints(plant: Plant, path: JointMotion) -> Iterator[Rate]:
    """Each value of the joints' motions and what a plant gives as its rate."""
    if not _gives(plant, "joints"):
        return
    for joint in _call(plant, "joints", path):
        for value, rate in pairwise(joint):
            if rate is None:
                raise _wrong(plant, "joints", "gives no jerk where the path has one", "give it")
            yield "joints", value, rate


def _rates_of_tips(
    plant: Plant, path: JointMotion, modes: list[list[Expression]]
) -> Iterator[Rate]:
    """Check rates of the tips that are not CasADi's; modes are W, W' and W''."""
    tips = _tips(plant, path, modes[0])
    for order, method in enumerate(("tip_speeds", "tip_accelerations"), start=1):
        if not _gives(plant, method):
            continue
        before = tips if order == 1 else _call(plant, "tip_speeds", path, *modes[:2])
        given = _call(plant, method, path, *modes[: order + 1])
        if len(tips) != len(given):
            what = f"returns {len(given)} of {len(tips)} tips"
            raise _wrong(plant, method, what, "give one for every tip")
        for value, rate in zip(before, given):
            yield method, value, rate


def _check_finite(plant: Plant, motions: Array, table: Array) -> None:
    """Values, and slopes after them, are finite in every motion."""
    finite = np.isfinite(table)
    methods = _methods(plant)
    if not finite.all():
        angle, kind, _ = np.argwhere(~finite)[-1]  # the simplest motion: at rest, if it fails there
        column = finite[angle, kind].argmin()
        what = "is" if column < len(methods) else "has a slope of"
        at = "{:.4g} rad, {:.4g} rad/s and {:.4g} rad/s^2".format(*motions[angle, kind])
        what = f"{what} {table[angle, kind, column]} with the joint at {at}"
        remedy = (
            "move where it is defined, or divide by nothing that can be 0 and check the parameters"
        )
        raise _wrong(plant, methods[column % len(methods)], what, remedy)


def _check_rest(plant: Plant, motions: Array, values: Array) -> None:
    """Check that the structure stays at rest and that motions move every tip."""
    still = values[:, -1]
    moving = np.abs(values).max(axis=1)
    # What counts as nothing, relative to the values of a moving joint.
    tiny = 1e-12
    wrong = np.abs(still) > tiny * moving
    wrong[:, plant.modes] = False  # the torque may hold the joint
    for row, column in np.argwhere(wrong):
        at = f"with the joint at rest at {motions[row, -1, 0]:.4g} rad and W = 0"
        what = f"gives {still[row, column]:.4g}, not 0, {at}"
        raise _wrong(
            plant,
            _methods(plant)[column],
            what,
            "measure W from the static deflection",
        )
    if not moving[:, plant.modes + 1 :].any(axis=0).all():
        raise _wrong(
            plant,
            "tip_displacements",
            "returns a tip that no W moves",
            "give W a factor",
        )
