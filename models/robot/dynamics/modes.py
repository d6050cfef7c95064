"""Modes and sag of a robot whose driven joints are held."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from quietarm.models.compiled import Compiled
from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.equations_of_motion import Dynamics, SoftSpringError
from quietarm.models.robot.elastic.spectra import spectrum


def sag_at(dynamics: Dynamics, q: Array, begin: Array | None = None) -> Array:
    """Angles of the springs at rest, at one place or at many; ValueError where one is too soft."""
    try:
        return dynamics.sag(q, begin)
    except SoftSpringError as error:
        raise _too_soft(dynamics, str(error), q[error.place]) from None


def modes_at(dynamics: Dynamics, q: Array, p: Array | None = None) -> tuple[Array, Array]:
    """Frequencies [rad/s] and shapes of the modes about the sag, driven joints held."""
    p = sag_at(dynamics, q) if p is None else p
    _, stiffness = dynamics.stiffness_at(q, p)
    masses = dynamics.masses(np.concatenate([q, p]))[dynamics.driven :, dynamics.driven :]
    squares, shapes = spectrum((stiffness + stiffness.T) / 2, masses)
    if squares[0] <= 0:
        weakest = dynamics.mechanism.spring_names[int(np.abs(shapes[:, 0]).argmax())]
        raise _too_soft(dynamics, weakest, q)
    return np.sqrt(squares), shapes


def _too_soft(dynamics: Dynamics, spring: str, q: Array) -> ValueError:
    hint = dynamics.mechanism.hint
    return ValueError(
        f"spring {spring} is too soft to carry its load with the joints at "
        f"{', '.join(f'{x:.4g}' for x in q)}; "
        f"{hint or 'give a stiffer one, or less mass'}"
    )


def tip_offset(dynamics: Dynamics, tip: Any, q: Array, p: Array) -> Array:
    """Return the displacement of the tip, seen in its frame on the rigid robot [m]."""
    x = ca.SX.sym("x", dynamics.size)
    rotation, origin = dynamics.place(tip, x)
    outputs = [ca.densify(rotation), ca.densify(origin)]
    place = Compiled(lambda: ca.Function("place", [x], outputs))
    straight, before = place(np.concatenate([q, 0 * p]))
    _, bent = place(np.concatenate([q, p]))
    return (straight.T @ (bent - before)).ravel()
