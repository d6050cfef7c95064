"""Check that what was recorded of a robot's move can be its plan's torques or accelerations.

During the move the torques carry and accelerate the whole arm, gravity included, which the plan
knows better than the swing. A sign, a unit or an order of joints that is wrong shows there, in one
recording alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.learn.robots.robot_start import felt_at_rest
from quietarm.machine.recordings.recording import noise_of
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.models.number_checks import clipped, joined, listed
from quietarm.ocp.planning.plan import Plan

Array = NDArray[np.float64]
_TIMES = 200
"""At which the move is compared."""
_MOST_TORQUE = 8.0
"""Times the plan's torques, beyond which a recording's are in another unit: a kilopond has 9.8."""
_LEAST_TORQUE = 0.01
"""The same below: tau_ext has what the arm carries alone, and not the arm."""
_MOST_ACCELERATION = 20.0
"""Times the plan's acceleration, within which a recording's is: a swing of another size counts."""
_CLOSE = 0.3
"""Share of the power by which what goes the other way may differ from the plan's."""
_FAR_BETTER = 0.1
"""Share of what a torque leaves unexplained, that it leaves with the other sign."""
_EXCHANGED = 0.25
"""The same of columns in another order, with their means and without: friction is no order."""
_CARRIES = 0.05
"""Share of the largest joint's torque, below which another joint's has no sign."""


def check_signals(plan: Plan, recording: RobotRecording, start: float) -> bool:
    """Return whether the torques, which a controller may state from outside, oppose the plan's.

    Parameters
    ----------
    plan, recording : Plan, RobotRecording
        The plan, and the recording of its move.
    start : float
        When the move begins in it [s].

    Raises
    ------
    ValueError
        When torques are the plan's but for the sign or the order of joints, or a signal is in
        another unit.
    """
    times = np.linspace(0, plan.task.duration, _TIMES)
    sampled = plan.sampled(times)
    name = recording.name
    if recording.acceleration is not None:
        swing = np.gradient(np.gradient(sampled.tips, times, axis=0), times, axis=0)
        felt = np.stack(felt_at_rest(plan.task.plant, times, sampled.motion))
        planned = np.concatenate([_without_mean(felt), _without_mean(swing.T)])
        recorded = _columns(recording, recording.acceleration, start + times)
        _refuse_size(name, "acceleration", recorded, planned, 1 / _MOST_ACCELERATION,
                     _MOST_ACCELERATION)  # fmt: skip
    if recording.torques is None:
        return False
    planned = np.stack([*sampled.sample.torques])
    recorded = _columns(recording, recording.torques, start + times)
    _refuse_size(name, "torque", recorded, planned, _LEAST_TORQUE, _MOST_TORQUE)
    names = plan.task.plant.joint_names
    _refuse_turned(name, names, recorded, planned)
    _refuse_exchanged(name, names, recorded, planned)
    return _alike(recorded, planned) < -0.7 and _moves_alike(recorded, planned) < -0.5


def _columns(recording: RobotRecording, values: Array, at: Array) -> Array:
    """The columns of a signal at some times (columns, times)."""
    return np.stack([np.interp(at, recording.time, column) for column in values.T])


def _without_mean(values: Array) -> Array:
    return values - values.mean(axis=1, keepdims=True)


def _size(values: Array) -> float:
    return float(np.sqrt((values**2).sum(axis=0).mean()))


def _alike(recorded: Array, planned: Array) -> float:
    """Correlation of all columns with the plan's, means included: -1 to 1."""
    sizes = np.linalg.norm(recorded) * np.linalg.norm(planned)
    return float((recorded * planned).sum() / max(sizes, 1e-300))


def _moves_alike(recorded: Array, planned: Array) -> float:
    """Correlation of what changes during the move."""
    return _alike(_without_mean(recorded), _without_mean(planned))


def _refuse_size(
    name: str, signal: str, recorded: Array, planned: Array, least: float, most: float
) -> None:
    """Refuse a signal that is far larger or smaller than the plan's: its means and its changes."""
    changes = _without_mean(recorded)
    noise = float(np.linalg.norm(noise_of(recorded.T)))
    clear = max(_size(changes) ** 2 - noise**2, 0.0) ** 0.5
    of_plan, of_changes = _size(planned), max(_size(_without_mean(planned)), 1e-300)
    times = _size(recorded) / max(of_plan, 1e-300)
    too_large = times > most and clear / of_changes > most
    too_small = times < least and _size(changes) / of_changes < least
    if signal == "acceleration":  # one that is still feels gravity, or not
        times = _size(changes) / of_changes
        too_large, too_small = clear / of_changes > most, times < least
    if too_large or too_small:
        scale = 10.0 ** round(-np.log10(max(times, 1e-300)))
        unit = "m/s^2" if signal == "acceleration" else "N m"
        raise ValueError(
            f"{name}: its {signal} during the move is {times:.3g} times the plan's; give its unit "
            f"by --units, or what one of it is in {unit}, such as --scale {signal}={scale:g}"
        )


def _refuse_turned(name: str, names: Sequence[str], recorded: Array, planned: Array) -> None:
    """Refuse torques of joints that are the plan's with the other sign."""
    sizes = np.linalg.norm(planned, axis=1)
    carrying = np.flatnonzero(sizes > _CARRIES * sizes.max()).tolist()
    turned = [k for k in carrying if _is_turned(recorded[k : k + 1], planned[k : k + 1])]
    if not turned:
        return
    largest = sorted(carrying, key=lambda k: -sizes[k])[:3]
    met = [f"{names[k]} {_alike(recorded[k : k + 1], planned[k : k + 1]):+.2f}" for k in largest]
    said = f"{name}: its torques during the move, gravity included, correlate with the plan's by"
    said = f"{said} {listed(met)}"
    if len(turned) == len(carrying):
        raise ValueError(
            f"{said}: they have the other sign, as those that act on the robot from outside; give "
            "--scale torque=-1, or leave it out"
        )
    raise ValueError(
        f"{said}: {joined(clipped(names[k]) for k in turned)} with the other sign; turn each such "
        "column"
    )


def _is_turned(recorded: Array, planned: Array) -> bool:
    """Return whether a joint's torque is the plan's with the other sign and no other's."""
    against = float(((recorded + planned) ** 2).sum())
    along = float(((recorded - planned) ** 2).sum())
    is_close = against < _CLOSE * float((planned**2).sum())
    return is_close and against < _FAR_BETTER * along and _moves_alike(recorded, planned) < -0.5


def _refuse_exchanged(name: str, names: Sequence[str], recorded: Array, planned: Array) -> None:
    """Refuse columns of joints that follow the plan's torques of each other."""
    from scipy.optimize import linear_sum_assignment  # not at the top: it takes long to load

    cost = _costs(recorded, planned)
    of_changes = _costs(_without_mean(recorded), _without_mean(planned))
    _, order = linear_sum_assignment(cost)
    for cycle in _cycles(order.tolist()):
        others = [int(order[k]) for k in cycle]
        if all(
            float(each[cycle, others].sum()) < _EXCHANGED * float(each[cycle, cycle].sum())
            for each in (cost, of_changes)
        ):
            raise ValueError(
                f"{name}: the torques of {joined(clipped(names[k]) for k in cycle)} look "
                "exchanged: during the move each is what the plan says of another; give the "
                "columns in the order of the joints, or by the joints' names"
            )


def _costs(recorded: Array, planned: Array) -> Array:
    """Power that each recorded column differs by from each planned one."""
    costs: Array = ((recorded[:, None] - planned[None]) ** 2).sum(axis=-1)
    return costs


def _cycles(order: Sequence[int]) -> list[list[int]]:
    """The places of an order that are exchanged among each other."""
    cycles = list[list[int]]()
    waiting = {k for k, other in enumerate(order) if other != k}
    while waiting:
        cycle = [min(waiting)]
        while order[cycle[-1]] != cycle[0]:
            cycle.append(order[cycle[-1]])
        cycles.append(cycle)
        waiting -= set(cycle)
    return cycles
