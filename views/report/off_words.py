"""Words on the residual of a motion whose plant is off its model, in one line."""

from __future__ import annotations

from quietarm.ocp.off_model import OffModel
from quietarm.ocp.rest import rest_of
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import FREQUENCY
from quietarm.views.tips import tip_scale

_LOAD = "payload"


def off_words(off: OffModel, task: PointToPoint) -> str:
    """Say what is left off the model: "if the frequency is 2, 5, 10 % off: 1, 3, 8 mm (...)"."""
    by_frequency = off.residuals[FREQUENCY]
    shares = ", ".join(f"{100 * share:g}" for share in by_frequency)
    words = f"if the frequency is {shares} % off: {_lengths([*by_frequency.values()], task)}"
    if off.of_zv is not None:
        words += f" (ZV in the same time {_lengths([off.of_zv], task)} at 5 %)"
    for share, residual in off.residuals.get(_LOAD, {}).items():
        load = _lengths([residual], task)
        words += f"; if the load is {100 * share:g} % off: {load}"
    return f"{words}; --error frequency=5% plans for that"


def _lengths(sizes: list[float], task: PointToPoint) -> str:
    shown, factor = tip_scale(task.plant.tip_unit)
    seen = [size if size > rest_of(task) else 0.0 for size in sizes]
    return f"{', '.join(f'{factor * size:.2g}' for size in seen)} {shown}"
