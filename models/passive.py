"""Whether a plant can exist: its joint has inertia, and gives back no more work than it got.

Both are asked of the equations linearised at rest, with the joint swinging a little about an angle.
The torque over the joint's speed is then an impedance Z(s). The inertia is Z(s)/s at the highest
frequencies; no work is gained where Z is positive real (Brune, J. Math. and Phys. 10, 1931): where
its real part is not negative for any s whose own is positive.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from quietarm.models.contract import check_contract, slopes_at_rest

if TYPE_CHECKING:
    from quietarm.models.plant import Plant

Array = NDArray[np.float64]
_ANGLES = np.append(0.0, np.linspace(-np.pi, np.pi, 120))
_IDENTIFIED = 1e-2
"""Share of |Z| that its real part may be below 0: coefficients are identified one by one, and the
paper's arm changes the sign of its coupling in the modes and in the torque 1 degree apart."""
_GROWING = 1e-3 + 1j
_BESIDE = np.geomspace(1e-2, 1e2, 21)
"""Z is looked at close to the imaginary axis, at these multiples of the modes' frequencies."""
_STEP = 1e-3
"""By which share parameters are changed to see which of them matter."""


@lru_cache(maxsize=256)
def check_passive(plant: Plant) -> None:
    """The joint's inertia is positive, and no swing from rest yields work; ValueError otherwise."""
    slopes = slopes_at_rest(plant, _ANGLES)
    there = np.isfinite(slopes).all(axis=(1, 2))  # an angle without values is none to move to
    angles, slopes = _ANGLES[there], slopes[there]
    inertia = _inertia(slopes)
    worst = int(inertia.argmin())
    if inertia[worst] <= 0:
        raise ValueError(
            f"plant {plant.name!r} has no positive inertia: with the joint at rest at "
            f"{angles[worst]:.4g} rad an acceleration of 1 rad/s^2 takes {inertia[worst]:.3g} N m, "
            f"with the modes that follow; check {_that_matter(plant, angles[worst])}"
        )
    shares = _work_shares(slopes)
    worst = int(shares.argmin())
    if shares[worst] < -_IDENTIFIED:
        raise ValueError(
            f"plant {plant.name!r} yields work from rest: a joint that swings about "
            f"{angles[worst]:.4g} rad gets back more than it gave, as its torque and its modes do "
            f"not belong together; check the sign of {_of_wrong_sign(plant, angles[worst])}"
        )


def _that_matter(plant: Plant, angle: float) -> str:
    """The parameters on which the inertia depends, the most important first."""
    at = np.array([angle])
    changes = {
        name: abs(
            float(_inertia(slopes_at_rest(one, at))[0] - _inertia(slopes_at_rest(plant, at))[0])
        )
        for name, one in _with_each(plant, 1 - _STEP)
    }
    matter = [name for name in changes if changes[name] > 0]
    return ", ".join(sorted(matter, key=lambda name: -changes[name])) or "its equations"


def _of_wrong_sign(plant: Plant, angle: float) -> str:
    """The parameters that would mend the plant with the other sign."""

    def mends(one: Plant) -> bool:
        with suppress(ValueError):
            check_contract(one)
            return bool(_work_shares(slopes_at_rest(one, np.array([angle])))[0] >= -_IDENTIFIED)
        return False

    mended = [name for name, one in _with_each(plant, -1) if mends(one)]
    return " or ".join(mended) or "its equations"


def _with_each(plant: Plant, factor: float) -> Iterator[tuple[str, Plant]]:
    for name, value in plant.parameters.items():
        yield name, replace(plant, **{name: factor * value})


def _inertia(slopes: Array) -> Array:
    """Torque per acceleration from rest, with the modes that follow at once [kg m^2]."""
    modes = slopes.shape[1] // 3 - 1
    followed = slopes[:, 2, :modes] * slopes[:, -modes:, modes]
    return slopes[:, 2, modes] + followed.sum(axis=1)


def _work_shares(slopes: Array) -> Array:
    """The least real part of Z over its size, at every angle."""
    modes = slopes.shape[1] // 3 - 1
    by_W, by_dW, by_ddW = (slopes[:, 3 + k * modes : 3 + (k + 1) * modes] for k in range(3))
    stiffness, damping = (-part[:, :, :modes].transpose(0, 2, 1) for part in (by_W, by_dW))
    own = np.sqrt(np.abs(np.linalg.eigvals(stiffness)))
    s = _GROWING * (own[:, :, None] * _BESIDE).reshape(len(slopes), -1, 1)
    system = s[..., None] ** 2 * np.eye(modes) + s[..., None] * damping[:, None]
    system = system + stiffness[:, None]
    # per joint angle; the torque that holds the joint at another angle does no work in a period
    driven = s**2 * slopes[:, None, 2, :modes] + s * slopes[:, None, 1, :modes]
    W = np.linalg.solve(system, driven[..., None])[..., 0]
    of_torque = [part[:, None, :, modes] for part in (by_W, by_dW, by_ddW)]
    torque = sum((W * s**k * part).sum(axis=2) for k, part in enumerate(of_torque))
    torque = torque + (s[..., 0] ** 2 * slopes[:, 2, modes, None])
    impedance = torque / s[..., 0] + slopes[:, 1, modes, None]
    return (impedance.real / np.abs(impedance)).min(axis=1)
