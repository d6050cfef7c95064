"""Check that a plant can exist, by its equations linearised with the joint at rest.

Torque over joint speed is an impedance Z(s). No work is gained where it is positive real (Brune, J.
Math. and Phys. 10, 1931): where its real part is not negative for any s whose own is positive.
Slopes are those of W'' and the torque (last axis) by the joint's angle, speed and acceleration, W
and W', at every angle.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from quietarm.models.joint_motion import Array


def eigenvalues(slopes: Array) -> NDArray[np.complex128]:
    """Return the modes' eigenvalues [1/s], two for each mode, at every angle."""
    by_W, by_dW = _of_modes(slopes)
    unit = np.broadcast_to(np.eye(by_W.shape[1]), by_W.shape)
    return np.linalg.eigvals(np.block([[0 * unit, unit], [by_W, by_dW]])).astype(complex)


def check_stable(plant: str, angles: Array, slopes: Array) -> None:
    """Refuse a plant of this name one of whose modes grows, or does not come back."""
    values = eigenvalues(slopes)
    largest = np.abs(values).max(axis=1, keepdims=True)
    # An eigenvalue that is nothing, relative to the largest.
    tiny = 1e-12
    # Growth of a mode, relative to its frequency, that rounding does not explain.
    growth = 1e-6
    wrong = (values.real > growth * largest) | (np.abs(values) <= tiny * largest)
    for row, mode in np.argwhere(wrong):
        raise ValueError(
            f"plant {plant!r} has a mode that grows or drifts: with the joint at rest at "
            f"{angles[row]:.4g} rad it goes as exp({values[row, mode].real:.3g} t); check its "
            "parameters and the signs in W'' = -2 zeta omega W' - omega^2 W - ..."
        )


def refuse_active_rest(plant: str, angles: Array, slopes: Array) -> None:
    """Refuse a plant of this name whose joint has no inertia, or yields work from rest."""
    by_W, by_dW = _of_modes(slopes)
    modes = by_W.shape[1]
    inertia = slopes[:, 2, modes]
    if inertia.min() <= 0:
        raise ValueError(
            f"plant {plant!r} has no positive inertia: with the joint at rest at "
            f"{angles[inertia.argmin()]:.4g} rad an acceleration of 1 rad/s^2 takes "
            f"{inertia.min():.3g} N m; check its parameters, and the signs in torque"
        )
    # Z is looked at close to the imaginary axis, at these multiples of the modes' frequencies.
    swings = (1e-3 + 1j) * np.geomspace(1e-2, 1e2, 21)
    s = np.sqrt(np.abs(np.linalg.eigvals(by_W)))[..., None] * swings
    s = s.reshape(len(angles), -1, 1)
    # the torque that holds the joint at another angle does no work in a period
    driven = slopes[:, None, 1] + s * slopes[:, None, 2]
    system = s[..., None] * (s[..., None] * np.eye(modes) - by_dW[:, None]) - by_W[:, None]
    W = np.linalg.solve(system, driven[..., :modes, None])[..., 0]
    state = np.concatenate([W, s * W], axis=2)
    impedance = driven[..., modes] + (slopes[:, None, 3:, modes] * state).sum(axis=2)
    shares = (impedance.real / np.abs(impedance)).min(axis=1)
    # Share of |Z| that its real part may be below 0, as coefficients are identified one by one.
    identified = 1e-2
    if shares.min() < -identified:
        raise ValueError(
            f"plant {plant!r} yields work from rest: a joint that swings about "
            f"{angles[shares.argmin()]:.4g} rad gets back more than it gave, as torque and modes "
            "do not belong together; check its parameters, and the signs in its equations"
        )


def _of_modes(slopes: Array) -> tuple[Array, Array]:
    """Slopes of W'' (rows) by W and W' (columns), at every angle."""
    modes = (slopes.shape[1] - 3) // 2
    of_modes = slopes[:, 3:, :modes].swapaxes(1, 2)
    return of_modes[..., :modes], of_modes[..., modes:]
