"""Whether a plant can exist, by its equations linearised with the joint at rest.

The modes must be stable. Torque over joint speed is an impedance Z(s): Z(s)/s at the highest
frequencies is the inertia, and no work is gained where Z is positive real (Brune, J. Math. and
Phys. 10, 1931): where its real part is not negative for any s whose own is positive.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_TINY = 1e-12
"""An eigenvalue that is nothing, relative to the largest."""
_GROWTH = 1e-6
"""Growth of a mode, relative to its frequency, that rounding does not explain."""
_IDENTIFIED = 1e-2
"""Share of |Z| that its real part may be below 0: coefficients are identified one by one, and the
paper's arm changes the sign of its coupling in the modes and in the torque 1 degree apart."""
_SWINGS = (1e-3 + 1j) * np.geomspace(1e-2, 1e2, 21)
"""Z is looked at close to the imaginary axis, at these multiples of the modes' frequencies."""


class AtRest(NamedTuple):
    """W'' + D W' + K W = push (theta, theta', theta''), and the torque, at many joint angles.

    Attributes
    ----------
    angles : ndarray, shape (angles,)
        Joint angles [rad].
    K, D : ndarray, shape (angles, modes, modes)
        Stiffness [1/s^2] and damping [1/s].
    push : ndarray, shape (angles, 3, modes)
        W'' by the joint's angle, speed and acceleration.
    torque_of_joint, torque_of_modes : ndarray, shapes (angles, 3) and (angles, 3, modes)
        Torque by these, and by W, W' and W''.
    """

    angles: Array
    K: Array
    D: Array
    push: Array
    torque_of_joint: Array
    torque_of_modes: Array

    @classmethod
    def of_slopes(cls, angles: Array, slopes: Array) -> AtRest:
        """From the slopes of the outputs, in the last axis, by every argument of the equations."""
        modes = slopes.shape[1] // 3 - 1
        joint, by_modes = slopes[:, :3], slopes[:, 3:].reshape(len(angles), 3, modes, -1)
        K, D = (-by_modes[:, part, :, :modes].swapaxes(1, 2) for part in (0, 1))
        return cls(angles, K, D, joint[..., :modes], joint[..., modes], by_modes[..., modes])

    def check_stable(self, plant: str) -> None:
        """Refuse a plant of this name one of whose modes grows, or does not come back."""
        none, one = np.zeros_like(self.K), np.broadcast_to(np.eye(self.K.shape[1]), self.K.shape)
        values = np.linalg.eigvals(np.block([[none, one], [-self.K, -self.D]]))
        sizes = np.abs(values)
        largest = sizes.max(axis=1, keepdims=True)
        wrong = (values.real > _GROWTH * largest) | (sizes <= _TINY * largest)
        for row, mode in np.argwhere(wrong):
            raise ValueError(
                f"plant {plant!r} has a mode that grows or drifts: with the joint at rest at "
                f"{self.angles[row]:.4g} rad it goes as exp({values[row, mode].real:.3g} t); check "
                "its parameters, and the signs of stiffness and damping in modal_accelerations, "
                "which returns W'' = -2 zeta omega W' - omega^2 W - ..."
            )

    def check_passive(self, plant: str) -> None:
        """Refuse a plant of this name without inertia, or one that yields work from rest."""
        followed = (self.torque_of_modes[:, 2] * self.push[:, 2]).sum(axis=1)
        inertia = self.torque_of_joint[:, 2] + followed
        worst = inertia.argmin()
        if inertia[worst] <= 0:
            raise ValueError(
                f"plant {plant!r} has no positive inertia: with the joint at rest at "
                f"{self.angles[worst]:.4g} rad an acceleration of 1 rad/s^2 takes "
                f"{inertia[worst]:.3g} N m, with the modes that follow; check its parameters, and "
                "the signs in torque"
            )
        impedance = self._impedance()
        shares = (impedance.real / np.abs(impedance)).min(axis=1)
        if shares.min() < -_IDENTIFIED:
            raise ValueError(
                f"plant {plant!r} yields work from rest: a joint that swings about "
                f"{self.angles[shares.argmin()]:.4g} rad gets back more than it gave, as its "
                "torque and modes do not belong together; check its parameters and signs"
            )

    def _impedance(self) -> NDArray[np.complex128]:
        """Z at swings about every angle, per frequency of every mode."""
        s = np.sqrt(np.abs(np.linalg.eigvals(self.K)))[..., None] * _SWINGS
        s = s.reshape(len(self.angles), -1, 1)
        push, by_joint, by_modes = (
            part[:, None] for part in (self.push, self.torque_of_joint, self.torque_of_modes)
        )
        system = s[..., None] * (s[..., None] * np.eye(self.K.shape[1]) + self.D[:, None])
        system = system + self.K[:, None]
        # of the joint's rates: what holds it at another angle does no work in a period
        W = np.linalg.solve(system, (push[:, :, 1] + s * push[:, :, 2])[..., None])[..., 0]
        torque = sum(s**k * by_modes[:, :, k] * W for k in range(3)).sum(axis=2)
        return torque + by_joint[:, :, 1] + s[..., 0] * by_joint[:, :, 2]
